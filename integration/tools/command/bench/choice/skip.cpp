// dermis bench skip: measures frames that do not need all of a graph, compared with a frame that
// does.

#include "framegraph/text/document.hpp"
#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "integration/tools/command/bench/choice/skip_cases.hpp"
#include "integration/tools/command/bench/quick.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/run/apply_slots.hpp"
#include "integration/tools/command/run/captured.hpp"
#include "integration/tools/command/run/device_graph.hpp"
#include "integration/tools/command/run/host_passes.hpp"
#include "integration/tools/references/image_reads.hpp"
#include "passes/common/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr double d_px = 4; // as in the framing "close"
constexpr uint32_t warm_up = 3;
constexpr double pixels_per_tile = 64;

// Removes the detection of uniform light from a graph.
constexpr const char* without_uniform_light = R"({ "dermis_overlay": 2, "edits": [
  { "remove": "/passes/classify_uniform_light" }, { "remove": "/passes/classify/write/light_range" },
  { "remove": "/passes/classify/write/light_cells" } ] })";

struct Case {
  SkipCase from;
  std::unique_ptr<DeviceGraph> device;
  CompiledPlan plan;
  dermis_frame frame = DERMIS_FRAME_INIT;
  SlotChoice slots;
  std::vector<double> device_ms;
  std::vector<float> picture;
  demo::ReportedFrame choice;
};

struct SkipBench {
  demo::VulkanHost& host;
  const BenchSkipOptions& options;
  LoadedGraph loaded, plain; // `plain` is without the detection of uniform light
  std::string text;
  std::vector<CaptureProfile> profiles;
  demo::ContextHooks hooks;
  std::vector<Case> cases = {};

  const LoadedGraph& graph_of(const SkipCase& one) const { return one.skips ? loaded : plain; }
};

demo::Result<> prepare(SkipBench& bench, SkipCase from) {
  Case one;
  one.from = std::move(from);
  const LoadedGraph& loaded = bench.graph_of(one.from);
  one.slots = choose_slots(loaded.graph, one.from.frame);
  if (!one.slots.problem.empty()) return demo::Error{demo::ErrorKind::input, one.slots.problem};
  one.slots.unbound.emplace_back("scattered_light"); // only used by tools
  DeviceGraphRequest request;
  request.graph_name = bench.options.graph;
  request.graph_text = bench.text;
  request.width = bench.options.size.width;
  request.height = bench.options.size.height;
  if (!one.from.skips) request.overlays.emplace_back("without flat light", without_uniform_light);
  if (!one.from.no_profiles)
    for (const CaptureProfile& profile : bench.profiles)
      request.profiles.push_back({profile.id, profile.profile.name, profile_as_json(profile.profile)});
  for (const auto& [slot, format] : one.slots.formats)
    if (slot != "scattered_light")
      request.formats.emplace_back(slot, static_cast<VkFormat>(format_info(format).vulkan));
  request.unbound = one.slots.unbound;
  request.hooks = bench.hooks;
  auto device = DeviceGraph::create(bench.host, request);
  if (!device) return device.error();
  one.device = device.take();
  one.frame = c_frame(one.from.frame.description);
  if (one.from.empty_bounds) one.frame.flags |= DERMIS_FRAME_BOUNDS;
  Diagnostics diagnostics;
  if (!one.from.no_profiles) {
    const CompileChoices choices = read_choices(loaded.graph, {}, one.slots.unbound);
    auto plan = compile_generic(loaded, bench.options.size, choices, diagnostics);
    if (!plan) return demo::Error{demo::ErrorKind::input, "the graph cannot be compiled"};
    one.plan = std::move(*plan);
  }
  bench.cases.push_back(std::move(one));
  return demo::success();
}

// Uploads light for each run, since the graph scatters in place.
demo::Result<> run_once(Case& one, bool timed) {
  for (const SlotData& data : one.slots.data)
    if (auto given = one.device->upload(data.slot, data.texels, data.channels); !given) return given.error();
  if (auto ran = one.device->run(one.frame); !ran) return ran.error();
  if (const auto choice = one.device->choice()) one.choice = *choice;
  double sum = 0;
  for (const DeviceGraph::PassTime& time : one.device->times())
    sum += time.milliseconds;
  if (timed) one.device_ms.push_back(sum);
  return demo::success();
}

demo::Result<> measure(SkipBench& bench, Progress& progress) {
  for (uint32_t i = 0; i < warm_up + bench.options.repetitions; ++i) {
    // interleaved, so that a slowdown of the machine affects all cases
    for (Case& one : bench.cases)
      if (auto ran = run_once(one, i >= warm_up); !ran) return ran.error();
    if (interrupted()) return demo::Error{demo::ErrorKind::environment, "stopped"};
    progress.update(i + 1);
  }
  for (Case& one : bench.cases) {
    auto picture = one.device->read_rgb("lighting");
    if (!picture) return picture.error();
    one.picture = picture.take();
  }
  return demo::success();
}

// Counts texels read by the groups that ran, assuming subsurface everywhere around them.
double reads_of(const SkipBench& bench, const Case& one, std::span<const float> sap_tables) {
  if (one.from.no_profiles || one.from.empty_bounds) return 0;
  const LoadedGraph& loaded = bench.graph_of(one.from);
  const double listed =
      double(one.choice.scattering_tiles) + one.choice.copied_tiles + one.choice.uniform_tiles;
  double sum = 0;
  for (const PlanPass& pass : one.plan.plan.passes) {
    const PassType& type = loaded.pass_types[pass.type];
    // runs if nothing scatters; otherwise the pyramid runs
    const bool copies = type.name == "subsurface.copy_tiles";
    const bool pyramid = find_port(type, "level_tiles", PortSide::read) >= 0;
    if ((copies || pyramid) && copies != (one.choice.scattering_tiles == 0)) continue;
    std::vector<SettingValue> settings;
    double finer = 1; // level 0 texels per texel of the pass
    for (size_t i = 0; i < type.settings.size(); ++i) {
      settings.push_back(one.plan.plan.settings[pass.first_setting + i].value);
      if (type.settings[i].name == "level") {
        finer = std::exp2(2.0 * double(settings.back().integer));
      }
    }
    subsurface::ReadsQuestion question{
        settings, std::vector<bool>(type.ports.size(), false), {d_px, d_px, d_px}, sap_tables};
    for (uint32_t i = 0; i < pass.access_count; ++i)
      question.bound[one.plan.plan.accesses[pass.first_access + i].port] = true;
    if (one.choice.view_tiles > 0) {
      question.subsurface_fraction = listed / one.choice.view_tiles;
      question.scattering_fraction =
          (double(one.choice.scattering_tiles) + one.choice.uniform_tiles) / one.choice.view_tiles;
    }
    const auto reads = subsurface::image_reads(type, question);
    const bool over_all =
        type.dispatch.domain == DispatchRule::Domain::rectangle && type.dispatch.cells_per_group == 1;
    const double tiles = over_all ? double(one.choice.view_tiles) : listed;
    if (reads) sum += reads->per_invocation * pixels_per_tile * tiles / finer;
  }
  return sum;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0 : values[values.size() / 2];
}

ReportValue largest_difference(const SkipBench& bench, const Case& one) {
  for (const Case& other : bench.cases) {
    if (other.from.name != one.from.same_as) continue;
    double largest = 0;
    for (size_t i = 0; i < one.picture.size(); ++i)
      largest = std::max(largest, std::abs(double(one.picture[i]) - double(other.picture[i])));
    return largest;
  }
  return {};
}

Report make_report(const Session& session, SkipBench& bench) {
  const std::vector<float> sap_tables = subsurface::make_sap_tables({true, true}, {});
  const double full = median(bench.cases.front().device_ms);
  Report report;
  report.bench = "skip";
  report.title = "Frames that do not need all of a graph";
  report.summary = fmt::format("{}, {}x{}, d = {} px; medians of {}, all cases interleaved",
                               bench.options.graph, bench.options.size.width, bench.options.size.height, d_px,
                               format_count(bench.options.repetitions, "frame"));
  report.info = machine_info(session.command, bench.host.properties.deviceName);
  if (bench.options.quick) report.info.push_back(quick_fact());
  report.info.emplace_back("full", "the whole image scatters and nothing is skipped");
  report.info.emplace_back("reads", "texels read by the groups that ran, counted from the kernels' source "
                                    "for an environment that scatters");
  report.table.columns = {{"case", "case"},
                          {"dispatches", "dispatches"},
                          {"groups", "groups"},
                          {"reads", "reads"},
                          {"transient_bytes", "transient bytes"},
                          {"device_ms", "device, ms"},
                          {"full_device_ms", "full, ms"},
                          {"share", "of full"},
                          {"max_difference", "largest difference"}};
  for (const Case& one : bench.cases) {
    const double ms = median(one.device_ms);
    report.table.rows.push_back({one.from.name, int64_t{one.choice.dispatches},
                                 static_cast<int64_t>(one.choice.groups),
                                 static_cast<int64_t>(reads_of(bench, one, sap_tables)),
                                 static_cast<int64_t>(one.device->memory().transient_bytes), ms, full,
                                 full > 0 ? ms / full : 0, largest_difference(bench, one)});
  }
  return report;
}

std::string text_of(const Report& report) {
  Table table;
  for (const ReportColumn& column : report.table.columns)
    table.columns.push_back({column.title, column.key != "case"});
  for (const auto& row : report.table.rows) {
    auto& cells = table.rows.emplace_back();
    for (const ReportValue& value : row) {
      if (const auto* text = std::get_if<std::string>(&value))
        cells.push_back(*text);
      else if (const auto* number = std::get_if<double>(&value))
        cells.push_back(fmt::format("{:.3g}", *number));
      else if (const auto* count = std::get_if<int64_t>(&value))
        cells.push_back(fmt::format("{}", *count));
      else
        cells.emplace_back("-");
    }
  }
  return format_table(table);
}

ExitCode failed(const Session& session, const demo::Error& error) {
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  return fail(session, static_cast<ExitCode>(error.kind), error.text);
}

} // namespace

ExitCode bench_skip(const Session& session, const BenchSkipOptions& requested) {
  const BenchSkipOptions options = quickened(requested);
  Diagnostics diagnostics;
  const GraphParts parts{.overlays = {}, .roots = {}, .pass_types = options.pass_types};
  auto loaded = load_graph(options.graph, parts, diagnostics);
  if (!loaded) return fail_graph(session, options.graph, diagnostics);
  const std::string text = diagnostics.files.front().text;
  std::vector<Document> overlays;
  if (auto overlay = parse_document("without flat light", without_uniform_light, diagnostics))
    overlays.push_back(std::move(*overlay));
  auto document = read_document(options.graph, diagnostics);
  auto plain = document ? load_graph(std::move(*document), std::move(overlays),
                                     open_beside(options.graph, {}), diagnostics, options.pass_types)
                        : std::nullopt;
  if (!plain) return fail_graph(session, options.graph, diagnostics);
  const auto profile_text = read_document(options.profile, diagnostics);
  const auto profile = profile_text ? subsurface::read_profile(*profile_text, diagnostics) : std::nullopt;
  if (!profile) return fail_graph(session, options.profile, diagnostics);

  HostPasses host_passes(loaded->host_pass_types); // outlives the device's context
  auto host = demo::create_vulkan_host({});
  if (!host) return failed(session, host.error());
  SkipBench bench{**host, options,         std::move(*loaded), std::move(*plain),
                  text,   {{1, *profile}}, host_passes.hooks()};
  for (SkipCase& one : make_skip_cases(options.size.width, options.size.height, d_px, bench.profiles))
    if (auto ready = prepare(bench, std::move(one)); !ready) return failed(session, ready.error());
  Progress progress(progress_style(session.quiet, false), "skip", "frame", warm_up + options.repetitions);
  if (auto done = measure(bench, progress); !done) return failed(session, done.error());
  const Report report = make_report(session, bench);
  if (!session.quiet && options.json != "-" && options.html != "-") print(text_of(report));
  const std::string problem = deliver_report(report, options.json, "", options.html);
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

} // namespace dermis::tools
