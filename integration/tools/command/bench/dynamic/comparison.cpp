#include "integration/tools/command/bench/dynamic/comparison.hpp"

#include "integration/tools/command/present.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr std::array<const char*, 3> changing = {"flashing", "regular", "dynamic"};

// Returns the first row of a sequence with framing `close`, or null. The row with 8 minimum samples
// precedes rows with other minimums.
const DynamicRow* find_row(std::span<const DynamicRow> rows, std::string_view scene,
                           std::string_view technique, std::string_view guidance) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const DynamicRow& row) {
    return row.scene == scene && row.framing == "close" && row.technique.technique == technique &&
           row.technique.guidance == guidance;
  });
  return found == rows.end() ? nullptr : &*found;
}

void add_against(Report& report, std::span<const DynamicRow> rows, const std::string& technique,
                 const std::string& guidance) {
  double log_samples = 0, log_ms = 0, difference = 0;
  int count = 0;
  for (const char* scene : changing) {
    const DynamicRow* ours = find_row(rows, scene, technique, guidance);
    const DynamicRow* theirs = find_row(rows, scene, "afis", "ccv");
    if (ours == nullptr || theirs == nullptr) continue;
    ++count;
    log_samples += std::log(ours->mean_spp / theirs->mean_spp);
    log_ms += std::log(ours->mean_ms / theirs->mean_ms);
    difference += ours->figures.psnr_db_frame - theirs->figures.psnr_db_frame;
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
  double max_samples_ratio = 0, max_psnr_ratio = 0; // 0: not printed
};
// Xie et al. 2021, table 3: 1440p on a GeForce RTX 2080 Ti, PSNR of 8-bit images. The maximum
// ratios of a scene stand in the row of CCV.
constexpr Published published[] = {
    {"flashing", "spvg", "AS", 61.97, 1.47, 51.19},
    {"flashing", "ocv", "AS+OCV", 29.58, 0.80, 49.55},
    {"flashing", "ccv", "AS+CCV", 26.88, 0.75, 49.43, 2.75, 0.94},
    {"regular", "spvg", "AS", 26.51, 3.39, 47.85},
    {"regular", "ocv", "AS+OCV", 18.32, 2.55, 47.57},
    {"regular", "ccv", "AS+CCV", 17.82, 2.58, 47.55, 4.00, 1.01},
    {"dynamic", "spvg", "AS", 22.01, 2.02, 50.62},
    {"dynamic", "ocv", "AS+OCV", 14.70, 1.54, 49.11},
    {"dynamic", "ccv", "AS+CCV", 14.13, 1.52, 49.11, 2.02, 0.91},
};

// Returns the largest quotient of two values of one frame; 0 if there are none.
double max_ratio(std::span<const double> above, std::span<const double> below) {
  double most = 0;
  for (size_t t = 0; t < std::min(above.size(), below.size()); ++t)
    if (below[t] > 0) most = std::max(most, above[t] / below[t]);
  return most;
}

// Returns the PSNR of the frames that `row.spp` counts.
std::span<const double> counted_psnr(const DynamicRow& row) {
  const std::vector<double>& all = row.figures.psnr_db;
  return std::span(all).last(std::min(all.size(), row.spp.size()));
}

// Returns the quotient farthest from 1, as the paper prints one number for better and worse frames.
double farthest_psnr_ratio(const DynamicRow& control, const DynamicRow& base) {
  const double better = max_ratio(counted_psnr(control), counted_psnr(base)),
               worse = max_ratio(counted_psnr(base), counted_psnr(control));
  if (better == 0 || worse == 0) return 0;
  return better >= worse ? better : 1 / worse;
}

ReportValue number_or_nothing(double value) {
  return value > 0 ? ReportValue(value) : ReportValue();
}

} // namespace

void add_comparisons(Report& report, std::span<const DynamicRow> rows) {
  add_against(report, rows, "sap_residual", "conf");
  add_against(report, rows, "sap", "none");
  const DynamicRow* ocv = find_row(rows, "flashing", "afis", "ocv");
  const DynamicRow* spvg = find_row(rows, "flashing", "afis", "spvg");
  if (ocv != nullptr && spvg != nullptr)
    report.info.emplace_back("ocv against spvg, flashing",
                             fmt::format("samples x {:.3f}", ocv->mean_spp / spvg->mean_spp));
  if (const DynamicRow* split = find_row(rows, "regular", "afis", "split_half"))
    report.info.emplace_back(
        "split_half, regular",
        fmt::format("maximum samples x {:.3f} of the mean", split->peak_spp / split->mean_spp));
}

void add_published(Report& report, std::span<const DynamicRow> rows) {
  report.more_title = "Comparison with the paper's table 3";
  report.more_text =
      "Theirs: Xie et al. 2021, 2560x1440 on a GeForce RTX 2080 Ti, 300 frames, PSNR of 8-bit "
      "video. Ours: this run. Scenes, device and size differ, so only ratios are comparable.";
  report.more.columns = {{"scene", "scene"},
                         {"guidance", "guidance"},
                         {"their_spp", "their samples", {4}},
                         {"our_spp", "our samples", {4}},
                         {"their_ratio", "theirs / AS"},
                         {"our_ratio", "ours / AS"},
                         {"their_max_ratio", "AS / theirs, maximum"},
                         {"our_max_ratio", "AS / ours, maximum"},
                         {"their_ms", "their ms"},
                         {"our_ms", "our ms", {4}},
                         {"their_db", "their 8-bit dB", {4}},
                         {"our_db", "our 8-bit dB", {4}},
                         {"their_max_db_ratio", "their dB / AS, extreme"},
                         {"our_max_db_ratio", "our linear dB / AS, extreme"}};
  double all = 0; // samples of AS, the first row of each scene
  for (const Published& one : published) {
    if (std::string(one.name) == "AS") all = one.samples;
    const DynamicRow* ours = find_row(rows, one.scene, "afis", one.guidance);
    const DynamicRow* base = find_row(rows, one.scene, "afis", "spvg");
    if (ours == nullptr || base == nullptr) continue;
    const bool with_maxima = one.max_samples_ratio > 0;
    report.more.rows.push_back(
        {one.scene, one.name, one.samples, ours->mean_spp, one.samples / all,
         ours->mean_spp / base->mean_spp, number_or_nothing(one.max_samples_ratio),
         number_or_nothing(with_maxima ? max_ratio(base->spp, ours->spp) : 0), one.ms,
         ours->mean_ms, one.psnr, ours->figures.psnr_db_sdr8, number_or_nothing(one.max_psnr_ratio),
         number_or_nothing(with_maxima ? farthest_psnr_ratio(*ours, *base) : 0)});
    if (const DynamicRow* fixed = find_row(rows, one.scene, "fixed", "none");
        with_maxima && fixed != nullptr)
      report.more.rows.push_back({one.scene, "fixed " + fixed->technique.setting, ReportValue(),
                                  fixed->mean_spp, ReportValue(), fixed->mean_spp / base->mean_spp,
                                  ReportValue(), ReportValue(), ReportValue(), fixed->mean_ms,
                                  ReportValue(), fixed->figures.psnr_db_sdr8, ReportValue(),
                                  ReportValue()});
  }
}

} // namespace dermis::tools
