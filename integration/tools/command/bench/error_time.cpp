// dermis bench error-time: measures run time and error of every technique on every still scene in
// one run.

#include "integration/tools/command/bench/error_time_report.hpp"
#include "integration/tools/command/bench/quick.hpp"
#include "integration/tools/command/bench/reference.hpp"
#include "integration/tools/command/bench/report/heat_map.hpp"
#include "integration/tools/command/bench/selection.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/run/reference_run.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "passes/common/environment.hpp"

#include <fmt/format.h>
#include <set>
#include <string>

#include <algorithm>
#include <chrono>
#include <filesystem>

namespace dermis::tools {
namespace {

// Merges the frame's profiles into one list for all scenes, so that a technique's tables and
// pipelines are created once.
void adopt_profiles(ErrorTimeBench& bench, CapturedFrame& frame) {
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

// Returns the reason to leave the scene out, or "".
std::string why_not(const ErrorTimeBench& bench, const SceneRequest& scene) {
  const BenchErrorTimeOptions& options = bench.options;
  if (scene.study && !options.study) return "only with --study";
  return scene.model ? why_no_head(options.head) : "";
}

demo::Result<> add_subjects(ErrorTimeBench& bench) {
  Diagnostics diagnostics;
  const auto document = read_document(bench.file.skin, diagnostics);
  const auto skin = document ? subsurface::read_profile(*document, diagnostics) : std::nullopt;
  if (!skin)
    return demo::Error{demo::ErrorKind::input, format_for_people(diagnostics, diagnostics.list.front())};
  const SubjectOptions options{bench.options.size.width, bench.options.size.height,
                               head_model(bench.options.head)};
  Progress progress(progress_style(bench.session.quiet, false), "scenes", "scene", bench.file.scenes.size());
  uint64_t done = 0;
  for (const SceneRequest& scene : bench.file.scenes) {
    if (interrupted()) return stopped();
    progress.update(done++);
    if (!is_selected(bench.options.scenes, scene.scene)) continue;
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
  if (bench.subjects.empty()) return demo::Error{demo::ErrorKind::usage, "no scene is selected"};
  for (Subject& subject : bench.subjects)
    adopt_profiles(bench, subject.frame);
  return demo::success();
}

demo::Result<> add_techniques(ErrorTimeBench& bench) {
  bench.sap_tables = subsurface::make_sap_tables({true, true}, {});
  for (const TechniqueRequest& request : bench.file.techniques) {
    const std::string name = fmt::format("{} {}", request.technique, request.setting);
    if (!is_selected(bench.options.techniques, request.technique)) continue;
    if (!std::filesystem::exists(request.graph)) {
      bench.notes.push_back(fmt::format("technique {}: graph '{}' does not exist", name, request.graph));
      continue;
    }
    auto made = TechniqueRun::create(bench.host, request, bench.profiles, bench.sap_tables);
    if (!made) return made.error();
    bench.techniques.push_back(made.take());
  }
  if (!bench.techniques.empty()) return demo::success();
  std::set<std::string> known;
  for (const TechniqueRequest& request : bench.file.techniques)
    known.insert(request.technique);
  return demo::Error{demo::ErrorKind::usage,
                     fmt::format("no technique is selected; available: {}", fmt::join(known, ", "))};
}

// Median projected d of the frame per channel, and the fraction of its subsurface pixels that
// scatter.
struct Scattering {
  subsurface::PerChannel d_px{};
  double fraction = 1;
};

Scattering scattering_of(const Subject& subject) {
  constexpr double copy_below_d_px = 0.0546; // shaders/common/radius.glsl
  const ReferenceFrame frame = make_reference_frame(subject.frame);
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
  const auto maximum = static_cast<size_t>(std::max_element(count.begin(), count.end()) - count.begin());
  const auto& d = frame.d_m[maximum];
  const double widest = std::max({d[0], d[1], d[2]});
  for (size_t c = 0; c < 3; ++c)
    result.d_px[c] = widest > 0 ? subject.d_px * d[c] / widest : 0;
  result.fraction = all > 0 ? double(scattered) / double(all) : 0;
  return result;
}

// Runs the technique with a large number of samples, which approximates its own limit. Returns
// nullopt for deterministic techniques.
demo::Result<std::optional<std::vector<float>>> self_reference(ErrorTimeBench& bench,
                                                               const TechniqueRun& technique,
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

void add_times(ErrorTimeRow& row, const TechniqueTimes& times, std::chrono::steady_clock::time_point start) {
  row.spent_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  row.device_ms.push_back(times.device);
  row.sampling_ms.push_back(times.sampling);
}

// The first runs measure the error, and also the time if the technique already ran at this size.
// Then all techniques run in turn repeatedly, so that other load on the machine affects all of them
// equally.
demo::Result<> measure(ErrorTimeBench& bench, size_t index, Progress& progress, uint64_t& done) {
  const Subject& subject = bench.subjects[index];
  const auto name = fmt::format("{} {} d {:.2f} px", subject.scene, subject.framing, subject.d_px);
  const auto reference = make_reference(bench.session, subject.frame, "reference of " + name,
                                        bench.file.subset, bench.options.cache);
  if (!reference) return stopped();
  const Scattering scattering = scattering_of(subject);
  const size_t first = bench.measured.size();
  const CapturedFrame window = window_of(subject.frame, bench.file.self_window);
  const Reference in_window = inside(window, *reference);
  std::optional<std::vector<float>> self;
  std::string self_of; // graph of `self`, which settings of one technique share
  for (size_t t = 0; t < bench.techniques.size(); ++t) {
    if (interrupted()) return stopped();
    TechniqueRun& technique = *bench.techniques[t];
    ErrorTimeRow one{t, index, 0, 0, {}, {}, {}, {}, {}};
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
    one.counts = technique.counts(scattering.fraction, scattering.d_px);
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

} // namespace

ExitCode bench_error_time(const Session& session, const BenchErrorTimeOptions& requested) {
  const BenchErrorTimeOptions options = quickened(requested);
  const auto start = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  std::optional<ErrorTimeFile> file = read_error_time(options.file, diagnostics);
  if (!file)
    return fail(session, ExitCode::problems, fmt::format("the bench file '{}' cannot be used", options.file),
                &diagnostics);
  if (options.quick) quicken(*file);
  auto host = demo::create_vulkan_host({});
  if (!host) return fail(session, static_cast<ExitCode>(host.error().kind), host.error().text);
  ErrorTimeBench bench{session, options, *file, **host};
  bench.maps.title = "Error maps";
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
  for (const ErrorTimeRow& one : bench.measured)
    if (!one.counts.unknown_pass_type.empty()) {
      const std::string note =
          fmt::format("reads_per_pixel of {}: the reads of '{}' are unknown",
                      bench.techniques[one.technique]->request().graph, one.counts.unknown_pass_type);
      if (std::find(bench.notes.begin(), bench.notes.end(), note) == bench.notes.end())
        bench.notes.push_back(note);
    }
  const Report report = make_error_time_report(
      bench, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  if (options.json != "-" && options.csv != "-" && options.html != "-") {
    std::string text = text_of_error_time(report);
    for (const std::string& note : report.notes)
      text += fmt::format("left out: {}\n", note);
    if (!session.quiet) print(text + fmt::format("took {}\n", report.info.back().second));
  }
  const std::string problem = deliver_report(report, options.json, options.csv, options.html);
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

} // namespace dermis::tools
