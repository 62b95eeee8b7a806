// dermis bench budget: measures how well frames keep to a budget and at what error, compared with
// the best single technique.

#include "framegraph/model/graph.hpp"
#include "integration/examples/demo_engine/files.hpp"
#include "integration/examples/demo_engine/scene/read_scene.hpp"
#include "integration/tools/command/bench/choice/budget_judge.hpp"
#include "integration/tools/command/bench/choice/budget_report.hpp"
#include "integration/tools/command/bench/quick.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/run/choice_sets.hpp"
#include "integration/tools/command/run/host_passes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

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

struct BudgetBench {
  const Session& session;
  const BenchBudgetOptions& options;
  SceneRunRequest request;
  std::vector<std::vector<NamedValue>> sets; // one per configuration
  Progress& progress;
  SharedScene shared = {};
  uint64_t done = 0;
  std::string device = {};
  std::vector<BudgetRow> rows = {};
};

demo::Result<SceneRun> run_counted(BudgetBench& bench) {
  auto run = run_scene(bench.session, bench.request, bench.shared);
  bench.progress.update(++bench.done);
  return run;
}

std::string file_of(const std::string& scene) {
  return shipped(fmt::format("configs/scenes/{}.json", scene));
}

// Resets the request for runs of a scene, without state of the previous scene.
void begin_scene(BudgetBench& bench, const std::string& scene) {
  const Stretch stretch = stretch_of(scene);
  const uint32_t judged = stretch.times * bench.options.frames;
  bench.request.scene = file_of(scene);
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
    bench.device = run->device;
    singles.push_back(single_of(*run, set));
  }
  bench.request.set.clear();
  return singles;
}

std::string name_of(const Single& single) {
  std::string name;
  for (const auto& [setting, value] : single.set)
    name += fmt::format("{}{}={}", name.empty() ? "" : " ", setting, value.substr(1, value.size() - 2));
  return name;
}

// Measures errors and modelled times of one row per fraction.
demo::Result<> measure_by_meter(BudgetBench& bench, const std::string& scene) {
  begin_scene(bench, scene);
  const auto singles = measure_singles(bench);
  if (!singles) return singles.error();
  for (const double x : fractions) {
    BudgetRow& row = bench.rows.emplace_back(BudgetRow{scene, x, budget_at(*singles, x)});
    bench.request.budget_ms = row.budget_ms;
    const auto run = run_counted(bench);
    if (!run) return run.error();
    row.over_model = fraction_over_model(*run, row.budget_ms);
    row.rmse = pooled_rmse(*run);
    if (const Single* single = best_within(*singles, row.budget_ms)) {
      row.single_rmse = single->rmse;
      row.single = name_of(*single);
    }
  }
  return demo::success();
}

// Adds one timed run to each row of a scene.
demo::Result<> measure_by_time(BudgetBench& bench, const std::string& scene) {
  begin_scene(bench, scene);
  bench.request.deterministic = false;
  bench.request.error_every = 0;
  for (BudgetRow& row : bench.rows) {
    if (row.scene != scene) continue;
    bench.request.budget_ms = row.budget_ms;
    const auto run = run_counted(bench);
    if (!run) return run.error();
    row.timed.push_back(judge_times(*run, row.budget_ms));
  }
  return demo::success();
}

// A temporary slowdown of the machine should affect one run per budget and not its median, so all
// other scenes are timed between two runs of one budget.
demo::Result<> measure(BudgetBench& bench) {
  for (const std::string& scene : bench.options.scenes)
    if (auto measured = measure_by_meter(bench, scene); !measured) return measured;
  for (uint32_t i = 0; i < bench.options.repetitions; ++i)
    for (const std::string& scene : bench.options.scenes)
      if (auto measured = measure_by_time(bench, scene); !measured) return measured;
  return demo::success();
}

// Returns the reason why the scenes cannot be measured, or "". Runs before minutes are spent on
// other scenes.
std::string why_not(const BenchBudgetOptions& options) {
  for (const std::string& name : options.scenes) {
    const std::string file = file_of(name);
    if (!std::filesystem::exists(file))
      return fmt::format("there is no scene '{}': '{}' is missing (--scenes takes names in configs/scenes)",
                         name, file);
    Diagnostics diagnostics;
    const auto scene = demo::read_scene(file, diagnostics);
    if (!scene) return format_for_people(diagnostics, diagnostics.list.front());
    const bool model =
        std::any_of(scene->objects.begin(), scene->objects.end(),
                    [](const demo::Object& object) { return object.shape == demo::Shape::model; });
    const std::string problem = model ? why_no_head(options.head) : "";
    if (!problem.empty()) return fmt::format("scene {}: {}", name, problem);
  }
  return "";
}

} // namespace

ExitCode bench_budget(const Session& session, const BenchBudgetOptions& requested) {
  const BenchBudgetOptions options = quickened(requested);
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> loaded =
      load_graph(options.graph, {.overlays = {}, .roots = {}, .pass_types = options.pass_types}, diagnostics);
  if (!loaded) return fail_graph(session, options.graph, diagnostics);
  auto sets = choice_sets(*loaded, options.size, diagnostics);
  if (sets.empty()) return fail_graph(session, options.graph, diagnostics);
  HostPasses host_passes(loaded->host_pass_types); // outlives the stage of the runs
  SceneRunRequest request;
  request.graph = options.graph;
  request.hooks = host_passes.hooks();
  request.size = options.size;
  request.cache = options.cache;
  request.model = head_model(options.head);
  if (!options.calibration.empty()) {
    auto text = demo::read_text_file(options.calibration);
    if (!text) return fail(session, static_cast<ExitCode>(text.error().kind), text.error().text);
    request.calibration = {options.calibration, text.take()};
  }
  if (const std::string problem = why_not(options); !problem.empty())
    return fail(session, ExitCode::usage, problem);
  Progress progress(progress_style(session.quiet, false), "budget", "run",
                    options.scenes.size() * (sets.size() + (1 + options.repetitions) * std::size(fractions)));
  BudgetBench bench{session, options, std::move(request), std::move(sets), progress};
  Report report;
  report.bench = "budget";
  report.title = "Frames within a budget";
  report.summary =
      fmt::format("{} judged frames after {}; over: more than {} of the budget by timestamps, {} by the "
                  "meter; times: median of {}",
                  options.frames, unjudged_frames, measured_tolerance, model_tolerance, options.repetitions);
  report.table.columns = budget_columns();
  const auto measured = measure(bench);
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!measured) return fail(session, static_cast<ExitCode>(measured.error().kind), measured.error().text);
  for (const BudgetRow& row : bench.rows)
    add_budget_row(report, row);
  report.info = machine_info(session.command, bench.device);
  if (options.quick) report.info.push_back(quick_fact());
  add_budget_plots(report);
  if (!session.quiet && options.json != "-" && options.html != "-") print(text_of_budget(report));
  const std::string problem = deliver_report(report, options.json, "", options.html);
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

} // namespace dermis::tools
