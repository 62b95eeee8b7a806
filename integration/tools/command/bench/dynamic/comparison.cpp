#include "integration/tools/command/bench/dynamic/comparison.hpp"

#include "integration/tools/command/present.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

namespace dermis::tools {
namespace {

constexpr std::array<const char*, 3> changing = {"flashing", "regular", "dynamic"};

struct Row {
  double samples = 0, maximum = 0, ms = 0, psnr = 0, shown = 0;
};

// Returns the first row of a sequence with framing `close`. The row with 8 minimum samples precedes
// rows with other minimums.
std::optional<Row> row_of(Report& report, const std::string& scene, const std::string& technique,
                          const std::string& guidance) {
  ReportTable& table = report.table;
  const auto text = [&](size_t row, const char* key) { return std::get<std::string>(table.at(row, key)); };
  const auto number = [&](size_t row, const char* key) { return std::get<double>(table.at(row, key)); };
  for (size_t i = 0; i < table.rows.size(); ++i)
    if (text(i, "scene") == scene && text(i, "framing") == "close" && text(i, "technique") == technique &&
        text(i, "guidance") == guidance)
      return Row{number(i, "mean_spp"), number(i, "peak_spp"), number(i, "mean_ms"),
                 number(i, "psnr_db_frame"), number(i, "psnr_db_sdr8")};
  return std::nullopt;
}

void add_against(Report& report, const std::string& technique, const std::string& guidance) {
  double log_samples = 0, log_ms = 0, difference = 0;
  int count = 0;
  for (const char* scene : changing) {
    const auto ours = row_of(report, scene, technique, guidance),
               theirs = row_of(report, scene, "afis", "ccv");
    if (!ours || !theirs) continue;
    ++count;
    log_samples += std::log(ours->samples / theirs->samples);
    log_ms += std::log(ours->ms / theirs->ms);
    difference += ours->psnr - theirs->psnr;
  }
  if (count == 0) return;
  report.info.emplace_back(technique + " against afis + ccv",
                           fmt::format("{}: samples x {:.3f}, time x {:.3f}, PSNR {:+.2f} dB",
                                       format_count(static_cast<uint64_t>(count), "sequence"),
                                       std::exp(log_samples / count), std::exp(log_ms / count),
                                       difference / count));
}

struct Published {
  const char* scene;
  const char* guidance;
  const char* name;
  double samples, ms, psnr;
};
// Xie et al. 2021, table 3: 1440p on a GeForce RTX 2080 Ti, PSNR of 8-bit images.
constexpr Published published[] = {
    {"flashing", "spvg", "AS", 61.97, 1.47, 51.19},    {"flashing", "ocv", "AS+OCV", 29.58, 0.80, 49.55},
    {"flashing", "ccv", "AS+CCV", 26.88, 0.75, 49.43}, {"regular", "spvg", "AS", 26.51, 3.39, 47.85},
    {"regular", "ocv", "AS+OCV", 18.32, 2.55, 47.57},  {"regular", "ccv", "AS+CCV", 17.82, 2.58, 47.55},
    {"dynamic", "spvg", "AS", 22.01, 2.02, 50.62},     {"dynamic", "ocv", "AS+OCV", 14.70, 1.54, 49.11},
    {"dynamic", "ccv", "AS+CCV", 14.13, 1.52, 49.11},
};

} // namespace

void add_comparisons(Report& report) {
  add_against(report, "sap_residual", "conf");
  add_against(report, "sap", "none");
  if (const auto ocv = row_of(report, "flashing", "afis", "ocv"),
      spvg = row_of(report, "flashing", "afis", "spvg");
      ocv && spvg)
    report.info.emplace_back("ocv against spvg, flashing",
                             fmt::format("samples x {:.3f}", ocv->samples / spvg->samples));
  if (const auto split = row_of(report, "regular", "afis", "split_half"))
    report.info.emplace_back("split_half, regular", fmt::format("maximum samples x {:.3f} of the mean",
                                                                split->maximum / split->samples));
}

void add_published(Report& report) {
  report.more_title = "Comparison with the paper's table 3";
  report.more_text = "Theirs: Xie et al. 2021, 2560x1440 on a GeForce RTX 2080 Ti, 300 frames, PSNR of 8-bit "
                     "video. Ours: this run. Scenes, device and size differ, so only ratios are comparable.";
  report.more.columns = {{"scene", "scene"},
                         {"guidance", "guidance"},
                         {"their_spp", "their samples", 4},
                         {"our_spp", "our samples", 4},
                         {"their_ratio", "theirs / AS"},
                         {"our_ratio", "ours / AS"},
                         {"their_ms", "their ms"},
                         {"our_ms", "our ms", 4},
                         {"their_db", "their 8-bit dB", 4},
                         {"our_db", "our 8-bit dB", 4}};
  double all = 0; // samples of AS, the first row of each scene
  for (const Published& one : published) {
    if (std::string(one.name) == "AS") all = one.samples;
    const auto ours = row_of(report, one.scene, "afis", one.guidance),
               base = row_of(report, one.scene, "afis", "spvg");
    if (!ours || !base) continue;
    report.more.rows.push_back({std::string(one.scene), std::string(one.name), one.samples, ours->samples,
                                one.samples / all, ours->samples / base->samples, one.ms, ours->ms, one.psnr,
                                ours->shown});
  }
}

} // namespace dermis::tools
