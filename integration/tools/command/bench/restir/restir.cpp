// dermis bench restir: compares light by rays with every reuse and shift of the graph, and
// screen-space techniques, with a reference by rays.

#include "integration/tools/command/bench/quick.hpp"
#include "integration/tools/command/bench/restir/claims.hpp"
#include "integration/tools/command/bench/restir/restir_report.hpp"
#include "integration/tools/command/bench/selection.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "passes/common/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace dermis::tools {
namespace {

// Progress in frames.
struct Steps {
  Progress progress;
  uint64_t done = 0;

  void reach(uint64_t frames) { progress.update(done = frames); }
};

struct Bench {
  const Session& session;
  const BenchRestirOptions& options;
  const RestirFile& file;
  const LoadedGraph& loaded;
  demo::VulkanHost& host;
  SubjectOptions subject_options = {};
  bool reuses = false; // the graph has settings for reuse
  std::vector<RestirVariant> variants = {};
  Report report = {};
};

double median_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

RayRequest request_of(const Bench& bench, const RestirVariant& variant) {
  RayRequest request{bench.loaded, bench.file.graph, {{"technique", "restir"}}};
  if (bench.reuses) request.set.emplace_back("reuse", variant.reuse);
  if (!variant.shift.empty()) request.set.emplace_back("shift", variant.shift);
  return request;
}

uint32_t settle_of(const RestirFile& file, const RestirVariant& variant) {
  return variant.has_history() ? file.settle : 1; // the driver compiles in the first frame
}

demo::Result<RestirRow> measure_variant(Bench& bench, const SceneRequest& scene, const RayRegions& regions,
                                        const RestirVariant& variant, uint32_t samples, double& slab_rms,
                                        Steps& steps) {
  RestirRow row{"restir", samples == 1 ? "1 path" : fmt::format("{} paths", samples), variant, samples};
  RayRequest request = request_of(bench, variant);
  request.step = [&] { steps.reach(steps.done + 1); };
  request.set.emplace_back("samples", fmt::format("{}", samples));
  const uint32_t settle = settle_of(bench.file, variant);
  request.frames = settle + bench.file.frames;
  std::vector<LightError> errors;
  std::vector<double> times;
  uint32_t frame = 0;
  auto done =
      scatter_by_rays(request, scene, bench.subject_options, [&](const RayFrame& one) -> demo::Result<> {
        if (frame++ < settle) return demo::success();
        slab_rms = one.slab_rms;
        errors.push_back(measure_light(one.light, regions));
        times.push_back(one.device_ms);
        row.light = one.light;
        return demo::success();
      });
  if (!done) return done.error();
  for (const std::string& credit : *done)
    if (const std::pair<std::string, std::string> fact{"credit", credit};
        std::find(bench.report.info.begin(), bench.report.info.end(), fact) == bench.report.info.end())
      bench.report.info.push_back(fact);
  row.error = mean_of(errors);
  row.device_ms = median_of(times);
  return row;
}

demo::Result<RestirRow> measure_in_screen_space(Bench& bench, const TechniqueRequest& request,
                                                const Subject& subject, const RayRegions& regions,
                                                std::span<const float> sap_tables) {
  RestirRow row{request.technique, request.setting};
  auto run = TechniqueRun::create(bench.host, request, subject.frame.description.profiles, sap_tables);
  if (!run) return run.error();
  auto light = (*run)->scatter(subject.frame);
  if (!light) return light.error();
  std::vector<double> times;
  for (uint32_t i = 0; i < bench.file.repetitions; ++i) {
    const auto one = (*run)->run_again();
    if (!one) return one.error();
    times.push_back(one->device);
  }
  row.light = light.take();
  row.error = measure_light(row.light, regions);
  row.device_ms = median_of(times);
  row.heat_map = request.heat_map;
  return row;
}

// Selects error maps: the row without reuse, and the row with the smallest error for equal paths.
void choose_pictures(std::vector<RestirRow>& rows) {
  RestirRow* nearest = &rows.front();
  for (RestirRow& row : rows)
    if (row.samples == rows.front().samples && row.error.all.mse < nearest->error.all.mse) nearest = &row;
  rows.front().heat_map = nearest->heat_map = true;
}

demo::Result<> measure_scene(Bench& bench, const SceneRequest& request, Steps& steps) {
  auto subject = render_subject(request, bench.subject_options);
  if (!subject) return subject.error();
  RestirScene scene{subject.take(), {}, {}, {}, {}};
  RayRequest none = request_of(bench, bench.variants.front());
  none.step = [&] { steps.reach(steps.done + 1); };
  // also if the reference is cached
  const uint64_t after_reference = steps.done + bench.file.reference.frames;
  auto reference = make_ray_reference(bench.file.reference, none, request, scene.subject,
                                      bench.subject_options, bench.options.cache);
  if (!reference) return reference.error();
  steps.reach(after_reference);
  scene.reference = reference.take();
  scene.regions = split_by_light(scene.reference.reference, scene.subject.frame, bench.file.thin_mm);
  for (const uint32_t samples : bench.file.samples) {
    const size_t first = scene.rows.size();
    for (const RestirVariant& variant : bench.variants) {
      auto row = measure_variant(bench, request, scene.regions, variant, samples, scene.slab_rms, steps);
      if (!row) return row.error();
      scene.rows.push_back(row.take());
      const RestirRow& base = scene.rows[first];
      RestirRow& last = scene.rows.back();
      last.ratio_to_none =
          ratio_at_equal_time(last.error.all.mse, last.device_ms, base.error.all.mse, base.device_ms);
    }
  }
  scene.slab_rms *= scene.reference.reference.exposure;
  if (!bench.options.quick) expect_of_reuse(scene.rows); // a few frames are not significant
  choose_pictures(scene.rows);
  const std::vector<float> sap_tables = subsurface::make_sap_tables({true, true}, {});
  for (const TechniqueRequest& technique : bench.file.screen_space) {
    if (interrupted()) return stopped();
    auto row = measure_in_screen_space(bench, technique, scene.subject, scene.regions, sap_tables);
    if (!row) return row.error();
    scene.rows.push_back(row.take());
  }
  add_scene(bench.report, scene);
  return demo::success();
}

demo::Result<> measure(Bench& bench) {
  std::vector<SceneRequest> scenes;
  for (const SceneRequest& scene : bench.file.scenes) {
    if (!is_selected(bench.options.scenes, scene.scene)) continue;
    const std::string reason = scene.model ? why_no_head(bench.options.head) : "";
    if (reason.empty())
      scenes.push_back(scene);
    else
      bench.report.notes.push_back(fmt::format("scene {}: {}", scene.scene, reason));
  }
  if (scenes.empty()) return demo::Error{demo::ErrorKind::usage, "no scene is selected"};
  uint64_t frames = 0;
  for (const RestirVariant& variant : bench.variants)
    frames += settle_of(bench.file, variant) + bench.file.frames;
  frames = bench.file.reference.frames + frames * bench.file.samples.size();
  Steps steps{
      Progress(progress_style(bench.session.quiet, false), "restir", "frame", frames * scenes.size())};
  for (const SceneRequest& scene : scenes)
    if (auto measured = measure_scene(bench, scene, steps); !measured) return measured;
  return demo::success();
}

} // namespace

ExitCode bench_restir(const Session& session, const BenchRestirOptions& requested) {
  const BenchRestirOptions options = quickened(requested);
  const auto start = std::chrono::steady_clock::now();
  Diagnostics diagnostics;
  std::optional<RestirFile> file = read_restir(options.file, diagnostics);
  if (!file)
    return fail(session, ExitCode::problems, fmt::format("the bench file '{}' cannot be used", options.file),
                &diagnostics);
  if (options.quick) quicken(*file);
  const std::optional<LoadedGraph> loaded = load_graph(file->graph, {}, diagnostics);
  if (!loaded) return fail_graph(session, file->graph, diagnostics);
  auto host = demo::create_vulkan_host({});
  if (!host) return fail(session, static_cast<ExitCode>(host.error().kind), host.error().text);
  if (const std::string reason = why_no_rays(**host); !reason.empty())
    return fail(session, ExitCode::environment, reason);

  Bench bench{session, options, *file, *loaded, **host};
  bench.subject_options = {options.size.width, options.size.height, head_model(options.head)};
  const std::vector<RestirVariant> variants = variants_of(loaded->graph);
  bench.reuses = variants.size() > 1;
  for (const RestirVariant& variant : variants)
    if (variant.shift.empty() || is_selected(options.shifts, variant.shift))
      bench.variants.push_back(variant);
  if (bench.reuses && bench.variants.size() == 1)
    return fail(session, ExitCode::usage, fmt::format("'{}' has none of these shifts", file->graph));
  bench.report = start_restir_report(*file);
  const auto done = measure(bench);
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!done) return fail(session, static_cast<ExitCode>(done.error().kind), done.error().text);
  Report& report = bench.report;
  auto info = machine_info(session.command, (*host)->properties.deviceName);
  info.emplace_back("size", fmt::format("{}x{} pixels", options.size.width, options.size.height));
  report.info.insert(report.info.begin(), info.begin(), info.end());
  if (!bench.reuses)
    report.notes.push_back(fmt::format("reuse: '{}' has no settings 'reuse' and 'shift'", file->graph));
  if (options.quick) report.info.push_back(quick_fact());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.info.emplace_back("took", format_duration(seconds));
  if (!session.quiet && options.json != "-" && options.html != "-" && options.csv != "-") {
    std::string text = text_of_restir(report);
    for (const std::string& note : report.notes)
      text += fmt::format("left out: {}\n", note);
    print(text + fmt::format("took {}\n", format_duration(seconds)));
  }
  const std::string problem = deliver_report(report, options.json, options.csv, options.html);
  if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  const size_t broken = rows_that_err_more(report.table);
  if (broken == 0) return ExitCode::ok;
  return fail(session, ExitCode::problems, fmt::format("{} rows exceed the error expected of reuse", broken));
}

} // namespace dermis::tools
