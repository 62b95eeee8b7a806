// dermis bench budget: how well frames keep to a budget, and what error that costs, beside the best single
// technique.

#include "framegraph/model/graph.hpp"
#include "integration/command/bench/choice/scene_run.hpp"
#include "integration/command/bench/quick.hpp"
#include "integration/command/bench/report/report.hpp"
#include "integration/command/inspect/graph_input.hpp"
#include "integration/command/interrupt.hpp"
#include "integration/command/run/choice_sets.hpp"
#include "integration/demo_engine/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace dermis::tools {
namespace {

constexpr uint32_t warm_up = 10;                                    // frames that are not judged
constexpr double measured_tolerance = 1.15, meter_tolerance = 1.05; // of the budget: over it beyond that
constexpr double shares[] = {0.25, 0.5, 1, 2}; // x: of the way from the cheapest to the best outcome
constexpr double within = 0.99;                // share of frames whose meter a single technique must keep

constexpr uint32_t compared = 8; // judged frames of a run whose error is measured

// The camera of `dolly` takes five seconds for its way: more frames, each further from the one before, see
// all of it.
struct Stretch {
  uint32_t times = 1;           // as many judged frames as of another scene
  double frames_per_second = 0; // 0: the scene's
};

Stretch stretch_of(std::string_view scene) {
  return scene == "dolly" ? Stretch{2, 24} : Stretch{};
}

// One outcome alone over the whole scene.
struct Single {
  std::vector<NamedValue> set; // as JSON
  std::vector<double> metered_ms;
  double rmse = 0;

  double metered_at(double share) const { // nearest rank
    std::vector<double> sorted = metered_ms;
    std::sort(sorted.begin(), sorted.end());
    const auto rank = static_cast<size_t>(std::ceil(share * double(sorted.size())));
    return sorted[std::clamp<size_t>(rank, 1, sorted.size()) - 1];
  }
};

struct Figures {
  double mean_ms = 0, p95_ms = 0, over = 0, over_meter = 0, rmse = 0;
  uint32_t switches = 0;
};

// Root of the mean square over the judged frames that were compared.
double pooled_rmse(const SceneRun& run) {
  double sum = 0;
  uint32_t count = 0;
  for (size_t i = warm_up; i < run.frames.size(); ++i)
    if (const auto& rmse = run.frames[i].rmse) {
      sum += *rmse * *rmse;
      ++count;
    }
  return count > 0 ? std::sqrt(sum / count) : 0;
}

Figures judge(const SceneRun& timed, const SceneRun& metered, double budget_ms) {
  Figures out;
  std::vector<double> times;
  for (size_t i = warm_up; i < timed.frames.size(); ++i)
    times.push_back(timed.frames[i].choice.measured_ms);
  std::sort(times.begin(), times.end());
  for (const double ms : times) {
    out.mean_ms += ms / double(times.size());
    out.over += ms > measured_tolerance * budget_ms ? 1.0 / double(times.size()) : 0;
  }
  constexpr double tail = 0.95;
  out.p95_ms = times[static_cast<size_t>(tail * double(times.size() - 1) + 0.5)];
  const double judged = double(metered.frames.size() - warm_up);
  for (size_t i = warm_up; i < metered.frames.size(); ++i)
    out.over_meter += metered.frames[i].choice.metered_ms > meter_tolerance * budget_ms ? 1 / judged : 0;
  out.rmse = pooled_rmse(metered);
  out.switches = timed.frames.back().choice.switches;
  return out;
}

const std::vector<ReportColumn> columns = {
    {"scene", "scene"},
    {"x", "x"},
    {"budget_ms", "budget, ms"},
    {"mean_ms", "mean, ms"},
    {"p95_ms", "95 %, ms"},
    {"over_budget_fraction", "over, timed", 2},
    {"over_budget_fraction_meter", "over, meter", 2},
    {"mean_rmse", "RMSE"},
    {"best_single_rmse_within_budget", "best single RMSE"},
    {"best_single", "best single"},
    {"switches", "switches"},
};

struct Bench {
  const Session& session;
  const BenchBudgetOptions& options;
  SceneRunRequest request;
  std::vector<std::vector<NamedValue>> sets; // one for each outcome
  Progress& progress;
  SharedScene shared = {};
  uint64_t done = 0;
  std::string device = {};
  Report report = {};
};

demo::Result<SceneRun> run_counted(Bench& bench) {
  auto run = run_scene(bench.session, bench.request, bench.shared);
  bench.progress.update(++bench.done);
  return run;
}

demo::Result<std::vector<Single>> measure_singles(Bench& bench) {
  std::vector<Single> singles;
  bench.request.budget_ms = 0;
  bench.request.metered = true;
  for (const auto& set : bench.sets) {
    bench.request.set = set;
    const auto run = run_counted(bench);
    if (!run) return run.error();
    bench.device = run->device;
    Single& single = singles.emplace_back();
    single.set = set;
    single.rmse = pooled_rmse(*run);
    for (size_t i = warm_up; i < run->frames.size(); ++i)
      single.metered_ms.push_back(run->frames[i].choice.metered_ms);
  }
  bench.request.set.clear();
  return singles;
}

// The least error among those whose meter keeps to the budget; null: none does.
const Single* best_within(const std::vector<Single>& singles, double budget_ms) {
  const Single* best = nullptr;
  for (const Single& one : singles)
    if (one.metered_at(within) <= meter_tolerance * budget_ms && (best == nullptr || one.rmse < best->rmse))
      best = &one;
  return best;
}

std::string name_of(const Single* single) {
  std::string name;
  if (single != nullptr)
    for (const auto& [setting, value] : single->set)
      name += fmt::format("{}{}={}", name.empty() ? "" : " ", setting, value.substr(1, value.size() - 2));
  return name;
}

// A row for each share of the way from the cheapest outcome to the best.
demo::Result<> measure_scene(Bench& bench, const std::string& scene) {
  const auto singles = measure_singles(bench);
  if (!singles) return singles.error();
  double floor_ms = singles->front().metered_at(within);
  for (const Single& single : *singles)
    floor_ms = std::min(floor_ms, single.metered_at(within));
  const auto best = std::min_element(singles->begin(), singles->end(),
                                     [](const Single& a, const Single& b) { return a.rmse < b.rmse; });
  for (const double x : shares) {
    const double budget_ms = floor_ms + x * (best->metered_at(within) - floor_ms);
    bench.request.budget_ms = budget_ms;
    bench.request.metered = false;
    const auto timed = run_counted(bench);
    if (!timed) return timed.error();
    bench.request.metered = true;
    const auto metered = run_counted(bench);
    if (!metered) return metered.error();
    const Figures figures = judge(*timed, *metered, budget_ms);
    const Single* single = best_within(*singles, budget_ms);
    bench.report.table.rows.push_back({scene, x, budget_ms, figures.mean_ms, figures.p95_ms, figures.over,
                                       figures.over_meter, figures.rmse,
                                       single != nullptr ? ReportValue(single->rmse) : ReportValue(),
                                       name_of(single), int64_t{figures.switches}});
  }
  return demo::success();
}

// What a scene's frames take and how far they are from the truth, over the budget.
void add_plots(Report& report) {
  Plot time{"mean device time of a frame", "budget, ms", "ms", {}};
  Plot error{"error", "budget, ms", "RMSE of linear luminance", {}};
  for (size_t row = 0; row < report.table.rows.size(); ++row) {
    const auto number = [&](std::string_view key) { return std::get<double>(report.table.at(row, key)); };
    const std::string& scene = std::get<std::string>(report.table.at(row, "scene"));
    if (time.series.empty() || time.series.back().name != scene) {
      time.series.push_back({scene, {}});
      error.series.push_back({scene, {}});
    }
    const std::string label = fmt::format("{} within {:.2f} ms: {:.2f} ms, RMSE {:.5f}", scene,
                                          number("budget_ms"), number("mean_ms"), number("mean_rmse"));
    time.series.back().points.push_back({number("budget_ms"), number("mean_ms"), label, false});
    error.series.back().points.push_back({number("budget_ms"), number("mean_rmse"), label, false});
  }
  report.plots = {time, error};
  report.plots_title = "Over the budget";
  report.plots_text = "Point at a budget to see what its frames took and how far they were from the truth.";
}

std::string cell(const ReportValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{:.3g}", *number);
  if (const auto* count = std::get_if<int64_t>(&value)) return fmt::format("{}", *count);
  return "-";
}

std::string text_of(const Report& report) {
  Table table;
  for (const ReportColumn& column : report.table.columns)
    table.columns.push_back({column.title, column.key != "scene" && column.key != "best_single"});
  for (const auto& row : report.table.rows) {
    auto& cells = table.rows.emplace_back();
    for (const ReportValue& value : row)
      cells.push_back(cell(value));
  }
  return format_table(table);
}

} // namespace

ExitCode bench_budget(const Session& session, const BenchBudgetOptions& asked) {
  const BenchBudgetOptions options = quickened(asked);
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> loaded = load_graph(options.graph, {}, diagnostics);
  if (!loaded) return fail_graph(session, options.graph, diagnostics);
  auto sets = choice_sets(*loaded, options.size, diagnostics);
  if (sets.empty()) return fail_graph(session, options.graph, diagnostics);
  SceneRunRequest request;
  request.graph = options.graph;
  request.size = options.size;
  request.cache = options.cache;
  if (!options.calibration.empty()) {
    auto text = demo::read_text_file(options.calibration);
    if (!text) return fail(session, static_cast<ExitCode>(text.error().kind), text.error().text);
    request.calibration = {options.calibration, text.take()};
  }
  Progress progress(progress_style(session.quiet, false), "budget", "run",
                    options.scenes.size() * (sets.size() + 2 * std::size(shares)));
  Bench bench{session, options, std::move(request), std::move(sets), progress};
  Report& report = bench.report;
  report.bench = "budget";
  report.title = "Frames within a budget";
  report.summary = fmt::format(
      "{} judged frames after {}; over: more than {} of the budget by timestamps, {} by the meter",
      options.frames, warm_up, measured_tolerance, meter_tolerance);
  report.table.columns = columns;
  for (const std::string& scene : options.scenes) {
    bench.request.scene = shipped(fmt::format("configs/scenes/{}.json", scene));
    const Stretch stretch = stretch_of(scene);
    const uint32_t judged = stretch.times * options.frames;
    bench.request.frames = warm_up + judged;
    bench.request.frames_per_second = stretch.frames_per_second;
    bench.request.error_every = std::max(1u, judged / compared);
    bench.shared = {};
    if (!std::filesystem::exists(bench.request.scene)) {
      report.notes.push_back(fmt::format("scene {}: there is no '{}'", scene, bench.request.scene));
      continue;
    }
    const auto measured = measure_scene(bench, scene);
    if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
    if (!measured) return fail(session, static_cast<ExitCode>(measured.error().kind), measured.error().text);
  }
  if (report.table.rows.empty()) return fail(session, ExitCode::usage, "no scene is left to measure");
  report.facts = machine_facts(session.command, bench.device);
  if (options.quick) report.facts.push_back(quick_fact());
  add_plots(report);
  if (!session.quiet && options.json != "-" && options.html != "-") print(text_of(report));
  const std::string problem = deliver_report(report, options.json, "", options.html);
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

} // namespace dermis::tools
