// dermis bench skip: measures frames that do not need all of a graph, compared with a frame that
// does.

#include "framegraph/text/document.hpp"
#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "integration/tools/command/bench/choice/skip_cases.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/run/apply_slots.hpp"
#include "integration/tools/command/run/captured.hpp"
#include "integration/tools/command/run/device_graph.hpp"
#include "integration/tools/command/run/host_passes.hpp"
#include "integration/tools/command/statistics.hpp"
#include "integration/tools/references/image_reads.hpp"
#include "passes/choice/configurations.hpp"
#include "passes/common/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr double d_px = 4; // as in the framing "close"
constexpr uint64_t warm_up = 3;
constexpr double pixels_per_tile = 64;

// Removes the detection of uniform light from a graph.
constexpr const char* without_uniform_light = R"({ "dermis_overlay": 2, "edits": [
  { "remove": "/passes/classify_uniform_light" }, { "remove": "/passes/classify/write/light_range" },
  { "remove": "/passes/classify/write/light_cells" }, { "remove": "/passes/tile_change" },
  { "remove": "/passes/tile_histogram" }, { "remove": "/passes/select_tiles" },
  { "remove": "/passes/horizontal_tiles" }, { "remove": "/passes/vertical_tiles" },
  { "remove": "/passes/vertical_and_copies" } ] })";

struct SkipFrame {
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
  const SuiteRun& run;
  LoadedGraph loaded, plain; // `plain` is without the detection of uniform light
  std::string text;
  std::vector<CaptureProfile> profiles;
  demo::ContextHooks hooks;
  std::vector<SkipFrame> cases = {};

  const LoadedGraph& graph_of(const SkipCase& one) const { return one.skips ? loaded : plain; }
};

demo::Result<> prepare_frame(SkipBench& bench, SkipCase from) {
  SkipFrame one;
  one.from = std::move(from);
  const LoadedGraph& loaded = bench.graph_of(one.from);
  one.slots = choose_slots(loaded.graph, one.from.frame);
  if (!one.slots.problem.empty()) return demo::Error{demo::ErrorKind::input, one.slots.problem};
  one.slots.unbound.emplace_back("scattered_light"); // only used by tools
  DeviceGraphRequest request;
  request.graph_name = bench.run.file("graph");
  request.graph_text = bench.text;
  request.width = bench.run.size().width;
  request.height = bench.run.size().height;
  if (!one.from.skips) request.overlays.push_back({"without uniform light", without_uniform_light});
  if (!one.from.no_profiles)
    for (const CaptureProfile& profile : bench.profiles)
      request.profiles.push_back(
          {profile.id, profile.profile.name, profile_as_json(profile.profile)});
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
    auto plan = compile_generic(loaded, bench.run.size(), choices, diagnostics);
    if (!plan) return demo::Error{demo::ErrorKind::input, "the graph cannot be compiled"};
    one.plan = std::move(*plan);
  }
  bench.cases.push_back(std::move(one));
  return demo::success();
}

// Uploads light for each run, since the graph scatters in place.
demo::Result<> run_once(SkipFrame& one, bool timed) {
  for (const SlotData& data : one.slots.data)
    if (auto given = one.device->upload(data.slot, data.texels, data.channels); !given)
      return given.error();
  if (auto ran = one.device->run(one.frame); !ran) return ran.error();
  if (const auto choice = one.device->choice()) one.choice = *choice;
  double sum = 0;
  for (const DeviceGraph::PassTime& time : one.device->times())
    sum += time.milliseconds;
  if (timed) one.device_ms.push_back(sum);
  return demo::success();
}

demo::Result<> measure_frames(SkipBench& bench, Progress& progress) {
  for (uint64_t i = 0; i < warm_up + bench.run.number("repetitions"); ++i) {
    // interleaved, so that a slowdown of the machine affects all cases
    for (SkipFrame& one : bench.cases)
      if (auto ran = run_once(one, i >= warm_up); !ran) return ran.error();
    if (interrupted()) return stopped();
    progress.update(i + 1);
  }
  for (SkipFrame& one : bench.cases) {
    auto picture = one.device->read_rgb("lighting");
    if (!picture) return picture.error();
    one.picture = picture.take();
  }
  return demo::success();
}

// Counts texels read by the groups that ran, assuming subsurface everywhere around them.
double reads_of(const SkipBench& bench, const SkipFrame& one, std::span<const float> sap_tables) {
  if (one.from.no_profiles || one.from.empty_bounds) return 0;
  const LoadedGraph& loaded = bench.graph_of(one.from);
  const double listed =
      double(one.choice.scattering_tiles) + one.choice.copied_tiles + one.choice.uniform_tiles;
  double sum = 0;
  for (const PlanPass& pass : one.plan.plan.passes) {
    const PassType& type = loaded.pass_types[pass.type];
    // runs if nothing scatters; otherwise the pyramid runs
    const bool copies = choice::copies_all_tiles(type);
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
    subsurface::ReadsInput input{
        settings, std::vector<bool>(type.ports.size(), false), {d_px, d_px, d_px}, sap_tables};
    for (uint32_t i = 0; i < pass.access_count; ++i)
      input.bound[one.plan.plan.accesses[pass.first_access + i].port] = true;
    if (one.choice.view_tiles > 0) {
      input.subsurface_fraction = listed / one.choice.view_tiles;
      input.scattering_fraction =
          (double(one.choice.scattering_tiles) + one.choice.uniform_tiles) / one.choice.view_tiles;
    }
    const auto reads = subsurface::image_reads(type, input);
    const bool over_all = type.dispatch.domain == DispatchRule::Domain::rectangle &&
                          type.dispatch.cells_per_group == 1;
    const double tiles = over_all ? double(one.choice.view_tiles) : listed;
    if (reads) sum += reads->per_invocation * pixels_per_tile * tiles / finer;
  }
  return sum;
}

std::optional<double> largest_difference(const SkipBench& bench, const SkipFrame& one) {
  for (const SkipFrame& other : bench.cases) {
    if (other.from.name != one.from.same_as) continue;
    double largest = 0;
    for (size_t i = 0; i < one.picture.size(); ++i)
      largest = std::max(largest, std::abs(double(one.picture[i]) - double(other.picture[i])));
    return largest;
  }
  return {};
}

struct SkipRow {
  std::string name;
  uint64_t dispatches = 0, groups = 0, reads = 0, transient_bytes = 0;
  double device_ms = 0, full_ms = 0;
  std::optional<double> max_difference;
};

// Loads the graph and the same without the detection of uniform light.
demo::Result<> load_graphs(SuiteRun& run, LoadedGraph& loaded, LoadedGraph& plain,
                           std::string& text) {
  const std::string path = run.file("graph");
  Diagnostics diagnostics;
  auto whole = load_graph(path, run.pass_types(), diagnostics);
  if (!whole) return run.reject(path, diagnostics);
  text = diagnostics.files.front().text;
  std::vector<Document> overlays;
  if (auto overlay = parse_document("without uniform light", without_uniform_light, diagnostics))
    overlays.push_back(std::move(*overlay));
  auto document = read_document(path, diagnostics);
  auto part = document
                  ? load_graph(std::move(*document), std::move(overlays), open_included(path, {}),
                               diagnostics, run.pass_types().pass_types)
                  : std::nullopt;
  if (!part) return run.reject(path, diagnostics);
  loaded = std::move(*whole);
  plain = std::move(*part);
  return demo::success();
}

demo::Result<> measure_skip(SuiteRun& run, const Emit<SkipRow>& emit) {
  LoadedGraph loaded, plain;
  std::string text;
  if (auto done = load_graphs(run, loaded, plain, text); !done) return done;
  Diagnostics diagnostics;
  const auto profile_text = read_document(run.file("profile"), diagnostics);
  const auto profile =
      profile_text ? subsurface::read_profile(*profile_text, diagnostics) : std::nullopt;
  if (!profile) return run.reject(run.file("profile"), diagnostics);

  HostPasses host_passes(loaded.host_pass_types); // outlives the device's context
  const auto host = run.open_device();
  if (!host) return host.error();
  SkipBench bench{
      **host, run, std::move(loaded), std::move(plain), text, {{1, *profile}}, host_passes.hooks()};
  for (SkipCase& one : make_skip_cases(run.size().width, run.size().height, d_px, bench.profiles))
    if (auto ready = prepare_frame(bench, std::move(one)); !ready) return ready;
  Progress progress = run.progress("frame", warm_up + run.number("repetitions"));
  if (auto done = measure_frames(bench, progress); !done) return done;

  run.report.summary = fmt::format("{}, {}x{}, d = {} px; medians of {}, all cases interleaved",
                                   run.file("graph"), run.size().width, run.size().height, d_px,
                                   format_count(run.number("repetitions"), "frame"));
  run.add_info("full", "the whole image scatters and nothing is skipped");
  run.add_info("reads",
               "texels read by the groups that ran, counted from the kernels' source for an "
               "environment that scatters");
  const std::vector<float> sap_tables = subsurface::make_shared_sap_tables({true, true});
  const double full_ms = median(bench.cases.front().device_ms);
  for (const SkipFrame& one : bench.cases)
    emit({one.from.name, one.choice.dispatches, one.choice.groups,
          static_cast<uint64_t>(reads_of(bench, one, sap_tables)),
          one.device->memory().transient_bytes, median(one.device_ms), full_ms,
          largest_difference(bench, one)});
  return demo::success();
}

} // namespace

Suite skip_suite() {
  using Row = SkipRow;
  SuiteOption size =
      size_option({1280, 720}); // in a smaller view, fixed costs are a large fraction
  return make_suite<Row>(
      {.name = "skip",
       .what = "Measure frames that do not need all of a graph",
       .title = "Frames that do not need all of a graph",
       .options = {size,
                   {"graph", "Graph file", "configs/graphs/skin.json", "FILE"},
                   pass_types_option(),
                   {"profile", "Profile of the plane", "configs/profiles/skin.json", "FILE"},
                   {"repetitions", "Timed frames per case", 31u, "", 1u, 1, 3600}}},
      {{"case", "case", &Row::name},
       {"dispatches", "dispatches", &Row::dispatches},
       {"groups", "groups", &Row::groups},
       {"reads", "reads", &Row::reads},
       {"transient_bytes", "transient bytes", &Row::transient_bytes},
       {"device_ms", "device, ms", &Row::device_ms},
       {"full_device_ms", "full, ms", &Row::full_ms},
       {"share", "of full",
        [](const Row& row) { return row.full_ms > 0 ? row.device_ms / row.full_ms : 0; }},
       {"max_difference", "largest difference", &Row::max_difference}},
      measure_skip);
}

} // namespace dermis::tools
