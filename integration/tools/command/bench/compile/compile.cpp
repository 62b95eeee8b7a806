// dermis bench compile: measures time and memory of compiling randomly generated graphs or given
// graphs.

#include "framegraph/compile/compile.hpp"
#include "integration/tools/command/bench/compile/shapes.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/bench/thread_time.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace dermis::tools {
namespace {

constexpr uint32_t pass_counts[] = {10, 100, 1000, 10000};
constexpr uint32_t min_samples = 5, max_samples = 200;
constexpr uint32_t memory_passes = 100;

struct Effort {
  uint32_t rotating = 64;              // graphs that alternate, so that none stays in the caches
  uint64_t time_per_row = 300'000'000; // ns
  uint32_t memory_seeds = 50, fan_seeds = 20;
};
constexpr Effort quick_effort{2, 3'000'000, 2, 2};

constexpr double mebibyte = 1024.0 * 1024.0, ns_per_ms = 1e6;

constexpr std::string_view level_names[] = {"fast", "tight", "optimize"};
constexpr std::string_view order_names[] = {"memory", "program", "random"};

// Returns the goal on generated random graphs and fans, ns per pass. 0 means no goal.
double time_goal(std::string_view shape, uint32_t passes, PackingLevel level, bool reasons) {
  if (shape == "chain" || shape == "given" || level == PackingLevel::optimize) return 0.0;
  if (level == PackingLevel::tight) return 20'000.0;
  const double plain = passes == 100     ? 500.0
                       : passes == 1000  ? 600.0
                       : passes == 10000 ? 900.0
                                         : 0.0;
  return reasons ? 2.0 * plain : plain;
}

struct GraphSet { // graphs that alternate
  std::string shape;
  uint32_t passes = 0;
  uint32_t view_width = 0, view_height = 0;
  const PassTypeRegistry* pass_types = nullptr;
  std::vector<Graph> graphs;
};

struct CompileOptions {
  PackingLevel level = PackingLevel::fast;
  PassOrder order = PassOrder::memory;
  bool reasons = false;
};

struct CompileRow {
  std::string shape;
  uint32_t passes = 0;
  size_t rotating = 0;
  CompileOptions options;
  std::optional<size_t> samples; // not set: not timed, as the times
  std::optional<Spread> ns;      // per pass
  std::optional<double> goal;    // of the median
  double heap_bytes = 0.0, max_live_bytes = 0.0, ratio = 0.0, worst_ratio = 0.0,
         batches_per_pass = 0.0;
  uint32_t optimal = 0;                   // graphs whose heap equals the lower bound
  double mean_ms = 0.0, slowest_ms = 0.0; // CPU time per graph, each compiled once
};

CompileInput input_of(const GraphSet& set, const Graph& graph, const DeviceProfile& device,
                      const CompileOptions& options) {
  CompileInput input;
  input.graph = &graph;
  input.pass_types = set.pass_types;
  input.device = &device;
  input.view_width = set.view_width;
  input.view_height = set.view_height;
  input.reasons = options.reasons;
  input.order = options.order;
  input.packing = options.level;
  return input;
}

double batches_per_pass(const Plan& plan) {
  const auto batches = std::count_if(plan.passes.begin(), plan.passes.end(),
                                     [](const PlanPass& pass) { return pass.barrier_count != 0; });
  return static_cast<double>(batches) /
         static_cast<double>(std::max<size_t>(plan.passes.size(), 1));
}

// Measures memory and order of each graph once, which also warms up the compiler. Returns false if
// a graph is rejected.
bool measure_memory(Compiler& compiler, const GraphSet& set, const DeviceProfile& device,
                    CompiledPlan& plan, CompileRow& row, Diagnostics& diagnostics) {
  for (const Graph& graph : set.graphs) {
    const uint64_t began = thread_nanoseconds();
    if (!compiler.compile(input_of(set, graph, device, row.options), diagnostics, plan))
      return false;
    const double ms = static_cast<double>(thread_nanoseconds() - began) / ns_per_ms;
    row.mean_ms += ms;
    row.slowest_ms = std::max(row.slowest_ms, ms);
    uint64_t size = 0, bound = 0;
    for (const Heap& heap : plan.plan.heaps) {
      size += heap.size;
      bound += heap.max_live_bytes;
    }
    const double ratio = bound == 0 ? 1.0 : static_cast<double>(size) / static_cast<double>(bound);
    row.heap_bytes += static_cast<double>(size);
    row.max_live_bytes += static_cast<double>(bound);
    row.ratio += ratio;
    row.worst_ratio = std::max(row.worst_ratio, ratio);
    row.batches_per_pass += batches_per_pass(plan.plan);
    row.optimal += size == bound;
  }
  const auto count = static_cast<double>(set.graphs.size());
  for (double* mean :
       {&row.heap_bytes, &row.max_live_bytes, &row.ratio, &row.batches_per_pass, &row.mean_ms})
    *mean /= count;
  return true;
}

void measure_time(Compiler& compiler, const GraphSet& set, const DeviceProfile& device,
                  CompiledPlan& plan, uint64_t time_per_row, CompileRow& row,
                  Diagnostics& diagnostics) {
  std::vector<CompileInput> inputs;
  uint64_t passes = 0;
  for (const Graph& graph : set.graphs) {
    inputs.push_back(input_of(set, graph, device, row.options));
    passes += graph.passes.size();
  }
  std::vector<double> samples;
  for (uint64_t spent = 0;
       samples.size() < min_samples || (spent < time_per_row && samples.size() < max_samples);) {
    const uint64_t begin = thread_nanoseconds();
    for (const CompileInput& input : inputs)
      compiler.compile(input, diagnostics, plan);
    const uint64_t took = thread_nanoseconds() - begin;
    spent += took;
    samples.push_back(static_cast<double>(took) / static_cast<double>(passes));
  }
  row.samples = samples.size();
  row.ns = spread_of(samples);
  const double goal = time_goal(row.shape, row.passes, row.options.level, row.options.reasons);
  if (goal > 0) row.goal = goal;
}

// time_per_row is the duration of the timing in ns; 0 skips the timing.
std::optional<CompileRow> measure_set(const GraphSet& set, const CompileOptions& options,
                                      uint64_t time_per_row, Diagnostics& diagnostics) {
  const DeviceProfile device = generic_profile();
  CompileRow row{set.shape, set.passes, set.graphs.size(), options, {}, {}, {}};
  Compiler compiler;
  CompiledPlan plan;
  if (!measure_memory(compiler, set, device, plan, row, diagnostics)) return std::nullopt;
  if (time_per_row > 0) measure_time(compiler, set, device, plan, time_per_row, row, diagnostics);
  return row;
}

// The rows of one set of graphs.
struct CompileTask {
  std::function<GraphSet()> make;
  std::vector<CompileOptions> options;
  bool timed = true;
};

CompileTask task_of(const ShapeFile& file, const PassTypeRegistry& pass_types, const Shape& shape,
                    uint32_t passes, uint32_t count, std::vector<CompileOptions> options,
                    bool timed) {
  const auto make = [&file, &pass_types, &shape, passes, count] {
    GraphSet set{shape.name, passes, file.view_width, file.view_height, &pass_types, {}};
    for (uint32_t seed = 0; seed < count; ++seed)
      set.graphs.push_back(draw_graph(file, shape, passes, seed));
    return set;
  };
  return {make, std::move(options), timed};
}

constexpr CompileOptions fast_options{}, tight_options{PackingLevel::tight},
    fast_in_program_order{PackingLevel::fast, PassOrder::program},
    fast_with_reasons{PackingLevel::fast, PassOrder::memory, true};

void add_times(std::vector<CompileTask>& tasks, const Effort& effort, const ShapeFile& file,
               const PassTypeRegistry& pass_types) {
  for (const Shape& shape : file.shapes)
    for (const uint32_t passes : pass_counts) {
      std::vector<CompileOptions> options = {fast_options, fast_with_reasons};
      if (passes == memory_passes) options.push_back(tight_options);
      tasks.push_back(task_of(file, pass_types, shape, passes, effort.rotating, options, true));
    }
}

void add_memory(std::vector<CompileTask>& tasks, const Effort& effort, const ShapeFile& file,
                const PassTypeRegistry& pass_types, bool optimize) {
  for (const Shape& shape : file.shapes) {
    if (shape.kind == Shape::Kind::random && shape.dead_percent == 0) {
      std::vector<CompileOptions> options = {fast_options, tight_options};
      if (optimize) options.push_back({PackingLevel::optimize});
      tasks.push_back(
          task_of(file, pass_types, shape, memory_passes, effort.memory_seeds, options, false));
    }
    if (shape.kind != Shape::Kind::fan) continue;
    for (const uint32_t passes : pass_counts)
      tasks.push_back(task_of(file, pass_types, shape, passes, effort.fan_seeds,
                              {fast_options, fast_in_program_order, tight_options}, false));
  }
}

// Returns false if a graph cannot be used. `loaded` owns the graphs' pass types.
bool add_given(std::vector<CompileTask>& tasks, const SuiteRun& run,
               std::vector<LoadedGraph>& loaded, Diagnostics& diagnostics) {
  const std::vector<std::string> files = graph_files(run.text("graphs"));
  for (const std::string& file : files) {
    std::optional<LoadedGraph> graph = load_graph(file, run.pass_types(), diagnostics);
    if (!graph) return false;
    loaded.push_back(std::move(*graph));
  }
  for (size_t i = 0; i < loaded.size(); ++i) {
    const auto passes = static_cast<uint32_t>(loaded[i].graph.passes.size());
    const auto make = [&loaded, i, passes, name = std::filesystem::path(files[i]).stem().string()] {
      return GraphSet{name,
                      passes,
                      default_size.width,
                      default_size.height,
                      &loaded[i].pass_types,
                      {loaded[i].graph}};
    };
    tasks.push_back({make, {fast_options, fast_with_reasons}});
  }
  return true;
}

void add_point(Plot& plot, const CompileRow& row) {
  if (!row.ns || row.options.reasons || row.options.level != PackingLevel::fast) return;
  if (plot.series.empty() || plot.series.back().name != row.shape)
    plot.series.push_back({row.shape, {}});
  plot.series.back().points.push_back(
      {double(row.passes), row.ns->median,
       fmt::format("{} of {} passes: {:.0f} ns a pass", row.shape, row.passes, row.ns->median),
       false});
}

demo::Result<> measure_compile(SuiteRun& run, const Emit<CompileRow>& emit) {
  const Effort effort = run.quick ? quick_effort : Effort();
  const std::string source = run.text("graphs").empty() ? run.file("shapes") : run.text("graphs");
  Diagnostics diagnostics;
  std::vector<CompileTask> tasks;
  std::vector<LoadedGraph> loaded;
  std::optional<ShapeFile> file;
  const PassTypeRegistry pass_types = benchmark_pass_types();
  if (run.text("graphs").empty()) {
    file = read_shapes(source, diagnostics);
    if (!file) return run.reject(source, diagnostics);
    add_times(tasks, effort, *file, pass_types);
    add_memory(tasks, effort, *file, pass_types, run.flag("optimize"));
  } else if (!add_given(tasks, run, loaded, diagnostics)) {
    return run.reject(source, diagnostics);
  } else if (tasks.empty()) {
    return demo::Error{demo::ErrorKind::input,
                       fmt::format("'{}' has no graph files; name a folder with --graphs", source)};
  }
  run.report.constants = {{"clock", "CPU time of the thread"}};
  run.report.plots_title = "Time over size";
  run.report.plots_text = "Point at a row to see its name.";
  Plot plot{"packing level fast, without reasons", "passes", "ns a pass", {}};
  Progress progress = run.progress("set", tasks.size());
  uint64_t done = 0;
  for (const CompileTask& task : tasks) {
    const GraphSet set = task.make();
    for (const CompileOptions& options : task.options) {
      if (interrupted()) return stopped();
      const auto row = measure_set(set, options, task.timed ? effort.time_per_row : 0, diagnostics);
      if (!row) return run.reject(source, diagnostics);
      add_point(plot, *row);
      emit(*row);
    }
    progress.update(++done);
  }
  if (!plot.series.empty()) run.report.plots = {plot};
  return demo::success();
}

template <double Spread::*Figure> std::optional<double> time_of(const CompileRow& row) {
  return row.ns ? std::optional((*row.ns).*Figure) : std::nullopt;
}

} // namespace

Suite compile_suite() {
  using Row = CompileRow;
  return make_suite<Row>(
      {.name = "compile",
       .what = "Measure time and memory of compiling random graphs or given graphs",
       .title = "Cost of compiling a graph",
       .summary = "CPU time of the compiling thread, and memory efficiency of the heaps.",
       .options = {{"shapes", "Description of the random graphs", "tests/benchmark/shapes.json",
                    "FILE"},
                   {"graphs", "Measure the graph files of a folder instead", "", "DIR"},
                   pass_types_option(),
                   {"optimize", "Also measure the packing level that takes seconds per graph",
                    false}}},
      {{"shape", "shape", &Row::shape, {.groups = true}},
       {"passes", "passes", &Row::passes},
       {"rotating", "graphs", &Row::rotating},
       {"level", "level", [](const Row& row) { return level_names[size_t(row.options.level)]; }},
       {"order", "order", [](const Row& row) { return order_names[size_t(row.options.order)]; }},
       {"reasons_on", "with reasons", [](const Row& row) { return row.options.reasons; }},
       {"ns_per_pass.median", "ns a pass, median", time_of<&Spread::median>},
       {"ns_per_pass.lowest", "", time_of<&Spread::lowest>},
       {"ns_per_pass.p10", "10 %", time_of<&Spread::p10>},
       {"ns_per_pass.p90", "90 %", time_of<&Spread::p90>},
       {"ns_per_pass.samples", "", &Row::samples},
       {"goal_ns_per_pass", "goal", &Row::goal},
       {"goal_met",
        "goal met",
        [](const Row& row) {
          return row.goal ? std::optional(row.ns->median <= *row.goal) : std::nullopt;
        },
        {.goal = Goal::advisory}},
       {"heap_bytes", "", &Row::heap_bytes},
       {"max_live_bytes", "", &Row::max_live_bytes},
       {"heap_mib", "heap, MiB", [](const Row& row) { return row.heap_bytes / mebibyte; }, {4}},
       {"ratio", "heap / live at once", &Row::ratio, {5}},
       {"worst_ratio", "worst", &Row::worst_ratio, {5}},
       {"optimal", "optimal", &Row::optimal},
       {"mean_ms_per_graph", "", &Row::mean_ms},
       {"slowest_ms_per_graph", "slowest, ms", &Row::slowest_ms},
       {"batches_per_pass", "batches a pass", &Row::batches_per_pass}},
      measure_compile);
}

} // namespace dermis::tools
