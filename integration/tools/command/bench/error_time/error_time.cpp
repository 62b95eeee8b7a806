// dermis bench error-time: measures run time and error of every technique on every still scene in
// one run.

#include "integration/tools/command/bench/error_time/error_time_bench.hpp"
#include "integration/tools/command/bench/family/family.hpp"
#include "integration/tools/command/bench/report/heat_map.hpp"
#include "integration/tools/command/bench/report/pareto.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/bench/suite/techniques.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "passes/common/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>

namespace dermis::tools {
namespace {

// More frames than a technique runs on one subject. The number of a subject's first frame is a
// multiple of this, so that noise depends neither on the device's speed nor on --scenes.
// `sap_residual` counts the frames since the last cut instead, and each subject begins with one.
constexpr uint64_t frames_apart = uint64_t{1} << 20;
constexpr std::string_view family_file = "tests/benchmark/family.json";

std::string name_of(const Subject& subject) {
  return fmt::format("{} {} d {:.2f} px", subject.scene, subject.framing, subject.d_px);
}

demo::Result<> add_techniques(ErrorTimeBench& bench) {
  bench.sap_tables = subsurface::make_shared_sap_tables({true, true});
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

// Returns what self_reference() depends on, of one subject.
std::string self_name(const ErrorTimeFile& file, const TechniqueRequest& request) {
  std::string name = fmt::format("{} {}", request.graph, fmt::join(request.overlays, " "));
  for (const auto& [setting, value] : request.set)
    if (setting != file.self_setting) name += fmt::format(" {}={}", setting, value);
  return name;
}

void add_times(ErrorTimeRow& row, const TechniqueTimes& times,
               std::chrono::steady_clock::time_point start) {
  row.spent_ms +=
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  row.device_ms.push_back(times.device);
  row.sampling_ms.push_back(times.sampling);
}

// Runs a technique on the subject's frame, and again --frames - 1 times if it has a history.
demo::Result<std::vector<float>> scatter_frames(const ErrorTimeBench& bench,
                                                TechniqueRun& technique, const Subject& subject) {
  technique.skip_to((subject.number + 1) * frames_apart);
  auto light = technique.scatter(subject.frame);
  if (technique.history_bytes() == 0) return light;
  for (uint64_t i = 1; light && i < bench.run.number("frames"); ++i) {
    if (interrupted()) return stopped();
    light = technique.scatter(subject.frame, true);
  }
  return light;
}

// Appends rows of the pictures in the folders of --pictures. Returns the first folder's picture,
// empty without folders.
demo::Result<std::vector<float>> measure_pictures(ErrorTimeBench& bench, const Subject& subject,
                                                  const Reference& reference) {
  std::vector<float> first;
  for (const TechniqueRequest& folder : bench.pictures) {
    auto light = read_picture(folder.graph, subject.number, subject.frame.description.width,
                              subject.frame.description.height);
    if (!light) return light.error();
    ErrorTimeRow row{&subject, &folder};
    row.error = still_error(*light, reference);
    if (first.empty())
      first = *light;
    else
      row.pictures_ratio = paired_ratio(*light, first, reference);
    bench.measured.push_back(std::move(row));
  }
  return first;
}

// Measures the error, and also the time if the technique already ran at this size. `pictures` is a
// picture of another build to compare with; empty: none.
demo::Result<> measure_technique(ErrorTimeBench& bench, TechniqueRun& technique, ErrorTimeRow& row,
                                 const Reference& reference, std::span<const float> pictures) {
  const Subject& subject = *row.subject;
  const auto start = std::chrono::steady_clock::now();
  const auto light = scatter_frames(bench, technique, subject);
  if (!light) return light.error();
  if (bench.file.repetitions > 0) {
    if (technique.was_made_anew()) {
      row.to_warm = bench.file.warm_up - 1;
    } else {
      const auto times = technique.times_at_full_clock();
      if (!times) return times.error();
      add_times(row, *times, start);
    }
  }
  row.error = still_error(*light, reference);
  if (!pictures.empty()) row.pictures_ratio = paired_ratio(*light, pictures, reference);
  row.counts = technique.counts(scattering_fraction(subject), d_of(subject.frame, subject.d_px));
  if (technique.request().heat_map)
    bench.maps.pictures.push_back(
        heat_map(fmt::format("{}, {}", name_of(subject), name_of(technique.request())), *light,
                 reference, subject.frame.description.width, subject.frame.profile));
  return demo::success();
}

// Runs all techniques in turn repeatedly, so that other load on the machine affects all of them
// equally. `first` is the row of the first technique.
demo::Result<> repeat_techniques(ErrorTimeBench& bench, size_t first, Progress& progress,
                                 uint64_t& done) {
  const ErrorTimeFile& file = bench.file;
  for (uint32_t round = 1; round < file.warm_up + file.repetitions; ++round)
    for (size_t t = 0; t < bench.techniques.size(); ++t) {
      if (interrupted()) return stopped();
      progress.update(++done);
      ErrorTimeRow& row = bench.measured[first + t];
      if (row.device_ms.size() >= file.repetitions) continue;
      if (file.row_milliseconds > 0 && row.device_ms.size() >= file.min_repetitions &&
          row.spent_ms >= file.row_milliseconds)
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

demo::Result<> measure_subject(ErrorTimeBench& bench, const Subject& subject, Progress& progress,
                               uint64_t& done) {
  const auto reference =
      make_reference(bench.run.session, subject.frame, "reference of " + name_of(subject),
                     bench.file.subset, bench.run.text("cache"));
  if (!reference) return stopped();
  const auto pictures = measure_pictures(bench, subject, *reference);
  if (!pictures) return pictures.error();
  const size_t first = bench.measured.size();
  const CapturedFrame window = window_of(subject.frame, bench.file.self_window);
  const Reference in_window = inside(window, *reference);
  std::optional<std::vector<float>> self;
  std::string self_of; // technique of `self`, which numbers of samples share
  for (const auto& technique : bench.techniques) {
    if (interrupted()) return stopped();
    ErrorTimeRow one{&subject, &technique->request()};
    const std::string of = self_name(bench.file, technique->request());
    if (self_of != of) {
      auto found = self_reference(bench, *technique, subject, window);
      if (!found) return found.error();
      self = found.take();
      self_of = of;
    }
    if (self && !in_window.pixels.empty()) { // the other size creates the graph twice more
      const auto part = technique->scatter(window);
      if (!part) return part.error();
      one.psnr_db_self = psnr_between(*part, *self, in_window);
    }
    if (auto measured = measure_technique(bench, *technique, one, *reference, *pictures); !measured)
      return measured;
    if (bench.file.repetitions == 0) progress.update(++done);
    bench.measured.push_back(std::move(one));
  }
  return bench.file.repetitions > 0 ? repeat_techniques(bench, first, progress, done)
                                    : demo::success();
}

Plot plot_of(const Subject& subject, std::span<const ErrorTimeRow> rows) {
  Plot plot{fmt::format("{} {}, d = {:.2f} px", subject.scene, subject.framing, subject.d_px),
            "device time, ms",
            "RMSE of linear luminance",
            {}};
  for (const ErrorTimeRow& row : rows) {
    const double rmse = row.error.figures.rmse;
    if (row.subject != &subject || !row.device || !(rmse > 0)) continue;
    const double ms = row.device->median;
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

// Sets medians, ratios to the baseline and the Pareto front of the rows of one subject.
void complete_rows(const ErrorTimeFile& file, std::span<ErrorTimeRow> rows) {
  std::vector<Cost> costs;
  const ErrorTimeRow* baseline = nullptr;
  for (ErrorTimeRow& row : rows) {
    if (!row.device_ms.empty()) {
      row.device = spread_of(row.device_ms);
      costs.push_back({row.device->median, row.error.figures.rmse});
    }
    if (row.request->technique == file.baseline_technique &&
        row.request->setting == file.baseline_setting)
      baseline = &row;
  }
  const std::vector<bool> front = pareto_front(costs);
  size_t timed = 0;
  for (ErrorTimeRow& row : rows) {
    if (row.device) row.on_front = front[timed++];
    if (baseline == nullptr) continue;
    if (row.device && baseline->device)
      row.time_ratio = row.device->median / baseline->device->median;
    if (const double rmse = baseline->error.figures.rmse; rmse > 0)
      row.rmse_ratio = row.error.figures.rmse / rmse;
  }
}

// Adds facts, a plot per subject with its Pareto front, and images.
void add_error_time_report(const ErrorTimeBench& bench) {
  SuiteRun& run = bench.run;
  const ErrorTimeFile& file = bench.file;
  run.add_info("size", fmt::format("{}x{} pixels", bench.size.width, bench.size.height));
  if (file.repetitions > 0)
    run.add_info("repetitions",
                 fmt::format("median of {} after {} to warm up, all techniques in turn{}",
                             file.repetitions, file.warm_up, early_end(file)));
  run.add_info("truth",
               fmt::format("everywhere on planes, else at {} stratified pixels", file.subset));
  run.add_info(
      "reads a pixel",
      "counted from the kernels' source (integration/tools/references/image_reads.cpp) times the "
      "texels each pass computes for a pixel of the view");
  run.add_info("baseline", fmt::format("{} {}", file.baseline_technique, file.baseline_setting));
  run.report.pictures = {scene_pictures(bench.subjects), bench.maps};
  if (file.repetitions == 0) return;
  for (const Subject& subject : bench.subjects)
    run.report.plots.push_back(plot_of(subject, bench.measured));
}

// Measures all selected subjects and completes their rows.
demo::Result<> measure_subjects(ErrorTimeBench& bench) {
  const ErrorTimeFile& file = bench.file;
  const uint64_t rounds = file.repetitions > 0 ? file.warm_up + file.repetitions - 1 : 1;
  Progress progress =
      bench.run.progress("run", rounds * bench.techniques.size() * bench.subjects.size());
  uint64_t done = 0;
  for (const Subject& subject : bench.subjects) {
    const size_t first = bench.measured.size();
    if (auto measured = measure_subject(bench, subject, progress, done); !measured) return measured;
    complete_rows(file, std::span(bench.measured).subspan(first));
  }
  for (const ErrorTimeRow& one : bench.measured)
    if (!one.counts.unknown_pass_type.empty())
      bench.run.add_note(fmt::format("reads_per_pixel of {}: the reads of '{}' are unknown",
                                     one.request->graph, one.counts.unknown_pass_type));
  return demo::success();
}

demo::Result<> measure_error_time(SuiteRun& run, const Emit<ErrorTimeRow>& emit) {
  if (run.flag("family")) run.options.at("file") = std::string(family_file);
  auto read = run.read(read_error_time);
  if (!read) return read.error();
  ErrorTimeFile file = read.take();
  if (run.quick) {
    file.repetitions = std::min(file.repetitions, 1u);
    file.warm_up = file.min_repetitions = 1;
    file.subset = std::min(file.subset, quick_subset);
    file.self_scenes.clear();
  }
  if (auto known = check_techniques(run, file.techniques); !known) return known;
  const auto host = run.open_device();
  if (!host) return host.error();
  const bool small = file.family && !run.quick;
  ErrorTimeBench bench{run, file, **host, small ? Size{family_width, family_height} : run.size()};
  bench.maps = {"Error maps", heat_map_explanation(), {}};
  for (const std::string& folder : run.list("pictures"))
    bench.pictures.push_back({"pictures", folder, folder, {}});
  if (auto ready = add_subjects(bench); !ready) return ready;
  if (const std::string& folder = run.text("write-captures"); !folder.empty()) {
    if (bench.subjects.back().number + 1 != bench.subjects.size())
      return demo::Error{demo::ErrorKind::usage, "--write-captures needs all scenes"};
    return write_captures(folder, bench.subjects, bench.profiles);
  }
  if (auto ready = add_techniques(bench); !ready) return ready;
  if (auto measured = measure_subjects(bench); !measured) return measured;
  add_error_time_report(bench);
  if (file.family) add_family_summary(bench);
  for (const ErrorTimeRow& row : bench.measured)
    emit(row);
  return demo::success();
}

template <auto Figure> ReportValue error_of(const ErrorTimeRow& row) {
  return row.error.figures.*Figure;
}

template <auto Figure> ReportValue device_of(const ErrorTimeRow& row) {
  return row.device ? ReportValue((*row.device).*Figure) : ReportValue();
}

template <auto Figure> ReportValue pictures_ratio_of(const ErrorTimeRow& row) {
  return row.pictures_ratio ? ReportValue((*row.pictures_ratio).*Figure) : ReportValue();
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
           "Error of the scattered light before albedo against the fp64 reference: linear Rec.709 "
           "luminance, the scene's 99.9th percentile of light at 1. Time is the sum of the "
           "device's "
           "timestamps over all passes of a technique.",
       .options = {size_option({640, 360}),
                   head_option(),
                   {.name = "family",
                    .help = fmt::format("Measure the seeded family of scenes instead ({}), at "
                                        "{}x{}; --scenes then also takes classes and halves",
                                        family_file, family_width, family_height),
                    .value = false,
                    .excludes = "size"},
                   {"write-captures",
                    "Only write the scenes as a capture, for `apply` of another build", "", "DIR"},
                   {"pictures",
                    "Folder that `apply` of another build wrote for that capture; may be repeated. "
                    "Ratios are to the first",
                    std::vector<std::string>(), "DIR"},
                   {.name = "frames",
                    .help = "Frames at rest per scene, for techniques with a history",
                    .value = uint64_t{1},
                    .minimum = 1},
                   {"study", "Also measure close-up, profile and whole head", false},
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
       {"device_ms", "ms", device_of<&Spread::median>, four},
       {"device_ms_low", "", device_of<&Spread::p10>},
       {"device_ms_high", "", device_of<&Spread::p90>},
       {"repetitions", "", [](const Row& row) { return row.device_ms.size(); }},
       {"sampling_ms", "scattering ms",
        [](const Row& row) {
          return row.sampling_ms.empty() ? ReportValue() : median(row.sampling_ms);
        },
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
       {"pictures_ratio", "RMSE / pictures", pictures_ratio_of<&PairedRatio::ratio>, page},
       {"pictures_ratio_low", "", pictures_ratio_of<&PairedRatio::low>},
       {"pictures_ratio_high", "", pictures_ratio_of<&PairedRatio::high>},
       {"class", "", [](const Row& row) { return row.subject->member.scene_class; }},
       {"half", "", [](const Row& row) { return row.subject->member.half; }},
       {"seed", "", [](const Row& row) { return row.subject->member.seed; }},
       {"pixels", "", error_of<&Figures::pixels>},
       {"population", "", [](const Row& row) { return row.error.population; }},
       {"on_pareto_front", "front", &Row::on_front, {.goal = Goal::best}}},
      measure_error_time);
}

} // namespace dermis::tools
