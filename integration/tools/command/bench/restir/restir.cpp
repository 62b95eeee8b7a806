// dermis bench restir: compares light by rays with every reuse and shift of the graph, and
// screen-space techniques, with a reference by rays.

#include "integration/tools/command/bench/restir/claims.hpp"
#include "integration/tools/command/bench/restir/restir_report.hpp"
#include "integration/tools/command/bench/suite/techniques.hpp"
#include "integration/tools/command/bench/technique.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/statistics.hpp"
#include "passes/common/environment.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

// Progress in frames.
struct Steps {
  Progress progress;
  uint64_t done = 0;

  void reach(uint64_t frames) { progress.update(done = frames); }
};

struct RestirBench {
  SuiteRun& run;
  const RestirFile& file;
  const LoadedGraph& loaded;
  demo::VulkanHost& host;
  SubjectOptions subject_options = {};
  bool reuses = false; // the graph has settings for reuse
  std::vector<RestirVariant> variants = {};
};

RayRequest request_of(const RestirBench& bench, const RestirVariant& variant) {
  RayRequest request{bench.loaded, bench.file.graph, {{"technique", "restir"}}};
  if (bench.reuses) request.set.emplace_back("reuse", variant.reuse);
  if (!variant.shift.empty()) request.set.emplace_back("shift", variant.shift);
  return request;
}

uint32_t settle_of(const RestirFile& file, const RestirVariant& variant) {
  return variant.has_history() ? file.settle : 1; // the driver compiles in the first frame
}

demo::Result<RestirRow> measure_variant(RestirBench& bench, const SceneRequest& scene,
                                        const RayRegions& regions, const RestirVariant& variant,
                                        uint32_t samples, double& slab_rms, Steps& steps) {
  RestirRow row{"restir", samples == 1 ? "1 path" : fmt::format("{} paths", samples), variant,
                samples};
  RayRequest request = request_of(bench, variant);
  request.step = [&] { steps.reach(steps.done + 1); };
  request.set.emplace_back("samples", fmt::format("{}", samples));
  const uint32_t settle = settle_of(bench.file, variant);
  request.frames = settle + bench.file.frames;
  std::vector<LightError> errors;
  std::vector<double> times;
  uint32_t frame = 0;
  auto done = scatter_by_rays(request, scene, bench.subject_options,
                              [&](const RayFrame& one) -> demo::Result<> {
                                if (frame++ < settle) return demo::success();
                                slab_rms = one.slab_rms;
                                errors.push_back(measure_light(one.light, regions));
                                times.push_back(one.device_ms);
                                row.light = one.light;
                                return demo::success();
                              });
  if (!done) return done.error();
  for (const std::string& credit : *done)
    bench.run.add_info("credit", credit);
  row.error = mean_of(errors);
  row.device_ms = median(times);
  return row;
}

demo::Result<RestirRow> measure_in_screen_space(RestirBench& bench, const TechniqueRequest& request,
                                                const Subject& subject, const RayRegions& regions,
                                                std::span<const float> sap_tables) {
  RestirRow row{request.technique, request.setting};
  auto run =
      TechniqueRun::create(bench.host, request, subject.frame.description.profiles, sap_tables);
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
  row.device_ms = median(times);
  row.heat_map = request.heat_map;
  return row;
}

// Selects error maps: the row without reuse, and the row with the smallest error for equal paths.
void choose_pictures(std::vector<RestirRow>& rows) {
  RestirRow* nearest = &rows.front();
  for (RestirRow& row : rows)
    if (row.samples == rows.front().samples && row.error.all.mse < nearest->error.all.mse)
      nearest = &row;
  rows.front().heat_map = nearest->heat_map = true;
}

demo::Result<> measure_ray_scene(RestirBench& bench, const SceneRequest& request, Steps& steps,
                                 const Emit<RestirRow>& emit) {
  auto subject = render_subject(request, bench.subject_options);
  if (!subject) return subject.error();
  RestirScene scene{subject.take(), {}, {}, {}, {}};
  RayRequest none = request_of(bench, bench.variants.front());
  none.step = [&] { steps.reach(steps.done + 1); };
  // also if the reference is cached
  const uint64_t after_reference = steps.done + bench.file.reference.frames;
  auto reference = make_ray_reference(bench.file.reference, none, request, scene.subject,
                                      bench.subject_options, bench.run.text("cache"));
  if (!reference) return reference.error();
  steps.reach(after_reference);
  scene.reference = reference.take();
  scene.regions =
      split_by_light(scene.reference.reference, scene.subject.frame, bench.file.thin_mm);
  for (const uint32_t samples : bench.file.samples) {
    const size_t first = scene.rows.size();
    for (const RestirVariant& variant : bench.variants) {
      auto row =
          measure_variant(bench, request, scene.regions, variant, samples, scene.slab_rms, steps);
      if (!row) return row.error();
      scene.rows.push_back(row.take());
      const RestirRow& base = scene.rows[first];
      RestirRow& last = scene.rows.back();
      last.ratio_to_none = ratio_at_equal_time(last.error.all.mse, last.device_ms,
                                               base.error.all.mse, base.device_ms);
    }
  }
  scene.slab_rms *= scene.reference.reference.exposure;
  if (!bench.run.quick) expect_of_reuse(scene.rows); // a few frames are not significant
  choose_pictures(scene.rows);
  const std::vector<float> sap_tables = subsurface::make_shared_sap_tables({true, true});
  for (const TechniqueRequest& technique : bench.file.screen_space) {
    if (interrupted()) return stopped();
    auto row = measure_in_screen_space(bench, technique, scene.subject, scene.regions, sap_tables);
    if (!row) return row.error();
    scene.rows.push_back(row.take());
  }
  add_pictures(bench.run.report, scene);
  for (RestirRow& row : scene.rows) {
    row.scene = &scene;
    emit(row);
  }
  return demo::success();
}

// Returns the scenes to measure. Errors: usage (there is none).
demo::Result<std::vector<SceneRequest>> select_scenes(SuiteRun& run, const RestirFile& file) {
  std::vector<SceneRequest> scenes;
  std::vector<std::string> known;
  for (const SceneRequest& scene : file.scenes) {
    known.push_back(scene.scene);
    if (!run.is_requested("scenes", scene.scene)) continue;
    const std::string reason = scene.model ? why_no_head(run.text("head")) : "";
    if (reason.empty())
      scenes.push_back(scene);
    else
      run.add_note(fmt::format("scene {}: {}", scene.scene, reason));
  }
  if (scenes.empty()) return no_scene_selected(std::move(known));
  return scenes;
}

demo::Result<> measure_scenes(RestirBench& bench, const Emit<RestirRow>& emit) {
  const auto scenes = select_scenes(bench.run, bench.file);
  if (!scenes) return scenes.error();
  uint64_t frames = 0;
  for (const RestirVariant& variant : bench.variants)
    frames += settle_of(bench.file, variant) + bench.file.frames;
  frames = bench.file.reference.frames + frames * bench.file.samples.size();
  Steps steps{bench.run.progress("frame", frames * scenes->size())};
  for (const SceneRequest& scene : *scenes)
    if (auto measured = measure_ray_scene(bench, scene, steps, emit); !measured) return measured;
  return demo::success();
}

// Shortens a file for --quick.
void quicken(RestirFile& file) {
  file.settle = file.frames = 2;
  file.repetitions = 1;
  file.reference = {16, 4};
  file.samples.resize(1);
  file.scenes.resize(1);
}

} // namespace

demo::Result<> measure_restir(SuiteRun& run, const Emit<RestirRow>& emit) {
  auto read = run.read(read_restir);
  if (!read) return read.error();
  RestirFile file = read.take();
  std::vector<std::string> known;
  for (const SceneRequest& scene : file.scenes)
    known.push_back(scene.scene);
  if (auto good = check_names(run, "scenes", known); !good) return good;
  if (run.quick) quicken(file);
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> loaded = load_graph(file.graph, {}, diagnostics);
  if (!loaded) return run.reject(file.graph, diagnostics);
  const auto host = run.open_device();
  if (!host) return host.error();
  RestirBench bench{run, file, *loaded, **host};
  bench.subject_options = {run.size().width, run.size().height, head_model(run.text("head"))};
  const std::vector<RestirVariant> variants = variants_of(loaded->graph);
  bench.reuses = variants.size() > 1;
  std::vector<std::string> shifts;
  for (const RestirVariant& variant : variants)
    if (!variant.shift.empty()) shifts.push_back(variant.shift);
  if (auto good = check_names(run, "shifts", shifts); bench.reuses && !good) return good;
  for (const RestirVariant& variant : variants)
    if (variant.shift.empty() || run.is_requested("shifts", variant.shift))
      bench.variants.push_back(variant);
  if (bench.reuses && bench.variants.size() == 1)
    return demo::Error{demo::ErrorKind::usage,
                       fmt::format("'{}' has none of these shifts", file.graph)};
  start_restir_report(run, file);
  if (auto done = measure_scenes(bench, emit); !done) return done;
  if (!bench.reuses)
    run.add_note(fmt::format("reuse: '{}' has no settings 'reuse' and 'shift'", file.graph));
  return demo::success();
}

} // namespace dermis::tools
