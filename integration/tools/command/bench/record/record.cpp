// dermis bench record: measures the host thread's cost of recording a frame, on a device whose
// functions only count.

#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/limits.hpp"
#include "integration/tools/command/bench/record/allocation_count.hpp"
#include "integration/tools/command/bench/record/counted_host.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/thread_time.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/run/host_passes.hpp"
#include "integration/tools/command/verbs.hpp"
#include "integration/tools/files/bytes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace dermis::tools {
namespace {

constexpr uint32_t warm_frames = 16;       // until pipelines, descriptors and caches settle
constexpr uint32_t frames_per_sample = 64; // frames per clock reading
constexpr uint32_t samples = 201;
constexpr uint32_t chain_passes = 100;
constexpr double goal_per_pass = 0.5; // microseconds

struct Row {
  std::string graph;
  uint32_t passes = 0;
  double commands = 0.0, barriers = 0.0, allocations = 0.0; // per frame
  // microseconds per frame; low, high: 10 %, 90 %
  double median = 0.0, lowest = 0.0, low = 0.0, high = 0.0;
  double per_pass() const { return median / passes; }
};

// Returns a graph with classification and light as in the shipped graphs, followed by a chain of
// blurs.
std::string chain_graph() {
  constexpr uint32_t others = 4; // classify, list, setup, combine
  constexpr uint32_t blurs = chain_passes - others;
  std::string resources, passes;
  for (uint32_t i = 0; i < blurs; ++i) {
    resources += fmt::format(R"(, "blur{}": {{ "format": "rgba16f", "size": "view" }})", i);
    const std::string before = i == 0 ? "light" : fmt::format("blur{}", i - 1);
    passes += fmt::format(
        R"({{ "pass": "blur{0}", "type": "subsurface.separable", "set": {{ "axis": "vertical", "taps": "11" }},
        "read": {{ "light": "light", "blurred": "{1}", "material": "material", "depth": "depth",
                  "tiles": "tiles", "arguments": "arguments" }}, "write": {{ "scattered": "blur{0}" }} }},)",
        i, before);
  }
  return fmt::format(
      R"({{ "dermis": 2, "name": "chain",
  "imports": {{ "lighting": {{ "format": "rgba16f", "size": "view" }}, "depth": {{ "format": "depth", "size": "view" }},
               "material": {{ "format": "r8_uint", "size": "view" }} }},
  "resources": {{ "classes": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
                 "tiles": {{ "buffer": {{ "stride": 4, "count": "view/8", "extra": 1 }} }},
                 "arguments": {{ "buffer": {{ "stride": 4, "count": [4, 1] }} }},
                 "light": {{ "format": "rgba16f", "size": "view" }}{0} }},
  "passes": [
    {{ "pass": "classify", "type": "subsurface.classify", "read": {{ "material": "material", "depth": "depth" }},
      "write": {{ "classes": "classes" }} }},
    {{ "pass": "list", "type": "subsurface.tile_list", "read": {{ "classes": "classes" }},
      "write": {{ "tiles": "tiles", "arguments": "arguments" }} }},
    {{ "pass": "setup", "type": "subsurface.setup", "read": {{ "lighting": "lighting", "material": "material",
      "depth": "depth", "tiles": "tiles", "arguments": "arguments" }}, "write": {{ "light": "light" }} }},
    {1}
    {{ "pass": "combine", "type": "subsurface.combine", "read": {{ "scattered": "blur{2}", "material": "material",
      "tiles": "tiles", "arguments": "arguments" }}, "write": {{ "lighting": "lighting" }} }} ],
  "exports": ["lighting"] }})",
      resources, passes, blurs - 1);
}

struct Measured {
  Row row;
  std::string problem;
};

Measured measure(const CountedInput& input, const std::string& name) {
  Measured result;
  CountedHost host;
  result.problem = host.open(input);
  if (!result.problem.empty()) return result;
  bool good = true;
  for (uint32_t i = 0; i < warm_frames; ++i)
    good = good && host.record_frame() == DERMIS_OK;
  if (good && input.hooks.recorded)
    if (auto run = input.hooks.recorded(); !run) result.problem = run.error().text;
  if (!result.problem.empty()) return result;
  std::vector<double> times;
  times.reserve(samples);
  const uint64_t commands = host.device().commands(), barriers = host.device().barriers();
  const uint64_t allocations = allocations_of_this_thread();
  for (uint32_t s = 0; s < samples && good; ++s) {
    const uint64_t begin = thread_nanoseconds();
    for (uint32_t i = 0; i < frames_per_sample; ++i)
      good = host.record_frame() == DERMIS_OK && good;
    times.push_back(static_cast<double>(thread_nanoseconds() - begin) / (1000.0 * frames_per_sample));
  }
  const uint64_t allocated = allocations_of_this_thread() - allocations;
  if (!good) {
    result.problem = fmt::format("{}: {}", name, dermis_last_error());
    return result;
  }
  constexpr double frames = double{samples} * frames_per_sample;
  std::sort(times.begin(), times.end());
  Row& row = result.row;
  row.graph = name;
  row.passes = host.passes();
  row.commands = static_cast<double>(host.device().commands() - commands) / frames;
  row.barriers = static_cast<double>(host.device().barriers() - barriers) / frames;
  row.allocations = static_cast<double>(allocated) / frames;
  row.median = times[times.size() / 2];
  row.lowest = times.front();
  row.low = times[times.size() / 10];
  row.high = times[times.size() * 9 / 10];
  return result;
}

void write_row(JsonWriter& out, const Row& row) {
  out.open_object(true).member("graph", row.graph).member("passes", row.passes);
  out.member("commands_per_frame", row.commands).member("barriers_per_frame", row.barriers);
  out.member("allocations_per_frame", row.allocations);
  out.key("us_per_frame").open_object(true).member("median", row.median).member("lowest", row.lowest);
  out.member("p10", row.low).member("p90", row.high).member("samples", samples).close();
  out.member("us_per_pass", row.per_pass()).member("goal_us_per_pass", goal_per_pass);
  out.member("goal_met", row.per_pass() <= goal_per_pass && row.allocations == 0.0).close();
}

std::string write_rows(const std::string& file, const std::vector<Row>& rows) {
  JsonWriter out;
  out.open_object().member("dermis_bench", "record").member("clock", "CPU time of the thread");
  out.member("frames_per_sample", frames_per_sample).key("rows").open_array();
  for (const Row& row : rows)
    write_row(out, row);
  out.close().close();
  return deliver_text(file, std::move(out).finish());
}

Report page_of(const Session& session, const std::vector<Row>& rows) {
  Report report;
  report.bench = "record";
  report.title = "Cost of recording on the host's thread";
  report.summary = "CPU time of the recording thread, on a device whose functions only count.";
  report.info = machine_info(session.command, "");
  report.info.emplace_back("repetitions", fmt::format("{} samples of {} frames", samples, frames_per_sample));
  report.table.columns = {{"graph", "graph"},
                          {"passes", "passes"},
                          {"commands", "commands a frame"},
                          {"barriers", "barriers a frame"},
                          {"allocations", "allocations a frame"},
                          {"median_us", "µs a frame, median", 4},
                          {"low_us", "10 %", 4},
                          {"high_us", "90 %", 4},
                          {"us_per_pass", "µs a pass"},
                          {"goal_us_per_pass", "goal"},
                          {"goal_met", "goal met"}};
  for (const Row& row : rows)
    report.table.rows.push_back({row.graph, int64_t{row.passes}, row.commands, row.barriers, row.allocations,
                                 row.median, row.low, row.high, row.per_pass(), goal_per_pass,
                                 row.per_pass() <= goal_per_pass && row.allocations == 0.0});
  report.plots = {{"time of a frame", "passes", "µs", {{"graphs", {}}}}};
  for (const Row& row : rows)
    report.plots[0].series[0].points.push_back(
        {double(row.passes), row.median, fmt::format("{}: {:.2f} µs", row.graph, row.median), false});
  report.plots_title = "Over passes";
  report.plots_text = "Point at a graph to see its name.";
  return report;
}

constexpr std::string_view table_head =
    "graph                 passes  commands  barriers  allocations    us/frame "
    "    10 %     90 %  us/pass    goal\n";

std::string table_line(const Row& row) {
  return fmt::format("{:<22}{:>6}{:>10.0f}{:>10.0f}{:>13g}{:>12.2f}{:>9.2f}{:>9.2f}{:>9.3f}{:>8.3f}\n",
                     row.graph, row.passes, row.commands, row.barriers, row.allocations, row.median, row.low,
                     row.high, row.per_pass(), goal_per_pass);
}

struct Source {
  std::string name, text;
};

// Returns the problem, or "".
std::string read_sources(const BenchRecordOptions& options, std::vector<Source>& graphs,
                         std::string& profile) {
  std::string error;
  const auto read = [&](const std::filesystem::path& path, std::string& text) {
    const auto bytes = read_bytes(path, limits::file_bytes, error);
    if (bytes) text.assign(bytes->begin(), bytes->end());
    return bytes.has_value();
  };
  if (!read(options.profile, profile)) return error;
  for (const std::string& path : graph_files(options.graphs)) {
    graphs.push_back({path, ""});
    if (!read(path, graphs.back().text)) return error;
  }
  if (graphs.empty())
    return fmt::format("'{}' has no graph files; name a folder with --graphs", options.graphs);
  graphs.push_back({fmt::format("chain of {}", chain_passes), chain_graph()});
  return "";
}

} // namespace

ExitCode bench_record(const Session& session, const BenchRecordOptions& options) {
  std::vector<Source> graphs;
  std::string profile;
  if (const std::string problem = read_sources(options, graphs, profile); !problem.empty())
    return fail(session, ExitCode::problems, problem);
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> known = load_pass_types(options.pass_types, diagnostics);
  if (!known) return fail(session, ExitCode::problems, "the pass types cannot be used", &diagnostics);
  const bool table = !session.quiet && options.json != "-" && options.html != "-";
  if (table) print(table_head);
  std::vector<Row> rows;
  for (const Source& graph : graphs) {
    HostPasses host_passes(known->host_pass_types);
    const CountedInput input{graph.name,         graph.text,          options.profile,    profile,
                             options.size.width, options.size.height, host_passes.hooks()};
    const Measured measured = measure(input, std::filesystem::path(graph.name).stem().string());
    if (!measured.problem.empty()) return fail(session, ExitCode::problems, measured.problem);
    if (table) print(table_line(measured.row));
    rows.push_back(measured.row);
  }
  std::string problem = options.json.empty() ? "" : write_rows(options.json, rows);
  if (problem.empty()) problem = deliver_report(page_of(session, rows), "", "", options.html);
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

} // namespace dermis::tools
