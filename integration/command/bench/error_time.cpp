// dermis bench error-time: run time against error of every technique at every still scene, in one run.

#include "integration/command/bench/plan_file.hpp"
#include "integration/command/bench/quick.hpp"
#include "integration/command/bench/reference.hpp"
#include "integration/command/bench/report/heat_map.hpp"
#include "integration/command/bench/report/pareto.hpp"
#include "integration/command/bench/report/report.hpp"
#include "integration/command/bench/still_error.hpp"
#include "integration/command/bench/technique.hpp"
#include "integration/command/interrupt.hpp"
#include "integration/command/run/truth_run.hpp"
#include "integration/files/capture_truth.hpp"
#include "passes/subsurface/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

namespace dermis::tools {
namespace {

// Metres from the bottom of the shoulders to the crown: .24 m from chin to crown.
constexpr double head_height = 0.426;

struct Spread {
  double median = 0, low = 0, high = 0; // low and high: 10 % and 90 %
};

Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<size_t>(share * double(values.size() - 1) + 0.5)];
  };
  return {at(0.5), at(0.1), at(0.9)};
}

struct Measured {
  size_t technique = 0, subject = 0;
  double spent_ms = 0;  // in timed runs, with all that the host does
  uint32_t to_warm = 0; // runs left that are not timed
  StillError error;
  TechniqueCounts counts;
  std::vector<double> device_ms, sampling_ms;
  std::optional<double> psnr_db_self;
};

struct Bench {
  const Session& session;
  const BenchErrorTimeOptions& options;
  const ErrorTimeFile& file;
  demo::VulkanHost& host;
  std::vector<Subject> subjects = {};
  std::vector<CaptureProfile> profiles = {}; // of all subjects, under ids of their own
  std::vector<std::unique_ptr<TechniqueRun>> techniques = {};
  std::vector<float> sap_tables = {};
  std::vector<Measured> measured = {};
  std::vector<std::string> notes = {};
  ReportPictures maps = {};
};

demo::Error stopped() {
  return {demo::ErrorKind::environment, "stopped"};
}

// All scenes share one list of profiles, so that a technique's tables and pipelines are made once.
void adopt_profiles(Bench& bench, CapturedFrame& frame) {
  std::array<uint8_t, 256> renumbered{};
  std::vector<CaptureProfile> own;
  for (const CaptureProfile& one : frame.description.profiles) {
    auto known = std::find_if(bench.profiles.begin(), bench.profiles.end(), [&](const CaptureProfile& other) {
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

bool asked_for(const std::vector<std::string>& only, const std::string& name) {
  return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
}

// Why a scene is left out; "" when it is not.
std::string why_not(const Bench& bench, const SceneRequest& scene) {
  const BenchErrorTimeOptions& options = bench.options;
  if (scene.study && !options.study) return "only with --study";
  if (!scene.model) return "";
  if (options.head.empty()) return "no model was given (--head FOLDER)";
  const std::string mesh = (std::filesystem::path(options.head) / "LeePerrySmith.glb").string();
  return std::filesystem::exists(mesh) ? "" : fmt::format("there is no '{}'", mesh);
}

demo::Result<> add_subjects(Bench& bench) {
  Diagnostics diagnostics;
  const auto document = read_document(bench.file.skin, diagnostics);
  const auto skin = document ? subsurface::read_profile(*document, diagnostics) : std::nullopt;
  if (!skin)
    return demo::Error{demo::ErrorKind::input, format_for_people(diagnostics, diagnostics.list.front())};
  SubjectOptions options{bench.options.size.width, bench.options.size.height, {}};
  const std::filesystem::path head = bench.options.head;
  options.model = {(head / "LeePerrySmith.glb").string(), (head / "Map-COL.jpg").string(),
                   (head / "Infinite-Level_02_Tangent_SmoothUV.jpg").string(),
                   (head / "Map-SPEC.jpg").string(), head_height};
  Progress progress(progress_style(bench.session.quiet, false), "scenes", "scene", bench.file.scenes.size());
  uint64_t done = 0;
  for (const SceneRequest& scene : bench.file.scenes) {
    if (interrupted()) return stopped();
    progress.update(done++);
    if (!asked_for(bench.options.scenes, scene.scene)) continue;
    if (const std::string reason = why_not(bench, scene); !reason.empty()) {
      bench.notes.push_back(fmt::format("scene {} {}: {}", scene.scene, scene.framing, reason));
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
  if (bench.subjects.empty()) return demo::Error{demo::ErrorKind::usage, "no scene is left to measure"};
  for (Subject& subject : bench.subjects)
    adopt_profiles(bench, subject.frame);
  return demo::success();
}

demo::Result<> add_techniques(Bench& bench) {
  bench.sap_tables = subsurface::make_sap_tables({true, true}, {});
  for (const TechniqueRequest& request : bench.file.techniques) {
    const std::string name = fmt::format("{} {}", request.technique, request.setting);
    if (!asked_for(bench.options.techniques, request.technique)) continue;
    if (!std::filesystem::exists(request.graph)) {
      bench.notes.push_back(fmt::format("technique {}: there is no graph '{}'", name, request.graph));
      continue;
    }
    auto made = TechniqueRun::create(bench.host, request, bench.profiles, bench.sap_tables);
    if (!made) return made.error();
    bench.techniques.push_back(made.take());
  }
  if (bench.techniques.empty()) return demo::Error{demo::ErrorKind::usage, "no technique is left to measure"};
  return demo::success();
}

// Median projected d of the frame, per channel; and the share of its subsurface pixels that scatter at all.
struct Scattering {
  subsurface::PerChannel d_px{};
  double share = 1;
};

Scattering scattering_of(const Subject& subject) {
  constexpr double copy_below_d_px = 0.0546; // shaders/include/radius.glsl
  const TruthFrame frame = make_truth_frame(subject.frame);
  const double pixel = std::sqrt(std::abs(frame.rays.scale_x * frame.rays.scale_y));
  std::vector<double> ratio_to_widest;
  Scattering result;
  uint64_t all = 0, scattered = 0;
  std::array<double, 256> count{};
  for (size_t i = 0; i < frame.profile.size(); ++i) {
    const uint8_t id = frame.profile[i];
    if (id == 0) continue;
    const auto& d = frame.d_m[id];
    const double scale = frame.scatter_scale.empty() ? 1.0 : double(frame.scatter_scale[i]);
    const double footprint = pixel * (frame.rays.perspective ? double(frame.depth[i]) : 1.0);
    ++all;
    ++count[id];
    scattered += *std::max_element(d.begin(), d.end()) * scale / footprint >= copy_below_d_px;
  }
  const auto most = static_cast<size_t>(std::max_element(count.begin(), count.end()) - count.begin());
  const auto& d = frame.d_m[most];
  const double widest = std::max({d[0], d[1], d[2]});
  for (size_t c = 0; c < 3; ++c)
    result.d_px[c] = widest > 0 ? subject.d_px * d[c] / widest : 0;
  result.share = all > 0 ? double(scattered) / double(all) : 0;
  return result;
}

// The same technique with so many samples that it is its own limit. Deterministic ones have none.
demo::Result<std::optional<std::vector<float>>> self_reference(Bench& bench, const TechniqueRun& technique,
                                                               const Subject& subject,
                                                               const CapturedFrame& window) {
  const ErrorTimeFile& file = bench.file;
  TechniqueRequest request = technique.request();
  auto samples = std::find_if(request.set.begin(), request.set.end(),
                              [&](const NamedValue& one) { return one.first == file.self_setting; });
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

void add_times(Measured& row, const TechniqueTimes& times, std::chrono::steady_clock::time_point start) {
  row.spent_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  row.device_ms.push_back(times.device);
  row.sampling_ms.push_back(times.sampling);
}

// First runs are for the error, and where the technique has run at this size before also for the time; then
// all techniques in turn, again and again, so that whatever else the machine does meets all of them alike.
demo::Result<> measure(Bench& bench, size_t index, Progress& progress, uint64_t& done) {
  const Subject& subject = bench.subjects[index];
  const auto name = fmt::format("{} {} d {:.2f} px", subject.scene, subject.framing, subject.d_px);
  const auto reference = make_reference(bench.session, subject.frame, "truth of " + name, bench.file.subset,
                                        bench.options.cache);
  if (!reference) return stopped();
  const Scattering scattering = scattering_of(subject);
  const size_t first = bench.measured.size();
  const CapturedFrame window = window_of(subject.frame, bench.file.self_window);
  const Reference in_window = inside(window, *reference);
  std::optional<std::vector<float>> self;
  std::string self_of; // graph of that reference: settings of one technique share it
  for (size_t t = 0; t < bench.techniques.size(); ++t) {
    if (interrupted()) return stopped();
    TechniqueRun& technique = *bench.techniques[t];
    Measured one{t, index, 0, 0, {}, {}, {}, {}, {}};
    if (self_of != technique.request().graph) {
      auto found = self_reference(bench, technique, subject, window);
      if (!found) return found.error();
      self = found.take();
      self_of = technique.request().graph;
    }
    if (self && !in_window.pixels.empty()) { // of another size, so the graph is made twice more
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
    one.counts = technique.counts(scattering.share, scattering.d_px);
    if (technique.request().heat_map)
      bench.maps.pictures.push_back(
          heat_map(fmt::format("{}, {} {}", name, technique.request().technique, technique.request().setting),
                   *light, *reference, subject.frame.description.width, subject.frame.profile));
    bench.measured.push_back(std::move(one));
  }
  for (uint32_t round = 1; round < bench.file.warm_up + bench.file.repetitions; ++round)
    for (size_t t = 0; t < bench.techniques.size(); ++t) {
      if (interrupted()) return stopped();
      progress.update(++done);
      Measured& row = bench.measured[first + t];
      if (row.device_ms.size() >= bench.file.repetitions) continue;
      if (bench.file.row_milliseconds > 0 && row.device_ms.size() >= bench.file.least_repetitions &&
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

std::vector<ReportColumn> columns() {
  return {{"scene", "scene"},
          {"d_px", "d, px"},
          {"framing", "framing"},
          {"technique", "technique"},
          {"setting", "setting"},
          {"device_ms", "ms", 4},
          {"device_ms_low", ""},
          {"device_ms_high", ""},
          {"repetitions", ""},
          {"sampling_ms", "scattering ms", 4},
          {"mean_spp", "samples"},
          {"reads_per_pixel", "reads a pixel"},
          {"rmse", "RMSE"},
          {"rmse_low", ""},
          {"rmse_high", ""},
          {"rmse_r", ""},
          {"rmse_g", ""},
          {"rmse_b", ""},
          {"psnr_db", "PSNR dB", 4},
          {"max_error", "largest"},
          {"p99_error", "99 %"},
          {"psnr_db_sdr8", "8-bit dB", 4},
          {"psnr_db_self", "self dB", 4},
          {"transient_bytes", "bytes"},
          {"dispatches", "dispatches"},
          {"time_ratio", "ms / baseline"},
          {"rmse_ratio", "RMSE / baseline"},
          {"pixels", ""},
          {"population", ""},
          {"on_pareto_front", "front"}};
}

void fill_table(const Bench& bench, Report& report) {
  report.table.columns = columns();
  const size_t count = bench.techniques.size();
  for (size_t first = 0; first < bench.measured.size(); first += count) {
    std::vector<Cost> costs;
    const Measured* baseline = nullptr;
    for (size_t i = first; i < first + count; ++i) {
      const Measured& one = bench.measured[i];
      costs.push_back({spread_of(one.device_ms).median, one.error.figures.rmse});
      const TechniqueRequest& request = bench.techniques[one.technique]->request();
      if (request.technique == bench.file.baseline_technique &&
          request.setting == bench.file.baseline_setting)
        baseline = &one;
    }
    const std::vector<bool> front = pareto_front(costs);
    for (size_t i = first; i < first + count; ++i) {
      const Measured& one = bench.measured[i];
      const Subject& subject = bench.subjects[one.subject];
      const TechniqueRequest& request = bench.techniques[one.technique]->request();
      const Spread device = spread_of(one.device_ms);
      const ErrorFigures& error = one.error.figures;
      const auto optional = [](const std::optional<double>& value) {
        return value ? ReportValue(*value) : ReportValue();
      };
      ReportValue time_ratio, rmse_ratio;
      if (baseline != nullptr) {
        time_ratio = device.median / spread_of(baseline->device_ms).median;
        if (baseline->error.figures.rmse > 0) rmse_ratio = error.rmse / baseline->error.figures.rmse;
      }
      report.table.rows.push_back({subject.scene,
                                   subject.d_px,
                                   subject.framing,
                                   request.technique,
                                   request.setting,
                                   device.median,
                                   device.low,
                                   device.high,
                                   static_cast<int64_t>(one.device_ms.size()),
                                   spread_of(one.sampling_ms).median,
                                   one.counts.mean_spp,
                                   optional(one.counts.reads_per_pixel),
                                   error.rmse,
                                   error.rmse_low,
                                   error.rmse_high,
                                   error.rmse_rgb[0],
                                   error.rmse_rgb[1],
                                   error.rmse_rgb[2],
                                   error.psnr_db,
                                   error.max_error,
                                   error.p99_error,
                                   one.error.psnr_db_sdr8,
                                   optional(one.psnr_db_self),
                                   static_cast<int64_t>(one.counts.transient_bytes),
                                   static_cast<int64_t>(one.counts.dispatches),
                                   time_ratio,
                                   rmse_ratio,
                                   static_cast<int64_t>(error.pixels),
                                   static_cast<int64_t>(one.error.population),
                                   static_cast<bool>(front[i - first])});
    }
  }
}

void fill_plots(const Bench& bench, Report& report) {
  for (size_t s = 0; s < bench.subjects.size(); ++s) {
    const Subject& subject = bench.subjects[s];
    Plot plot{fmt::format("{} {}, d = {:.2f} px", subject.scene, subject.framing, subject.d_px),
              "device time, ms",
              "RMSE of linear luminance",
              {}};
    for (size_t row = 0; row < bench.measured.size(); ++row) {
      const Measured& one = bench.measured[row];
      if (one.subject != s || !(one.error.figures.rmse > 0)) continue;
      const TechniqueRequest& request = bench.techniques[one.technique]->request();
      if (plot.series.empty() || plot.series.back().name != request.technique)
        plot.series.push_back({request.technique, {}, is_baseline(request.technique)});
      const double ms = spread_of(one.device_ms).median;
      plot.series.back().points.push_back({ms, one.error.figures.rmse,
                                           fmt::format("{} {}: {:.2f} ms, RMSE {:.5f}", request.technique,
                                                       request.setting, ms, one.error.figures.rmse),
                                           std::get<bool>(report.table.at(row, "on_pareto_front"))});
    }
    report.plots.push_back(std::move(plot));
  }
}

std::string text_of(const Report& report) {
  Table table;
  table.columns = {{"scene"},         {"framing"},     {"d px", true}, {"technique"},
                   {"setting"},       {"ms", true},    {"RMSE", true}, {"PSNR dB", true},
                   {"largest", true}, {"reads", true}, {"front"}};
  std::string last;
  ReportTable rows = report.table;
  for (size_t i = 0; i < rows.rows.size(); ++i) {
    const auto text = [&](const char* key) { return std::get<std::string>(rows.at(i, key)); };
    const auto number = [&](const char* key, int digits) {
      const auto* value = std::get_if<double>(&rows.at(i, key));
      return value != nullptr ? fmt::format("{:.{}f}", *value, digits) : std::string("-");
    };
    const std::string here = text("scene") + text("framing") + number("d_px", 3);
    if (!last.empty() && here != last) table.rows.emplace_back();
    last = here;
    table.rows.push_back({text("scene"), text("framing"), number("d_px", 2), text("technique"),
                          text("setting"), number("device_ms", 2), number("rmse", 5), number("psnr_db", 2),
                          number("max_error", 4), number("reads_per_pixel", 1),
                          std::get<bool>(rows.at(i, "on_pareto_front")) ? "*" : ""});
  }
  return format_table(table);
}

std::string early_end(const ErrorTimeFile& file) {
  if (file.row_milliseconds == 0) return "";
  return fmt::format("; a technique that took {} ms at a scene ends there, after {} at least",
                     file.row_milliseconds, file.least_repetitions);
}

Report make_report(const Bench& bench, double seconds) {
  Report report;
  report.bench = "error-time";
  report.title = "Run time against error";
  report.summary =
      "Error of the scattered light before albedo against the fp64 truth: linear Rec.709 luminance, the "
      "scene's 99.9th percentile of light at 1. Time is the sum of the device's timestamps over all passes "
      "of a technique.";
  report.facts = machine_facts(bench.session.command, bench.host.properties.deviceName);
  report.facts.emplace_back("size",
                            fmt::format("{}x{} pixels", bench.options.size.width, bench.options.size.height));
  report.facts.emplace_back("repetitions",
                            fmt::format("median of {} after {} to warm up, all techniques in turn{}",
                                        bench.file.repetitions, bench.file.warm_up, early_end(bench.file)));
  report.facts.emplace_back(
      "truth", fmt::format("everywhere on planes, else at {} stratified pixels", bench.file.subset));
  report.facts.emplace_back("reads a pixel",
                            "counted from the kernels' source (passes/subsurface/image_reads.cpp) times "
                            "the texels each pass computes for a pixel of the view");
  report.facts.emplace_back("baseline",
                            fmt::format("{} {}", bench.file.baseline_technique, bench.file.baseline_setting));
  if (bench.options.quick) report.facts.push_back(quick_fact());
  report.facts.emplace_back("took", format_duration(seconds));
  report.notes = bench.notes;
  report.pictures.push_back(scene_pictures(bench.subjects));
  fill_table(bench, report);
  fill_plots(bench, report);
  report.pictures.push_back(bench.maps);
  return report;
}

} // namespace

ExitCode bench_error_time(const Session& session, const BenchErrorTimeOptions& asked) {
  const BenchErrorTimeOptions options = quickened(asked);
  const auto start = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  std::optional<ErrorTimeFile> file = read_error_time(options.file, diagnostics);
  if (!file)
    return fail(session, ExitCode::problems, fmt::format("the bench file '{}' cannot be used", options.file),
                &diagnostics);
  if (options.quick) quicken(*file);
  auto host = demo::create_vulkan_host({});
  if (!host) return fail(session, static_cast<ExitCode>(host.error().kind), host.error().text);
  Bench bench{session, options, *file, **host};
  bench.maps.title = "Where it errs";
  bench.maps.explanation = heat_map_explanation();
  const auto run = [&]() -> demo::Result<> {
    if (auto ready = add_subjects(bench); !ready) return ready;
    if (auto ready = add_techniques(bench); !ready) return ready;
    const uint64_t rounds = bench.file.warm_up + bench.file.repetitions - 1;
    Progress progress(progress_style(session.quiet, false), "error-time", "run",
                      rounds * bench.techniques.size() * bench.subjects.size());
    uint64_t done = 0;
    for (size_t i = 0; i < bench.subjects.size(); ++i)
      if (auto measured = measure(bench, i, progress, done); !measured) return measured;
    return demo::success();
  };
  const auto done = run();
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!done) return fail(session, static_cast<ExitCode>(done.error().kind), done.error().text);
  for (const Measured& one : bench.measured)
    if (!one.counts.unknown_kind.empty()) {
      const std::string note =
          fmt::format("reads_per_pixel of {}: nobody has counted those of '{}'",
                      bench.techniques[one.technique]->request().graph, one.counts.unknown_kind);
      if (std::find(bench.notes.begin(), bench.notes.end(), note) == bench.notes.end())
        bench.notes.push_back(note);
    }
  const Report report =
      make_report(bench, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  if (options.json != "-" && options.csv != "-" && options.html != "-") {
    std::string text = text_of(report);
    for (const std::string& note : report.notes)
      text += fmt::format("left out: {}\n", note);
    if (!session.quiet) print(text + fmt::format("took {}\n", report.facts.back().second));
  }
  const std::string problem = deliver_report(report, options.json, options.csv, options.html);
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

} // namespace dermis::tools
