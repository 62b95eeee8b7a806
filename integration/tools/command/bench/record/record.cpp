// dermis bench record: measures the host thread's cost of recording a frame, on a device whose
// functions only count.

#include "framegraph/text/limits.hpp"
#include "integration/tools/command/bench/record/allocation_count.hpp"
#include "integration/tools/command/bench/record/counted_host.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/bench/thread_time.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/run/host_passes.hpp"
#include "integration/tools/command/statistics.hpp"
#include "integration/tools/files/bytes.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace dermis::tools {
namespace {

constexpr uint32_t warm_frames = 16;       // until pipelines, descriptors and caches settle
constexpr uint32_t frames_per_sample = 64; // frames per clock reading
constexpr uint32_t all_samples = 201, few_samples = 5;
constexpr uint32_t chain_passes = 100;
constexpr double goal_per_pass = 0.5; // microseconds
constexpr float any_budget_ms = 4;    // the device reports no times, so decisions do not matter

struct RecordRow {
  std::string graph;
  uint32_t passes = 0, samples = 0;
  // per frame
  double commands = 0.0, barriers = 0.0, descriptor_writes = 0.0, allocations = 0.0;
  Spread us; // microseconds per frame

  double us_per_pass() const { return us.median / passes; }
  double goal() const { return goal_per_pass; }
  bool goal_met() const { return us_per_pass() <= goal_per_pass; }
  bool allocates_nothing() const { return allocations == 0.0; }
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
        "read": {{ "light": "light", "blurred": "{1}", "view_depth": "view_depth", "tiles": "tiles",
                  "arguments": "arguments" }}, "write": {{ "scattered": "blur{0}" }} }},)",
        i, before);
  }
  return fmt::format(
      R"({{ "dermis": 2, "name": "chain",
  "imports": {{ "lighting": {{ "format": "rgba16f", "size": "view" }}, "depth": {{ "format": "depth", "size": "view" }},
               "material": {{ "format": "r8_uint", "size": "view" }} }},
  "resources": {{ "classes": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
                 "list_state": {{ "buffer": {{ "stride": 4, "count": "view/64", "extra": 8 }} }},
                 "tiles": {{ "buffer": {{ "stride": 4, "count": "view/8", "extra": 1 }} }},
                 "arguments": {{ "buffer": {{ "stride": 4, "count": [4, 1] }} }},
                 "light": {{ "format": "rgba16f", "size": "view" }},
                 "view_depth": {{ "format": "r32f", "size": "view" }}{0} }},
  "passes": [
    {{ "pass": "classify", "type": "subsurface.classify", "read": {{ "material": "material", "depth": "depth" }},
      "write": {{ "classes": "classes", "list_state": "list_state" }} }},
    {{ "pass": "list", "type": "subsurface.tile_list", "read": {{ "classes": "classes" }},
      "write": {{ "list_state": "list_state", "tiles": "tiles", "arguments": "arguments" }} }},
    {{ "pass": "setup", "type": "subsurface.separable_setup", "read": {{ "lighting": "lighting", "material": "material",
      "depth": "depth", "classes": "classes" }}, "write": {{ "light": "light", "view_depth": "view_depth" }} }},
    {1}
    {{ "pass": "combine", "type": "subsurface.combine", "read": {{ "scattered": "blur{2}", "material": "material",
      "tiles": "tiles", "arguments": "arguments" }}, "write": {{ "lighting": "lighting" }} }} ],
  "exports": ["lighting"] }})",
      resources, passes, blurs - 1);
}

demo::Error input_problem(std::string text) {
  return {demo::ErrorKind::input, std::move(text)};
}

// `chooses`: set to whether a budget chooses settings of the graph.
demo::Result<RecordRow> measure_graph(const CountedInput& input, uint32_t samples, bool& chooses) {
  CountedHost host;
  if (std::string problem = host.open(input); !problem.empty()) return input_problem(problem);
  chooses = host.chooses();
  bool good = true;
  for (uint32_t i = 0; i < warm_frames; ++i)
    good = good && host.record_frame() == DERMIS_OK;
  if (good && input.hooks.recorded)
    if (auto run = input.hooks.recorded(); !run) return input_problem(run.error().text);
  std::vector<double> times;
  times.reserve(samples);
  const uint64_t commands = host.device().commands(), barriers = host.device().barriers(),
                 descriptor_writes = host.device().descriptor_writes();
  const uint64_t allocations = allocations_of_this_thread();
  for (uint32_t s = 0; s < samples && good; ++s) {
    const uint64_t begin = thread_nanoseconds();
    for (uint32_t i = 0; i < frames_per_sample; ++i)
      good = host.record_frame() == DERMIS_OK && good;
    times.push_back(static_cast<double>(thread_nanoseconds() - begin) /
                    (1000.0 * frames_per_sample));
  }
  const uint64_t allocated = allocations_of_this_thread() - allocations;
  const std::string name =
      std::filesystem::path(input.name).stem().string() + (input.budget_ms > 0 ? ", budget" : "");
  if (!good) return input_problem(fmt::format("{}: {}", name, dermis_last_error()));
  const double frames = double{frames_per_sample} * samples;
  return RecordRow{name,
                   host.passes(),
                   samples,
                   static_cast<double>(host.device().commands() - commands) / frames,
                   static_cast<double>(host.device().barriers() - barriers) / frames,
                   static_cast<double>(host.device().descriptor_writes() - descriptor_writes) /
                       frames,
                   static_cast<double>(allocated) / frames,
                   spread_of(times)};
}

struct Source {
  std::string name, text;
};

// Returns the problem, or "".
std::string read_sources(const SuiteRun& run, std::vector<Source>& graphs, std::string& profile) {
  std::string error;
  const auto read = [&](const std::filesystem::path& path, std::string& text) {
    const auto bytes = read_bytes(path, limits::file_bytes, error);
    if (bytes) text.assign(bytes->begin(), bytes->end());
    return bytes.has_value();
  };
  if (!read(run.file("profile"), profile)) return error;
  for (const std::string& path : graph_files(run.file("graphs"))) {
    graphs.push_back({path, ""});
    if (!read(path, graphs.back().text)) return error;
  }
  if (graphs.empty())
    return fmt::format("'{}' has no graph files; name a folder with --graphs", run.file("graphs"));
  graphs.push_back({fmt::format("chain of {}", chain_passes), chain_graph()});
  return "";
}

demo::Result<> measure_record(SuiteRun& run, const Emit<RecordRow>& emit) {
  std::vector<Source> graphs;
  std::string profile;
  if (const std::string problem = read_sources(run, graphs, profile); !problem.empty())
    return input_problem(problem);
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> known =
      load_pass_types(run.pass_types().pass_types, diagnostics);
  if (!known) {
    run.rejected = std::move(diagnostics);
    return input_problem("the pass types cannot be used");
  }
  const uint32_t samples = run.quick ? few_samples : all_samples;
  run.report.constants = {{"clock", "CPU time of the thread"},
                          {"frames_per_sample", frames_per_sample}};
  run.add_info("repetitions", fmt::format("{} samples of {} frames", samples, frames_per_sample));
  run.report.plots = {{"time of a frame", "passes", "µs", {{"graphs", {}}}}};
  run.report.plots_title = "Over passes";
  run.report.plots_text = "Point at a graph to see its name.";
  for (const Source& graph : graphs) {
    if (interrupted()) return stopped();
    bool again = false; // within a budget
    do {
      HostPasses host_passes(known->host_pass_types);
      CountedInput input{graph.name, graph.text,         run.file("profile"),
                         profile,    run.size().width,   run.size().height,
                         0,          host_passes.hooks()};
      if (again) input.budget_ms = any_budget_ms;
      bool chooses = false;
      const auto row = measure_graph(input, samples, chooses);
      if (!row) return row.error();
      run.report.plots[0].series[0].points.push_back(
          {double(row->passes), row->us.median,
           fmt::format("{}: {:.2f} µs", row->graph, row->us.median), false});
      emit(*row);
      again = chooses && !again;
    } while (again);
  }
  return demo::success();
}

} // namespace

Suite record_suite() {
  using Row = RecordRow;
  return make_suite<Row>(
      {.name = "record",
       .what = "Measure time and allocations of recording graphs, on a device that only counts",
       .title = "Cost of recording on the host's thread",
       .summary = "CPU time of the recording thread, on a device whose functions only count.",
       .options = {{"graphs", "Folder of graph files", "configs/graphs", "DIR"},
                   pass_types_option(),
                   {"profile", "Profile of id 1", "configs/profiles/skin.json", "FILE"},
                   {"size", "", Size{1280, 720}}}},
      {{"graph", "graph", &Row::graph},
       {"passes", "passes", &Row::passes},
       {"commands_per_frame", "commands a frame", &Row::commands},
       {"barriers_per_frame", "barriers a frame", &Row::barriers},
       {"descriptor_writes_per_frame", "descriptor writes a frame", &Row::descriptor_writes},
       {"allocations_per_frame", "allocations a frame", &Row::allocations},
       {"allocates_nothing", "", &Row::allocates_nothing, {.goal = Goal::required}},
       {"us_per_frame.median",
        "µs a frame, median",
        [](const Row& row) { return row.us.median; },
        {4}},
       {"us_per_frame.lowest", "", [](const Row& row) { return row.us.lowest; }},
       {"us_per_frame.p10", "10 %", [](const Row& row) { return row.us.p10; }, {4}},
       {"us_per_frame.p90", "90 %", [](const Row& row) { return row.us.p90; }, {4}},
       {"us_per_frame.samples", "", &Row::samples},
       {"us_per_pass", "µs a pass", &Row::us_per_pass},
       {"goal_us_per_pass", "goal", &Row::goal},
       {"goal_met", "goal met", &Row::goal_met, {.goal = Goal::advisory}}},
      measure_record);
}

} // namespace dermis::tools
