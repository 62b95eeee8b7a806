// dermis bench compile: measures time and memory of compiling randomly generated graphs or given
// graphs.

#include "framegraph/compile/compile.hpp"
#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/bench/compile/shapes.hpp"
#include "integration/tools/command/bench/quick.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/thread_time.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

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
  const double plain = passes == 100 ? 500.0 : passes == 1000 ? 600.0 : passes == 10000 ? 900.0 : 0.0;
  return reasons ? 2.0 * plain : plain;
}

struct Subject { // graphs that alternate
  std::string shape;
  uint32_t passes = 0;
  uint32_t view_width = 0, view_height = 0;
  const PassTypeRegistry* pass_types = nullptr;
  std::vector<Graph> graphs;
};

struct Options {
  PackingLevel level = PackingLevel::fast;
  PassOrder order = PassOrder::memory;
  bool reasons = false;
};

struct Row {
  std::string shape;
  uint32_t passes = 0, rotating = 0, samples = 0;
  Options options;
  // ns per pass; low and high: 10 % and 90 %
  double median = 0.0, lowest = 0.0, low = 0.0, high = 0.0;
  double goal = 0.0;
  double heap_bytes = 0.0, max_live_bytes = 0.0, ratio = 0.0, worst_ratio = 0.0, batches_per_pass = 0.0;
  uint32_t optimal = 0;                   // graphs whose heap equals the lower bound
  double mean_ms = 0.0, slowest_ms = 0.0; // CPU time per graph, each compiled once
};

CompileInput input_of(const Subject& subject, const Graph& graph, const DeviceProfile& device,
                      const Options& options) {
  CompileInput input;
  input.graph = &graph;
  input.pass_types = subject.pass_types;
  input.device = &device;
  input.view_width = subject.view_width;
  input.view_height = subject.view_height;
  input.reasons = options.reasons;
  input.order = options.order;
  input.packing = options.level;
  return input;
}

double batches_per_pass(const Plan& plan) {
  const auto batches = std::count_if(plan.passes.begin(), plan.passes.end(),
                                     [](const PlanPass& pass) { return pass.barrier_count != 0; });
  return static_cast<double>(batches) / static_cast<double>(std::max<size_t>(plan.passes.size(), 1));
}

// Measures memory and order of each graph once, which also warms up the compiler. Returns false if
// a graph is rejected.
bool measure_memory(Compiler& compiler, const Subject& subject, const DeviceProfile& device,
                    CompiledPlan& plan, Row& row, Diagnostics& diagnostics) {
  for (const Graph& graph : subject.graphs) {
    const uint64_t began = thread_nanoseconds();
    if (!compiler.compile(input_of(subject, graph, device, row.options), diagnostics, plan)) return false;
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
  const auto count = static_cast<double>(subject.graphs.size());
  for (double* mean : {&row.heap_bytes, &row.max_live_bytes, &row.ratio, &row.batches_per_pass, &row.mean_ms})
    *mean /= count;
  return true;
}

void measure_time(Compiler& compiler, const Subject& subject, const DeviceProfile& device, CompiledPlan& plan,
                  uint64_t time_per_row, Row& row, Diagnostics& diagnostics) {
  std::vector<CompileInput> inputs;
  uint64_t passes = 0;
  for (const Graph& graph : subject.graphs) {
    inputs.push_back(input_of(subject, graph, device, row.options));
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
  std::sort(samples.begin(), samples.end());
  row.samples = static_cast<uint32_t>(samples.size());
  row.lowest = samples.front();
  row.median = samples[samples.size() / 2];
  row.low = samples[samples.size() / 10];
  row.high = samples[samples.size() * 9 / 10];
}

// time_per_row is the duration of the timing in ns; 0 skips the timing.
std::optional<Row> measure(const Subject& subject, const Options& options, uint64_t time_per_row,
                           Diagnostics& diagnostics) {
  const DeviceProfile device = generic_profile();
  Row row;
  row.shape = subject.shape;
  row.passes = subject.passes;
  row.rotating = static_cast<uint32_t>(subject.graphs.size());
  row.options = options;
  row.goal = time_goal(row.shape, row.passes, options.level, options.reasons);
  Compiler compiler;
  CompiledPlan plan;
  if (!measure_memory(compiler, subject, device, plan, row, diagnostics)) return std::nullopt;
  if (time_per_row > 0) measure_time(compiler, subject, device, plan, time_per_row, row, diagnostics);
  return row;
}

Subject draw(const ShapeFile& file, const PassTypeRegistry& pass_types, const Shape& shape, uint32_t passes,
             uint32_t count) {
  Subject subject{shape.name, passes, file.view_width, file.view_height, &pass_types, {}};
  for (uint32_t seed = 0; seed < count; ++seed)
    subject.graphs.push_back(draw_graph(file, shape, passes, seed));
  return subject;
}

std::string table_line(const Row& row) {
  const auto time = [&](double ns, bool given) { return given ? fmt::format("{:.0f}", ns) : "-"; };
  const bool timed = row.samples > 0;
  return fmt::format(
      "{:<22}{:>6}{:>5}  {:<9}{:<9}{:<4}{:>9}{:>9}{:>9}{:>7}{:>10.1f}{:>8.4f}{:>8.4f}{:>6}{:>9.1f}{:>7.2f}\n",
      row.shape, row.passes, row.rotating, level_names[static_cast<size_t>(row.options.level)],
      order_names[static_cast<size_t>(row.options.order)], row.options.reasons ? "yes" : "no",
      time(row.median, timed), time(row.low, timed), time(row.high, timed),
      time(row.goal, timed && row.goal > 0.0), row.heap_bytes / mebibyte, row.ratio, row.worst_ratio,
      row.optimal, row.slowest_ms, row.batches_per_pass);
}

constexpr std::string_view table_head =
    "shape                 passes  rot  level    order    why  ns/pass    10 %    "
    " 90 %   goal  heap MiB   ratio   worst  best  slow ms  batch\n";

void write_row(JsonWriter& out, const Row& row) {
  out.open_object(true)
      .member("shape", row.shape)
      .member("passes", row.passes)
      .member("rotating", row.rotating);
  out.member("level", level_names[static_cast<size_t>(row.options.level)]);
  out.member("order", order_names[static_cast<size_t>(row.options.order)]);
  out.member("reasons_on", row.options.reasons);
  if (row.samples > 0) {
    out.key("ns_per_pass").open_object(true).member("median", row.median).member("lowest", row.lowest);
    out.member("p10", row.low).member("p90", row.high).member("samples", row.samples).close();
    if (row.goal > 0.0) out.member("goal_ns_per_pass", row.goal).member("goal_met", row.median <= row.goal);
  }
  out.member("heap_bytes", row.heap_bytes).member("max_live_bytes", row.max_live_bytes);
  out.member("ratio", row.ratio).member("worst_ratio", row.worst_ratio).member("optimal", row.optimal);
  out.member("mean_ms_per_graph", row.mean_ms).member("slowest_ms_per_graph", row.slowest_ms);
  out.member("batches_per_pass", row.batches_per_pass).close();
}

Report page_of(const Session& session, const std::vector<Row>& rows) {
  Report report;
  report.bench = "compile";
  report.title = "Cost of compiling a graph";
  report.summary = "CPU time of the compiling thread, and memory efficiency of the heaps.";
  report.info = machine_info(session.command, "");
  report.table.columns = {{"shape", "shape"},
                          {"passes", "passes"},
                          {"rotating", "graphs"},
                          {"level", "level"},
                          {"order", "order"},
                          {"reasons_on", "with reasons"},
                          {"ns_per_pass", "ns a pass, median"},
                          {"low", "10 %"},
                          {"high", "90 %"},
                          {"goal", "goal"},
                          {"heap_mib", "heap, MiB", 4},
                          {"ratio", "heap / live at once", 5},
                          {"worst_ratio", "worst", 5},
                          {"slowest_ms", "slowest, ms"},
                          {"batches_per_pass", "batches a pass"}};
  Plot plot{"packing level fast, without reasons", "passes", "ns a pass", {}};
  for (const Row& row : rows) {
    const bool timed = row.samples > 0;
    const auto time = [&](double value) { return timed && value > 0 ? ReportValue(value) : ReportValue(); };
    const std::string level(level_names[static_cast<size_t>(row.options.level)]);
    report.table.rows.push_back({row.shape, int64_t{row.passes}, int64_t{row.rotating}, level,
                                 std::string(order_names[static_cast<size_t>(row.options.order)]),
                                 std::string(row.options.reasons ? "yes" : "no"), time(row.median),
                                 time(row.low), time(row.high), time(row.goal), row.heap_bytes / mebibyte,
                                 row.ratio, row.worst_ratio, row.slowest_ms, row.batches_per_pass});
    if (!timed || row.options.reasons || row.options.level != PackingLevel::fast) continue;
    if (plot.series.empty() || plot.series.back().name != row.shape) plot.series.push_back({row.shape, {}});
    plot.series.back().points.push_back(
        {double(row.passes), row.median,
         fmt::format("{} of {} passes: {:.0f} ns a pass", row.shape, row.passes, row.median), false});
  }
  if (!plot.series.empty()) report.plots = {plot};
  report.plots_title = "Time over size";
  report.plots_text = "Point at a row to see its name.";
  return report;
}

struct Bench {
  const Session& session;
  Effort effort = {};
  Diagnostics diagnostics = {};
  std::vector<Row> rows = {};

  bool add(const Subject& subject, const Options& options, bool timed) {
    if (interrupted()) return false;
    const std::optional<Row> row = measure(subject, options, timed ? effort.time_per_row : 0, diagnostics);
    if (!row) return false;
    if (!session.quiet) print(table_line(*row));
    rows.push_back(*row);
    return true;
  }

  bool add_times(const ShapeFile& file, const PassTypeRegistry& pass_types) {
    for (const Shape& shape : file.shapes)
      for (const uint32_t passes : pass_counts) {
        const Subject subject = draw(file, pass_types, shape, passes, effort.rotating);
        if (!add(subject, {}, true) || !add(subject, {PackingLevel::fast, PassOrder::memory, true}, true))
          return false;
        if (passes == memory_passes && !add(subject, {PackingLevel::tight, PassOrder::memory, false}, true))
          return false;
      }
    return true;
  }

  bool add_memory(const ShapeFile& file, const PassTypeRegistry& pass_types, bool optimize) {
    for (const Shape& shape : file.shapes) {
      if (shape.kind == Shape::Kind::random && shape.dead_percent == 0) {
        const Subject subject = draw(file, pass_types, shape, memory_passes, effort.memory_seeds);
        for (const PackingLevel level : {PackingLevel::fast, PackingLevel::tight, PackingLevel::optimize})
          if ((level != PackingLevel::optimize || optimize) &&
              !add(subject, {level, PassOrder::memory, false}, false))
            return false;
      }
      if (shape.kind != Shape::Kind::fan) continue;
      for (const uint32_t passes : pass_counts) {
        const Subject subject = draw(file, pass_types, shape, passes, effort.fan_seeds);
        for (const PassOrder order : {PassOrder::memory, PassOrder::program})
          if (!add(subject, {PackingLevel::fast, order, false}, false)) return false;
        if (!add(subject, {PackingLevel::tight, PassOrder::memory, false}, false)) return false;
      }
    }
    return true;
  }

  bool add_given(const std::string& folder, const std::vector<std::string>& pass_types) {
    std::vector<std::string> files;
    std::error_code error;
    for (std::filesystem::recursive_directory_iterator at(folder, error), end; !error && at != end;
         at.increment(error))
      if (at->path().extension() == ".json" && !at->path().string().ends_with(".expect.json"))
        files.push_back(at->path().string());
    std::sort(files.begin(), files.end(), [](const std::string& a, const std::string& b) {
      return std::filesystem::path(a).filename() < std::filesystem::path(b).filename();
    });
    std::vector<LoadedGraph> loaded;
    for (const std::string& file : files) {
      std::optional<LoadedGraph> graph =
          load_graph(file, {.overlays = {}, .roots = {}, .pass_types = pass_types}, diagnostics);
      if (!graph) return false;
      loaded.push_back(std::move(*graph));
    }
    for (size_t i = 0; i < loaded.size(); ++i) {
      const auto passes = static_cast<uint32_t>(loaded[i].graph.passes.size());
      const Subject subject{std::filesystem::path(files[i]).stem().string(),
                            passes,
                            default_size.width,
                            default_size.height,
                            &loaded[i].pass_types,
                            {loaded[i].graph}};
      for (const bool reasons : {false, true})
        if (!add(subject, {PackingLevel::fast, PassOrder::memory, reasons}, true)) return false;
    }
    return true;
  }
};

} // namespace

ExitCode bench_compile(const Session& session, const BenchCompileOptions& options) {
  Bench bench{session, options.quick ? quick_effort : Effort()};
  if (!session.quiet) print(table_head);
  bool good = true;
  if (options.graphs.empty()) {
    const std::optional<ShapeFile> file = read_shapes(options.shapes, bench.diagnostics);
    if (!file) return fail_graph(session, options.shapes, bench.diagnostics);
    const PassTypeRegistry pass_types = benchmark_pass_types();
    good = bench.add_times(*file, pass_types) && bench.add_memory(*file, pass_types, options.optimize);
  } else {
    good = bench.add_given(options.graphs, options.pass_types);
  }
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!good) return fail_graph(session, options.graphs, bench.diagnostics);
  Report page = page_of(session, bench.rows);
  if (options.quick) page.info.push_back(quick_fact());
  const std::string refused = deliver_report(page, "", "", options.html);
  if (!refused.empty()) return fail(session, ExitCode::environment, refused);
  if (options.json.empty()) return ExitCode::ok;
  JsonWriter out;
  out.open_object().member("dermis_bench", "compile").member("clock", "CPU time of the thread");
  out.key("rows").open_array();
  for (const Row& row : bench.rows)
    write_row(out, row);
  out.close().close();
  const std::string problem = deliver_text(options.json, std::move(out).finish());
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

} // namespace dermis::tools
