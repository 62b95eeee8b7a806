// dermis bench dynamic: measures techniques over sequences of frames with changing light, camera or
// objects.

#include "integration/tools/command/bench/dynamic/accumulation.hpp"
#include "integration/tools/command/bench/dynamic/combined_reference.hpp"
#include "integration/tools/command/bench/dynamic/comparison.hpp"
#include "integration/tools/command/bench/dynamic/dynamic_file.hpp"
#include "integration/tools/command/bench/dynamic/figures.hpp"
#include "integration/tools/command/bench/quick.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/selection.hpp"
#include "integration/tools/command/bench/technique.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "passes/common/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

namespace dermis::tools {
namespace {

struct Measured {
  std::vector<FrameLight> light;                   // one per frame
  std::vector<double> device_ms, sampling_ms, spp; // one per frame
  Accumulation accumulation;                       // used if camera or surfaces move
  SequenceFigures figures;
  TechniqueCounts counts;
  uint64_t history_bytes = 0;
};

struct Bench {
  const Session& session;
  const BenchDynamicOptions& options;
  const DynamicFile& file;
  demo::VulkanHost& host;
  std::vector<float> sap_tables = {};
  std::vector<std::string> notes = {};
  Report report = {};
};

std::string name_of(const DynamicTechnique& technique) {
  return fmt::format("{} {} {}", technique.request.technique, technique.guidance, technique.request.setting);
}

double mean_of(const std::vector<double>& values, uint32_t first) {
  if (values.size() <= first) return 0;
  return std::accumulate(values.begin() + first, values.end(), 0.0) / double(values.size() - first);
}
double largest_of(const std::vector<double>& values, uint32_t first) {
  return values.size() <= first ? 0 : *std::max_element(values.begin() + first, values.end());
}

// Returns the mean of the red channel over pixels with a profile.
double mean_samples(const std::vector<float>& sampling, const std::vector<uint8_t>& profile) {
  double sum = 0;
  uint64_t count = 0;
  for (size_t i = 0; i < profile.size(); ++i)
    if (profile[i] != 0) {
      sum += double(sampling[3 * i]);
      ++count;
    }
  return count > 0 ? sum / double(count) : 0;
}

// Returns d per channel of the most frequent profile, scaled so that its widest channel projects to
// `d_px`.
subsurface::PerChannel d_of(const CapturedFrame& frame, double d_px) {
  std::array<uint64_t, 256> count{};
  for (const uint8_t id : frame.profile)
    count[id] += id != 0;
  const auto maximum = static_cast<uint32_t>(std::max_element(count.begin(), count.end()) - count.begin());
  for (const CaptureProfile& one : frame.description.profiles)
    if (one.id == maximum) {
      const auto& d = one.profile.d_mm;
      const double widest = std::max({d[0], d[1], d[2], 1e-30});
      return {d_px * d[0] / widest, d_px * d[1] / widest, d_px * d[2] / widest};
    }
  return {d_px, d_px, d_px};
}

demo::Result<> measure_frame(Bench& bench, const Sequence& sequence, size_t t, TechniqueRun& run,
                             const Reference& reference, Measured& measured) {
  const SequenceFrame& frame = sequence.frames[t];
  auto light = run.scatter(frame.captured, t > 0 && !frame.cut);
  if (!light) return light.error();
  FrameLight chosen{{}, reference.light};
  for (const uint32_t pixel : reference.pixels)
    for (size_t c = 0; c < 3; ++c)
      chosen.found.push_back(double((*light)[size_t{3} * pixel + c]));
  if (!sequence.request.still) {
    const auto& mean = measured.accumulation.add(frame.captured, *light, t > 0 && !frame.cut);
    for (const uint32_t pixel : reference.pixels)
      chosen.accumulated.insert(chosen.accumulated.end(), mean[pixel].light.begin(), mean[pixel].light.end());
  }
  measured.light.push_back(std::move(chosen));
  const auto times = run.times();
  if (!times) return times.error();
  measured.device_ms.push_back(times->device);
  measured.sampling_ms.push_back(times->sampling);
  auto sampling = run.sampling();
  if (!sampling) return sampling.error();
  if (!sampling->empty()) measured.spp.push_back(mean_samples(*sampling, frame.captured.profile));
  if (t + 1 == sequence.frames.size()) {
    std::optional<double> taken;
    if (!measured.spp.empty()) taken = mean_of(measured.spp, bench.file.counted);
    measured.counts = run.counts(1, d_of(frame.captured, sequence.d_px), taken);
    measured.history_bytes = run.history_bytes();
  }
  return demo::success();
}

void add_rows(Bench& bench, const Sequence& sequence, const std::vector<DynamicTechnique>& techniques,
              const std::vector<Measured>& all) {
  const uint32_t counted = bench.file.counted;
  const bool still = sequence.request.still;
  Plot plot{fmt::format("{} {}, error of each frame", sequence.request.scene, sequence.request.framing),
            "frame",
            "RMSE of linear luminance",
            {},
            true};
  Plot samples{fmt::format("{} {}, samples of each frame", sequence.request.scene, sequence.request.framing),
               "frame",
               "samples a pixel",
               {},
               true};
  for (size_t i = 0; i < techniques.size(); ++i) {
    const DynamicTechnique& technique = techniques[i];
    const Measured& one = all[i];
    const double mean_spp = one.spp.empty() ? one.counts.mean_spp : mean_of(one.spp, counted);
    const double peak_spp = one.spp.empty() ? one.counts.mean_spp : largest_of(one.spp, counted);
    ReportValue reads, accumulated, flicker;
    if (one.counts.reads_per_pixel) reads = *one.counts.reads_per_pixel;
    accumulated = one.figures.psnr_db_accumulated;
    if (still) flicker = one.figures.flicker;
    bench.report.table.rows.push_back(
        {sequence.request.scene, sequence.d_px, sequence.request.framing, technique.request.technique,
         technique.request.setting, technique.guidance, static_cast<int64_t>(technique.min_samples), mean_spp,
         peak_spp, reads, mean_of(one.device_ms, counted), largest_of(one.device_ms, counted),
         mean_of(one.sampling_ms, counted), one.figures.psnr_db_frame, accumulated, one.figures.psnr_db_sdr8,
         flicker, static_cast<int64_t>(one.history_bytes)});
    const std::string series_name = technique.request.technique + " " + technique.guidance;
    PlotSeries series{series_name, {}, is_baseline(technique.request.technique)};
    for (size_t t = 0; t < one.figures.psnr_db.size(); ++t) {
      const double rmse = std::pow(10.0, -one.figures.psnr_db[t] / 20);
      series.points.push_back(
          {double(t), rmse,
           fmt::format("{}, frame {}: {:.2f} dB", name_of(technique), t, one.figures.psnr_db[t]), false});
    }
    plot.series.push_back(std::move(series));
    if (one.spp.empty()) continue;
    constexpr double min_shown = 0.1; // lower bound for the logarithmic axis
    PlotSeries taken{series_name, {}, is_baseline(technique.request.technique)};
    for (size_t t = 0; t < one.spp.size(); ++t)
      taken.points.push_back({double(t), std::max(one.spp[t], min_shown),
                              fmt::format("{}, frame {}: {:.2f}", name_of(technique), t, one.spp[t]), false});
    samples.series.push_back(std::move(taken));
  }
  bench.report.plots.push_back(std::move(plot));
  if (!samples.series.empty()) bench.report.plots.push_back(std::move(samples));
}

demo::Result<> measure_scene(Bench& bench, const SequenceRequest& request) {
  SequenceRequest wanted = request;
  if (bench.options.frames > 0) wanted.frames = bench.options.frames;
  auto rendered = render_sequence(wanted, bench.options.size.width, bench.options.size.height,
                                  head_model(bench.options.head));
  if (!rendered) return rendered.error();
  const Sequence sequence = rendered.take();

  std::vector<DynamicTechnique> techniques;
  std::vector<std::unique_ptr<TechniqueRun>> runs;
  for (const DynamicTechnique& technique : bench.file.techniques) {
    if (!is_selected(bench.options.techniques, technique.request.technique)) continue;
    auto made = TechniqueRun::create(bench.host, technique.request,
                                     sequence.frames.front().captured.description.profiles, bench.sap_tables);
    if (!made) return made.error();
    techniques.push_back(technique);
    runs.push_back(made.take());
  }
  std::vector<Measured> all(techniques.size());
  const std::string name = fmt::format("{} {}", request.scene, request.framing);
  Progress progress(progress_style(bench.session.quiet, false), name, "frame", sequence.frames.size());
  KnownReferences known;
  for (size_t t = 0; t < sequence.frames.size(); ++t) {
    progress.update(t);
    const CapturedFrame& frame = sequence.frames[t].captured;
    const std::string what = fmt::format("reference of {}, frame {}", name, t);
    const auto reference =
        request.still ? make_reference_of_still(bench.session, frame, what, bench.file.subset,
                                                bench.options.cache, known)
                      : make_reference(bench.session, frame, what, bench.file.subset, bench.options.cache);
    if (!reference || interrupted()) return stopped();
    for (size_t i = 0; i < runs.size(); ++i)
      if (auto done = measure_frame(bench, sequence, t, *runs[i], *reference, all[i]); !done) return done;
  }
  for (Measured& one : all)
    one.figures = sequence_figures(one.light, bench.file.counted, request.still, sequence.exposure);
  add_rows(bench, sequence, techniques, all);
  return demo::success();
}

std::string facts_text(const Report& report) {
  std::string text;
  for (const auto& [name, value] : report.info)
    text += fmt::format("{}: {}\n", name, value);
  return text;
}

std::vector<ReportColumn> dynamic_columns() {
  return {{"scene", "scene"},
          {"d_px", "d, px"},
          {"framing", "framing"},
          {"technique", "technique"},
          {"setting", "setting"},
          {"guidance", "guidance"},
          {"min_samples", "least samples"},
          {"mean_spp", "samples"},
          {"peak_spp", "most samples"},
          {"reads_per_pixel", "reads a pixel"},
          {"mean_ms", "ms", 4},
          {"max_ms", "longest ms", 4},
          {"sampling_ms", "scattering ms", 4},
          {"psnr_db_frame", "PSNR dB", 4},
          {"psnr_db_accumulated", "accumulated dB", 4},
          {"psnr_db_sdr8", "8-bit dB", 4},
          {"flicker", "flicker"},
          {"history_bytes", "history bytes"}};
}

std::string text_of(const Report& report) {
  Table table;
  table.columns = {{"scene"},         {"framing"},           {"technique"},    {"setting"},
                   {"guidance"},      {"samples", true},     {"most", true},   {"ms", true},
                   {"PSNR dB", true}, {"accumulated", true}, {"flicker", true}};
  std::string last;
  for (size_t i = 0; i < report.table.rows.size(); ++i) {
    const auto text = [&](const char* key, int digits = 0) { return report.table.text_at(i, key, digits); };
    const std::string here = text("scene") + text("framing");
    if (!last.empty() && here != last) table.rows.emplace_back();
    last = here;
    table.rows.push_back({text("scene"), text("framing"), text("technique"), text("setting"),
                          text("guidance"), text("mean_spp", 2), text("peak_spp", 2), text("mean_ms", 2),
                          text("psnr_db_frame", 2), text("psnr_db_accumulated", 2), text("flicker", 5)});
  }
  return format_table(table);
}

} // namespace

ExitCode bench_dynamic(const Session& session, const BenchDynamicOptions& requested) {
  const BenchDynamicOptions options = quickened(requested);
  const auto start = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  std::optional<DynamicFile> file = read_dynamic(options.file, diagnostics);
  if (!file)
    return fail(session, ExitCode::problems, fmt::format("the bench file '{}' cannot be used", options.file),
                &diagnostics);
  if (options.quick) quicken(*file);
  auto host = demo::create_vulkan_host({});
  if (!host) return fail(session, static_cast<ExitCode>(host.error().kind), host.error().text);
  Bench bench{session, options, *file, **host};
  bench.sap_tables = subsurface::make_sap_tables({true, true}, {});
  bench.report.bench = "dynamic";
  bench.report.title = "Changing light, cameras and objects";
  bench.report.summary = "Error of the scattered light before albedo against the fp64 truth of each frame: "
                         "linear Rec.709 luminance, the "
                         "sequence's 99.9th percentile of light at 1. Samples are counted on the device.";
  bench.report.table.columns = dynamic_columns();
  for (const SequenceRequest& request : file->scenes) {
    if (!is_selected(options.scenes, request.scene) || !is_selected(options.framings, request.framing))
      continue;
    const auto done = measure_scene(bench, request);
    if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
    if (!done) return fail(session, static_cast<ExitCode>(done.error().kind), done.error().text);
  }
  if (bench.report.table.rows.empty()) return fail(session, ExitCode::usage, "no scene is selected");
  bench.report.info = machine_info(session.command, (*host)->properties.deviceName);
  bench.report.info.emplace_back("size",
                                 fmt::format("{}x{} pixels", options.size.width, options.size.height));
  bench.report.info.emplace_back("truth", fmt::format("at {} stratified pixels a frame", file->subset));
  bench.report.info.emplace_back("frames",
                                 fmt::format("counted from number {} of each sequence on", file->counted));
  if (options.quick) bench.report.info.push_back(quick_fact());
  add_comparisons(bench.report);
  add_published(bench.report);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  bench.report.info.emplace_back("took", format_duration(seconds));
  if (!session.quiet && options.json != "-" && options.html != "-" && options.csv != "-")
    print(text_of(bench.report) + facts_text(bench.report));
  const std::string problem = deliver_report(bench.report, options.json, options.csv, options.html);
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

} // namespace dermis::tools
