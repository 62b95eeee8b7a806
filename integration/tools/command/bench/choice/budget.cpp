// dermis bench budget: measures how well frames keep to a budget and at what error, compared with
// the best single technique.

#include "framegraph/model/graph.hpp"
#include "integration/examples/demo_engine/files.hpp"
#include "integration/examples/demo_engine/scene/read_scene.hpp"
#include "integration/tools/command/bench/choice/budget_judge.hpp"
#include "integration/tools/command/bench/choice/still_run.hpp"
#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/run/budget_input.hpp"
#include "integration/tools/command/run/choice_sets.hpp"
#include "integration/tools/command/run/host_passes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

namespace dermis::tools {
namespace {

// x: 0 is the cost of the cheapest configuration, 1 of the best
constexpr double fractions[] = {0.25, 0.5, 1, 2};
constexpr uint32_t compared = 8; // judged frames per run whose error is measured

// The camera path of `dolly` takes five seconds. More frames at a lower rate cover the whole path.
struct Stretch {
  uint32_t times = 1;           // factor on the number of judged frames
  double frames_per_second = 0; // 0: the scene's rate
};

Stretch stretch_of(std::string_view scene) {
  return scene == "dolly" ? Stretch{2, 24} : Stretch{};
}

// A scene of configs/scenes, or a still scene of the generated family.
struct BudgetScene {
  std::string name;
  const FamilyScene* still = nullptr;
};

struct BudgetBench {
  SuiteRun& run;
  SceneRunRequest request;
  std::vector<std::vector<NamedValue>> sets; // one per configuration
  std::vector<BudgetScene> scenes;
  StillRuns* stills = nullptr; // if there are still scenes
  Progress& progress;
  const FamilyScene* still = nullptr; // the present scene, if it is one
  SharedScene shared = {};
  uint64_t done = 0;
  std::vector<BudgetRow> rows = {};
};

demo::Result<SceneRun> run_counted(BudgetBench& bench) {
  auto run = bench.still != nullptr ? bench.stills->run(bench.request, *bench.still, bench.shared)
                                    : run_scene(bench.run.session, bench.request, bench.shared);
  bench.progress.update(++bench.done);
  return run;
}

std::string file_of(const std::string& scene) {
  return shipped(fmt::format("configs/scenes/{}.json", scene));
}

// Resets the request for runs of a scene, without state of the previous scene.
void begin_scene(BudgetBench& bench, const BudgetScene& scene) {
  const Stretch stretch = stretch_of(scene.name);
  const uint32_t judged = stretch.times * uint32_t(bench.run.number("frames"));
  bench.request.scene = scene.still != nullptr ? "" : file_of(scene.name);
  bench.request.size = scene.still != nullptr && !bench.run.quick
                           ? Size{family_width, family_height}
                           : bench.run.size();
  bench.still = scene.still;
  bench.request.frames = unjudged_frames + judged;
  bench.request.frames_per_second = stretch.frames_per_second;
  bench.request.error_every = std::max(1u, judged / compared);
  bench.shared = {};
}

demo::Result<std::vector<Single>> measure_singles(BudgetBench& bench) {
  std::vector<Single> singles;
  bench.request.budget_ms = 0;
  bench.request.deterministic = true;
  for (const auto& set : bench.sets) {
    bench.request.set = set;
    const auto run = run_counted(bench);
    if (!run) return run.error();
    bench.run.device = run->device;
    singles.push_back(single_of(*run, set));
  }
  bench.request.set.clear();
  return singles;
}

std::string name_of(const Single& single) {
  std::string name;
  for (const auto& [setting, value] : single.set)
    name +=
        fmt::format("{}{}={}", name.empty() ? "" : " ", setting, value.substr(1, value.size() - 2));
  return name;
}

struct Budget {
  double x = 0, ms = 0;
};
// Returns the budgets of a scene, the first half of the cheapest configuration that scatters.
std::vector<Budget> budgets_of(const std::vector<Single>& singles) {
  std::vector<Budget> budgets;
  for (const double x : fractions)
    budgets.push_back({x, budget_at(singles, x)});
  const double first = budget_at(singles, 0), all = budget_at(singles, 1) - first;
  if (const Single* cheapest = cheapest_scattering(singles); cheapest != nullptr && all > 0) {
    const double ms = 0.5 * budget_of(*cheapest);
    budgets.insert(budgets.begin(), {(ms - first) / all, ms});
  }
  return budgets;
}

// Measures errors and modelled times of one row per budget.
demo::Result<> measure_by_calibration(BudgetBench& bench, const BudgetScene& scene) {
  begin_scene(bench, scene);
  const auto singles = measure_singles(bench);
  if (!singles) return singles.error();
  for (const Budget& budget : budgets_of(*singles)) {
    BudgetRow& row = bench.rows.emplace_back(BudgetRow{scene.name, budget.x, budget.ms});
    if (scene.still != nullptr) row.half = scene.still->member.half;
    if (none_scatters_within(*singles, budget.ms))
      row.unscattered_rmse = cheapest_of(*singles).rmse;
    bench.request.budget_ms = row.budget_ms;
    const auto run = run_counted(bench);
    if (!run) return run.error();
    row.over_model = fraction_over_model(*run, row.budget_ms);
    row.rmse = pooled_rmse(*run);
    row.chosen = chosen_of(*run);
    if (const Single* single = best_within(*singles, row.budget_ms)) {
      row.single_rmse = single->rmse;
      row.single = name_of(*single);
    }
  }
  return demo::success();
}

// Adds one timed run to each row of a scene.
demo::Result<> measure_by_time(BudgetBench& bench, const BudgetScene& scene) {
  if (scene.still != nullptr) return demo::success();
  begin_scene(bench, scene);
  bench.request.deterministic = false;
  bench.request.error_every = 0;
  for (BudgetRow& row : bench.rows) {
    if (row.scene != scene.name) continue;
    bench.request.budget_ms = row.budget_ms;
    const auto run = run_counted(bench);
    if (!run) return run.error();
    row.timed.push_back(judge_times(*run, row.budget_ms));
  }
  return demo::success();
}

// A temporary slowdown of the machine should affect one run per budget and not its median, so all
// other scenes are timed between two runs of one budget.
demo::Result<> measure_budgets(BudgetBench& bench) {
  for (const BudgetScene& scene : bench.scenes)
    if (auto measured = measure_by_calibration(bench, scene); !measured) return measured;
  for (uint64_t i = 0; i < bench.run.number("repetitions"); ++i)
    for (const BudgetScene& scene : bench.scenes)
      if (auto measured = measure_by_time(bench, scene); !measured) return measured;
  return demo::success();
}

// Finds the requested scenes. Returns the reason why they cannot be measured, or "". Runs before
// minutes are spent on other scenes.
std::string find_scenes(const SuiteRun& run, std::vector<BudgetScene>& scenes) {
  for (const std::string& name : run.list("scenes")) {
    const std::string file = file_of(name);
    if (!std::filesystem::exists(file)) {
      const auto stills = find_family_scenes(name);
      for (const FamilyScene* still : stills)
        scenes.push_back({still->name, still});
      if (!stills.empty()) continue;
      return fmt::format("there is no scene '{}': '{}' is missing, and the generated family has "
                         "no scene, class or half of that name",
                         name, file);
    }
    scenes.push_back({name});
    Diagnostics diagnostics;
    const auto scene = demo::read_scene(file, diagnostics);
    if (!scene) return format_for_people(diagnostics, diagnostics.list.front());
    const bool model =
        std::any_of(scene->objects.begin(), scene->objects.end(),
                    [](const demo::Object& object) { return object.shape == demo::Shape::model; });
    const std::string problem = model ? why_no_head(run.text("head")) : "";
    if (!problem.empty()) return fmt::format("scene {}: {}", name, problem);
  }
  return "";
}

// Adds plots of a scene's frame time and error over the budget.
void add_plots(Report& report, const std::vector<BudgetRow>& rows) {
  Plot time{"mean device time of a frame", "budget, ms", "ms", {}};
  Plot error{"error", "budget, ms", "RMSE of linear luminance", {}};
  for (const BudgetRow& row : rows) {
    if (row.timed.empty()) continue;
    if (time.series.empty() || time.series.back().name != row.scene) {
      time.series.push_back({row.scene, {}});
      error.series.push_back({row.scene, {}});
    }
    const double mean_ms = median_of(row.timed).mean_ms;
    const std::string label = fmt::format("{} within {:.2f} ms: {:.2f} ms, RMSE {:.5f}", row.scene,
                                          row.budget_ms, mean_ms, row.rmse);
    time.series.back().points.push_back({row.budget_ms, mean_ms, label, false});
    error.series.back().points.push_back({row.budget_ms, row.rmse, label, false});
  }
  report.plots = {time, error};
  report.plots_title = "Over the budget";
  report.plots_text = "Point at a budget to see the time and error of its frames.";
}

// Adds the means over the still scenes of each half, by budget.
void add_means(SuiteRun& run, const std::vector<BudgetRow>& rows) {
  for (const char* half : {"tuning", "judging"})
    for (const double x : fractions) {
      std::vector<const BudgetRow*> some;
      for (const BudgetRow& row : rows)
        if (row.half == half && row.x == x) some.push_back(&row);
      const RatioSummary summary = summarise_ratios(some);
      if (summary.scenes > 0)
        run.add_info(fmt::format("{}, x = {}", half, x),
                     fmt::format("RMSE relative to the best single configuration: {:.3f} "
                                 "(geometric mean over {} scenes), worst {:.3f} ({})",
                                 summary.mean, summary.scenes, summary.worst, summary.worst_scene));
    }
}

// Creates what still scenes need. `host` outlives `stills`.
demo::Result<> prepare_stills(SuiteRun& run, const std::vector<BudgetScene>& scenes,
                              std::unique_ptr<demo::VulkanHost>& host,
                              std::unique_ptr<StillRuns>& stills) {
  if (std::ranges::all_of(scenes, [](const BudgetScene& scene) { return scene.still == nullptr; }))
    return demo::success();
  const std::string path = shipped("configs/profiles/skin.json");
  Diagnostics diagnostics;
  const auto document = read_document(path, diagnostics);
  const auto skin = document ? subsurface::read_profile(*document, diagnostics) : std::nullopt;
  if (!skin) return run.reject(path, diagnostics);
  auto opened = run.open_device();
  if (!opened) return opened.error();
  host = opened.take();
  stills = std::make_unique<StillRuns>(run.session, *host, *skin);
  return demo::success();
}

demo::Result<> measure_budget(SuiteRun& run, const Emit<BudgetRow>& emit) {
  Diagnostics diagnostics;
  const std::string graph = run.file("graph");
  const std::optional<LoadedGraph> loaded = load_graph(graph, run.pass_types(), diagnostics);
  if (!loaded) return run.reject(graph, diagnostics);
  auto sets = choice_sets(*loaded, run.size(), diagnostics);
  if (sets.empty()) return run.reject(graph, diagnostics);
  HostPasses host_passes(loaded->host_pass_types); // outlives the cache of the runs
  SceneRunRequest request;
  request.graph = graph;
  request.hooks = host_passes.hooks();
  request.size = run.size();
  request.cache = run.text("cache");
  request.model = head_model(run.text("head"));
  auto calibration = read_named(run.text("calibration"));
  if (!calibration) return calibration.error();
  request.calibration = calibration.take();
  std::vector<BudgetScene> scenes;
  if (const std::string problem = find_scenes(run, scenes); !problem.empty())
    return demo::Error{demo::ErrorKind::usage, problem};
  std::unique_ptr<demo::VulkanHost> host; // outlives `stills`
  std::unique_ptr<StillRuns> stills;
  if (auto ready = prepare_stills(run, scenes, host, stills); !ready) return ready;
  const uint64_t frames = run.number("frames"), repetitions = run.number("repetitions");
  run.report.summary = fmt::format(
      "{} judged frames after {}; over: a frame that takes more than {} times the budget by "
      "timestamps, or {} times by calibrated times; times: median of {}; the best single "
      "configuration takes at most {:.3f} "
      "of the budget, as much as the controller fills",
      frames, unjudged_frames, measured_tolerance, model_tolerance, repetitions, controller_room());
  uint64_t runs = 0;
  for (const BudgetScene& scene : scenes)
    runs +=
        sets.size() + (scene.still != nullptr ? 1 : 1 + repetitions) * (1 + std::size(fractions));
  Progress progress = run.progress("run", runs);
  BudgetBench bench{run,     std::move(request), std::move(sets), std::move(scenes), stills.get(),
                    progress};
  if (auto measured = measure_budgets(bench); !measured) return measured;
  for (const BudgetRow& row : bench.rows)
    emit(row);
  add_means(run, bench.rows);
  add_plots(run.report, bench.rows);
  return demo::success();
}

template <double TimedFigures::*Figure> std::optional<double> timed(const BudgetRow& row) {
  return row.timed.empty() ? std::nullopt : std::optional(median_of(row.timed).*Figure);
}

} // namespace

Suite budget_suite() {
  using Row = BudgetRow;
  using List = std::vector<std::string>;
  return make_suite<Row>(
      {.name = "budget",
       .what = "Measure how well frames keep a budget, and at what error",
       .title = "Frames within a budget",
       .options = {size_option({480, 270}),
                   {"graph", "Graph with choices by budget", "configs/graphs/skin.json", "FILE"},
                   pass_types_option(),
                   {"calibration", "Calibration file for this device (dermis calibrate)", "",
                    "FILE"},
                   {"scenes",
                    "Scenes of configs/scenes, separated by commas. Also names, classes and halves "
                    "(tuning, judging) of the generated family, whose still scenes are judged at "
                    "calibrated times only",
                    List{"flashing", "regular", "dynamic", "dolly", "cut"}, "NAME",
                    List{"flashing", "dolly"}}, // changing light, and changing size
                   {"frames", "Judged frames per run", 32u, "", 4u, 4},
                   {"repetitions", "Timed runs per budget; results are medians", 3u, "", 1u, 1,
                    100},
                   head_option(),
                   cache_option()}},
      {{"scene", "scene", &Row::scene, {.groups = true}},
       {"x", "x", &Row::x},
       {"budget_ms", "budget, ms", &Row::budget_ms},
       {"mean_ms", "mean, ms", timed<&TimedFigures::mean_ms>},
       {"p95_ms", "95 %, ms", timed<&TimedFigures::p95_ms>},
       {"over_budget_fraction", "over, timed", timed<&TimedFigures::over>, {2}},
       {"over_budget_fraction_calibrated", "over, calibrated", &Row::over_model, {2}},
       {"mean_rmse", "RMSE", &Row::rmse},
       {"best_single_rmse_within_budget", "best single RMSE", &Row::single_rmse},
       {"rmse_ratio", "ratio", [](const Row& row) { return row.ratio(); }, {3}},
       {"best_single", "best single", &Row::single},
       {"chosen", "chosen", &Row::chosen},
       {"unscattered_rmse", "RMSE unscattered", &Row::unscattered_rmse},
       {"switches", "switches",
        [](const Row& row) { return int64_t(median_of(row.timed).switches); }}},
      measure_budget);
}

} // namespace dermis::tools
