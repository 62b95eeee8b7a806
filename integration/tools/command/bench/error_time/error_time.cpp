// dermis bench error-time: measures run time and error of every technique on every still scene in
// one run.

#include "integration/tools/command/bench/error_time/error_time_file.hpp"
#include "integration/tools/command/bench/report/heat_map.hpp"
#include "integration/tools/command/bench/report/pareto.hpp"
#include "integration/tools/command/bench/still_error.hpp"
#include "integration/tools/command/bench/suite/statistics.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/bench/suite/techniques.hpp"
#include "integration/tools/command/bench/technique.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "passes/common/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>

namespace dermis::tools {
namespace {

// One technique on one subject.
struct ErrorTimeRow {
  const Subject* subject = nullptr;
  const TechniqueRequest* request = nullptr;
  double spent_ms = 0;  // duration of the timed runs, including host work
  uint32_t to_warm = 0; // remaining runs that are not timed
  StillError error = {};
  TechniqueCounts counts = {};
  std::vector<double> device_ms = {}, sampling_ms = {};
  std::optional<double> psnr_db_self = {};
  // set by complete_rows
  Spread device = {};
  std::optional<double> time_ratio = {}, rmse_ratio = {}; // to the baseline
  bool on_front = false;
};

struct ErrorTimeBench {
  SuiteRun& run;
  const ErrorTimeFile& file;
  demo::VulkanHost& host;
  std::vector<Subject> subjects = {};
  std::vector<CaptureProfile> profiles = {}; // of all subjects, renumbered
  std::vector<std::unique_ptr<TechniqueRun>> techniques = {};
  std::vector<float> sap_tables = {};
  std::vector<ErrorTimeRow> measured = {}; // all techniques of a subject are neighbours
  ReportPictures maps = {};
};

// Merges the frame's profiles into one list for all scenes, so that a technique's tables and
// pipelines are created once.
void adopt_profiles(ErrorTimeBench& bench, CapturedFrame& frame) {
  std::array<uint8_t, 256> renumbered{};
  std::vector<CaptureProfile> own;
  for (const CaptureProfile& one : frame.description.profiles) {
    auto known = std::find_if(
        bench.profiles.begin(), bench.profiles.end(), [&](const CaptureProfile& other) {
          return other.profile.name == one.profile.name && other.profile.d_mm == one.profile.d_mm;
        });
    if (known == bench.profiles.end()) {
      bench.profiles.push_back({static_cast<uint32_t>(bench.profiles.size() + 1), one.profile});
      known = bench.profiles.end() - 1;
    }
    renumbered[one.id] = static_cast<uint8_t>(known->id);
    own.push_back(*known);
  }
  for (uint8_t& id : frame.profile)
    id = renumbered[id];
  frame.description.profiles = own;
}

// Returns the reason to leave the scene out, or "".
std::string why_not(const ErrorTimeBench& bench, const SceneRequest& scene) {
  if (scene.study && !bench.run.flag("study")) return "only with --study";
  return scene.model ? why_no_head(bench.run.text("head")) : "";
}

demo::Result<> add_subjects(ErrorTimeBench& bench) {
  Diagnostics diagnostics;
  const auto document = read_document(bench.file.skin, diagnostics);
  const auto skin = document ? subsurface::read_profile(*document, diagnostics) : std::nullopt;
  if (!skin) return bench.run.refuse(bench.file.skin, diagnostics);
  const SubjectOptions options{bench.run.size().width, bench.run.size().height,
                               head_model(bench.run.text("head"))};
  Progress progress = bench.run.progress("scene", bench.file.scenes.size(), "scenes");
  uint64_t done = 0;
  for (const SceneRequest& scene : bench.file.scenes) {
    if (interrupted()) return stopped();
    progress.update(done++);
    if (!bench.run.is_requested("scenes", scene.scene)) continue;
    if (const std::string reason = why_not(bench, scene); !reason.empty()) {
      bench.run.add_note(fmt::format("scene {} {}: {}", scene.scene, scene.framing, reason));
      continue;
    }
    if (scene.file.empty()) {
      for (const double d_px : scene.d_px) {
        CapturedFrame frame =
            generate_scene(scene.scene, scene.framing, options.width, options.height, d_px, *skin);
        bench.subjects.push_back({scene.scene, scene.framing, std::move(frame), d_px});
      }
    } else {
      auto subject = render_subject(scene, options);
      if (!subject) return subject.error();
      bench.subjects.push_back(subject.take());
    }
  }
  if (bench.subjects.empty()) return demo::Error{demo::ErrorKind::usage, "no scene is selected"};
  for (Subject& subject : bench.subjects)
    adopt_profiles(bench, subject.frame);
  return demo::success();
}

demo::Result<> add_techniques(ErrorTimeBench& bench) {
  bench.sap_tables = subsurface::make_sap_tables({true, true}, {});
  const auto selected = select_techniques(bench.run, bench.file.techniques);
  if (!selected) return selected.error();
  for (const TechniqueRequest& request : *selected) {
    auto made = TechniqueRun::create(bench.host, request, bench.profiles, bench.sap_tables);
    if (!made) return made.error();
    bench.techniques.push_back(made.take());
  }
  return demo::success();
}

// Returns the fraction of the frame's subsurface pixels that scatter.
double scattering_fraction(const Subject& subject) {
  constexpr double copy_below_d_px = 0.0546; // shaders/common/radius.glsl
  const ReferenceFrame frame = make_reference_frame(subject.frame);
  const double pixel = std::sqrt(std::abs(frame.rays.scale_x * frame.rays.scale_y));
  uint64_t all = 0, scattered = 0;
  for (size_t i = 0; i < frame.profile.size(); ++i) {
    if (frame.profile[i] == 0) continue;
    const auto& d = frame.d_m[frame.profile[i]];
    const double scale = frame.scatter_scale.empty() ? 1.0 : double(frame.scatter_scale[i]);
    const double footprint = pixel * (frame.rays.perspective ? double(frame.depth[i]) : 1.0);
    ++all;
    scattered += *std::max_element(d.begin(), d.end()) * scale / footprint >= copy_below_d_px;
  }
  return all > 0 ? double(scattered) / double(all) : 0;
}

// Runs the technique with a large number of samples, which approximates its own limit. Returns
// nullopt for deterministic techniques.
demo::Result<std::optional<std::vector<float>>> self_reference(ErrorTimeBench& bench,
                                                               const TechniqueRun& technique,
                                                               const Subject& subject,
                                                               const CapturedFrame& window) {
  const ErrorTimeFile& file = bench.file;
  TechniqueRequest request = technique.request();
  auto samples = std::find_if(request.set.begin(), request.set.end(), [&](const NamedValue& one) {
    return one.first == file.self_setting;
  });
  const std::string name = subject.scene + "/" + subject.framing;
  if (samples == request.set.end() ||
      std::find(file.self_scenes.begin(), file.self_scenes.end(), name) == file.self_scenes.end())
    return std::optional<std::vector<float>>();
  samples->second = fmt::format("{}", file.self_samples);
  auto made = TechniqueRun::create(bench.host, request, bench.profiles, bench.sap_tables);
  if (!made) return made.error();
  auto light = (*made)->scatter(window);
  if (!light) return light.error();
  return std::optional<std::vector<float>>(light.take());
}

void add_times(ErrorTimeRow& row, const TechniqueTimes& times,
               std::chrono::steady_clock::time_point start) {
  row.spent_ms +=
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  row.device_ms.push_back(times.device);
  row.sampling_ms.push_back(times.sampling);
}

// The first runs measure the error, and also the time if the technique already ran at this size.
// Then all techniques run in turn repeatedly, so that other load on the machine affects all of them
// equally.
demo::Result<> measure_subject(ErrorTimeBench& bench, const Subject& subject, Progress& progress,
                               uint64_t& done) {
  const auto name = fmt::format("{} {} d {:.2f} px", subject.scene, subject.framing, subject.d_px);
  const auto reference = make_reference(bench.run.session, subject.frame, "reference of " + name,
                                        bench.file.subset, bench.run.text("cache"));
  if (!reference) return stopped();
  const subsurface::PerChannel d_px = d_of(subject.frame, subject.d_px);
  const double fraction = scattering_fraction(subject);
  const size_t first = bench.measured.size();
  const CapturedFrame window = window_of(subject.frame, bench.file.self_window);
  const Reference in_window = inside(window, *reference);
  std::optional<std::vector<float>> self;
  std::string self_of; // graph of `self`, which settings of one technique share
  for (size_t t = 0; t < bench.techniques.size(); ++t) {
    if (interrupted()) return stopped();
    TechniqueRun& technique = *bench.techniques[t];
    ErrorTimeRow one{&subject, &technique.request()};
    if (self_of != technique.request().graph) {
      auto found = self_reference(bench, technique, subject, window);
      if (!found) return found.error();
      self = found.take();
      self_of = technique.request().graph;
    }
    if (self && !in_window.pixels.empty()) { // the other size creates the graph twice more
      const auto part = technique.scatter(window);
      if (!part) return part.error();
      one.psnr_db_self = psnr_between(*part, *self, in_window);
    }
    const auto start = std::chrono::steady_clock::now();
    const auto light = technique.scatter(subject.frame);
    if (!light) return light.error();
    const auto times = technique.times();
    if (!times) return times.error();
    if (technique.was_made_anew())
      one.to_warm = bench.file.warm_up - 1;
    else
      add_times(one, *times, start);
    one.error = still_error(*light, *reference);
    one.counts = technique.counts(fraction, d_px);
    if (technique.request().heat_map)
      bench.maps.pictures.push_back(
          heat_map(fmt::format("{}, {}", name, name_of(technique.request())), *light, *reference,
                   subject.frame.description.width, subject.frame.profile));
    bench.measured.push_back(std::move(one));
  }
  for (uint32_t round = 1; round < bench.file.warm_up + bench.file.repetitions; ++round)
    for (size_t t = 0; t < bench.techniques.size(); ++t) {
      if (interrupted()) return stopped();
      progress.update(++done);
      ErrorTimeRow& row = bench.measured[first + t];
      if (row.device_ms.size() >= bench.file.repetitions) continue;
      if (bench.file.row_milliseconds > 0 && row.device_ms.size() >= bench.file.min_repetitions &&
          row.spent_ms >= bench.file.row_milliseconds)
        continue;
      const auto start = std::chrono::steady_clock::now();
      const auto times = bench.techniques[t]->run_again();
      if (!times) return times.error();
      if (row.to_warm > 0)
        --row.to_warm;
      else
        add_times(row, *times, start);
    }
  return demo::success();
}

Plot plot_of(const Subject& subject, std::span<const ErrorTimeRow> rows) {
  Plot plot{fmt::format("{} {}, d = {:.2f} px", subject.scene, subject.framing, subject.d_px),
            "device time, ms",
            "RMSE of linear luminance",
            {}};
  for (const ErrorTimeRow& row : rows) {
    const double ms = row.device.median, rmse = row.error.figures.rmse;
    if (row.subject != &subject || !(rmse > 0)) continue;
    const std::string& technique = row.request->technique;
    if (plot.series.empty() || plot.series.back().name != technique)
      plot.series.push_back({technique, {}, is_baseline(technique)});
    plot.series.back().points.push_back(
        {ms, rmse, fmt::format("{}: {:.2f} ms, RMSE {:.5f}", name_of(*row.request), ms, rmse),
         row.on_front});
  }
  return plot;
}

std::string early_end(const ErrorTimeFile& file) {
  if (file.row_milliseconds == 0) return "";
  return fmt::format("; a technique ends early on a scene after {} ms, but not before {}",
                     file.row_milliseconds, file.min_repetitions);
}

// Sets medians, ratios to the baseline and the Pareto front of each subject.
void complete_rows(ErrorTimeBench& bench) {
  const size_t count = bench.techniques.size();
  for (size_t first = 0; first < bench.measured.size(); first += count) {
    const std::span<ErrorTimeRow> rows = std::span(bench.measured).subspan(first, count);
    std::vector<Cost> costs;
    const ErrorTimeRow* baseline = nullptr;
    for (ErrorTimeRow& row : rows) {
      row.device = spread_of(row.device_ms);
      costs.push_back({row.device.median, row.error.figures.rmse});
      if (row.request->technique == bench.file.baseline_technique &&
          row.request->setting == bench.file.baseline_setting)
        baseline = &row;
    }
    const std::vector<bool> front = pareto_front(costs);
    for (size_t i = 0; i < count; ++i) {
      rows[i].on_front = front[i];
      if (baseline == nullptr) continue;
      rows[i].time_ratio = costs[i].time / baseline->device.median;
      if (const double rmse = baseline->error.figures.rmse; rmse > 0)
        rows[i].rmse_ratio = costs[i].error / rmse;
    }
  }
}

// Adds facts, a plot per subject with its Pareto front, and images.
void add_error_time_report(const ErrorTimeBench& bench) {
  SuiteRun& run = bench.run;
  const ErrorTimeFile& file = bench.file;
  run.add_fact("size", fmt::format("{}x{} pixels", run.size().width, run.size().height));
  run.add_fact("repetitions",
               fmt::format("median of {} after {} to warm up, all techniques in turn{}",
                           file.repetitions, file.warm_up, early_end(file)));
  run.add_fact("truth",
               fmt::format("everywhere on planes, else at {} stratified pixels", file.subset));
  run.add_fact(
      "reads a pixel",
      "counted from the kernels' source (integration/tools/references/image_reads.cpp) times the "
      "texels each pass computes for a pixel of the view");
  run.add_fact("baseline", fmt::format("{} {}", file.baseline_technique, file.baseline_setting));
  run.report.pictures = {scene_pictures(bench.subjects), bench.maps};
  for (const Subject& subject : bench.subjects)
    run.report.plots.push_back(plot_of(subject, bench.measured));
}

demo::Result<> measure_error_time(SuiteRun& run, const Emit<ErrorTimeRow>& emit) {
  auto read = run.read(read_error_time);
  if (!read) return read.error();
  ErrorTimeFile file = read.take();
  if (run.quick) {
    file.repetitions = file.warm_up = file.min_repetitions = 1;
    file.subset = std::min(file.subset, quick_subset);
    file.self_scenes.clear();
  }
  const auto host = run.open_device();
  if (!host) return host.error();
  ErrorTimeBench bench{run, file, **host};
  bench.maps = {"Error maps", heat_map_explanation(), {}};
  if (auto ready = add_subjects(bench); !ready) return ready;
  if (auto ready = add_techniques(bench); !ready) return ready;
  const uint64_t rounds = file.warm_up + file.repetitions - 1;
  Progress progress = run.progress("run", rounds * bench.techniques.size() * bench.subjects.size());
  uint64_t done = 0;
  for (const Subject& subject : bench.subjects)
    if (auto measured = measure_subject(bench, subject, progress, done); !measured) return measured;
  for (const ErrorTimeRow& one : bench.measured)
    if (!one.counts.unknown_pass_type.empty())
      run.add_note(fmt::format("reads_per_pixel of {}: the reads of '{}' are unknown",
                               one.request->graph, one.counts.unknown_pass_type));
  complete_rows(bench);
  add_error_time_report(bench);
  for (const ErrorTimeRow& row : bench.measured)
    emit(row);
  return demo::success();
}

template <auto Figure> ReportValue error_of(const ErrorTimeRow& row) {
  return row.error.figures.*Figure;
}

template <size_t Channel> ReportValue rmse_of(const ErrorTimeRow& row) {
  return row.error.figures.rmse_rgb[Channel];
}

} // namespace

Suite error_time_suite() {
  using Row = ErrorTimeRow;
  using Figures = ErrorFigures;
  const ColumnStyle page{.in_text = false}, four{.digits = 4},
      four_on_page{.digits = 4, .in_text = false};
  return make_suite<Row>(
      {.name = "error-time",
       .what = "Measure run time and error of every technique on every still scene",
       .title = "Run time and error",
       .summary =
           "Error of the scattered light before albedo against the fp64 truth: linear Rec.709 "
           "luminance, the scene's 99.9th percentile of light at 1. Time is the sum of the "
           "device's "
           "timestamps over all passes of a technique.",
       .options = {size_option({640, 360}),
                   head_option(),
                   {"study", "Also measure the framings that study one head", false},
                   only_option("scenes"),
                   only_option("techniques"),
                   file_option("tests/benchmark/error_time.json"),
                   cache_option()}},
      {{"scene", "scene", [](const Row& row) { return row.subject->scene; }, {.groups = true}},
       {"d_px", "d, px", [](const Row& row) { return row.subject->d_px; }, {.groups = true}},
       {"framing",
        "framing",
        [](const Row& row) { return row.subject->framing; },
        {.groups = true}},
       {"technique", "technique", [](const Row& row) { return row.request->technique; }},
       {"setting", "setting", [](const Row& row) { return row.request->setting; }},
       {"device_ms", "ms", [](const Row& row) { return row.device.median; }, four},
       {"device_ms_low", "", [](const Row& row) { return row.device.p10; }},
       {"device_ms_high", "", [](const Row& row) { return row.device.p90; }},
       {"repetitions", "", [](const Row& row) { return row.device_ms.size(); }},
       {"sampling_ms", "scattering ms", [](const Row& row) { return median(row.sampling_ms); },
        four_on_page},
       {"mean_spp", "samples", [](const Row& row) { return row.counts.mean_spp; }, page},
       {"reads_per_pixel", "reads a pixel",
        [](const Row& row) { return row.counts.reads_per_pixel; }},
       {"rmse", "RMSE", error_of<&Figures::rmse>},
       {"rmse_low", "", error_of<&Figures::rmse_low>},
       {"rmse_high", "", error_of<&Figures::rmse_high>},
       {"rmse_r", "", rmse_of<0>},
       {"rmse_g", "", rmse_of<1>},
       {"rmse_b", "", rmse_of<2>},
       {"psnr_db", "PSNR dB", error_of<&Figures::psnr_db>, four},
       {"max_error", "largest", error_of<&Figures::max_error>},
       {"p99_error", "99 %", error_of<&Figures::p99_error>, page},
       {"psnr_db_sdr8", "8-bit dB", [](const Row& row) { return row.error.psnr_db_sdr8; },
        four_on_page},
       {"psnr_db_self", "self dB", &Row::psnr_db_self, four_on_page},
       {"transient_bytes", "bytes", [](const Row& row) { return row.counts.transient_bytes; },
        page},
       {"dispatches", "dispatches", [](const Row& row) { return row.counts.dispatches; }, page},
       {"time_ratio", "ms / baseline", &Row::time_ratio, page},
       {"rmse_ratio", "RMSE / baseline", &Row::rmse_ratio, page},
       {"pixels", "", error_of<&Figures::pixels>},
       {"population", "", [](const Row& row) { return row.error.population; }},
       {"on_pareto_front", "front", &Row::on_front, {.goal = Goal::best}}},
      measure_error_time);
}

} // namespace dermis::tools
