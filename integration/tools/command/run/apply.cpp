// dermis apply: runs a graph on captured frames through the C interface, and writes scattered light
// and combined colour as EXR.

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/run/apply_slots.hpp"
#include "integration/tools/command/run/captured.hpp"
#include "integration/tools/command/run/device_graph.hpp"
#include "integration/tools/command/run/host_passes.hpp"
#include "integration/tools/command/run/pass_times.hpp"
#include "integration/tools/command/run/surface_warnings.hpp"
#include "integration/tools/files/exr.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dermis::tools {
namespace {

struct ApplyRun {
  const Session& session;
  const ApplyOptions& options;
  const LoadedGraph& loaded;
  demo::VulkanHost& host;
  // For one size and one choice of slots. `timed` runs only for times, so that neither the number
  // of repetitions nor their histories change a picture; null without repetitions.
  std::unique_ptr<DeviceGraph> device = {}, timed = {};
  DeviceGraphRequest request = {};
  PassTimes times = {};
  uint64_t runs = 0, all_runs = 0; // runs so far, and runs in total
  demo::ContextHooks hooks = {};
};

// A frame with other images or profiles than the previous frame needs a new graph, and history
// restarts. A frame of another size resizes the graph, which keeps the history that survives a
// resize.
demo::Result<> prepare(ApplyRun& run, const CapturedFrame& frame, const SlotChoice& slots) {
  DeviceGraphRequest request = {};
  request.graph_name = run.options.graph;
  request.graph_text = run.loaded.text;
  request.overlays = run.loaded.overlays;
  request.include = for_engine(open_included(run.options.graph, run.options.inputs.roots));
  request.width = frame.description.width;
  request.height = frame.description.height;
  request.pixel_aspect = std::abs(frame.rays.scale_x / frame.rays.scale_y);
  request.settings = settings_as_json(run.loaded.graph, run.options.settings);
  request.unbound = slots.unbound;
  request.hooks = run.hooks;
  for (const auto& [slot, format] : slots.formats)
    request.formats.emplace_back(slot, static_cast<VkFormat>(format_info(format).vulkan));
  for (const auto& one : frame.description.profiles)
    request.profiles.push_back({one.id, one.profile.name, profile_as_json(one.profile)});
  if (run.device != nullptr && same_but_size(request, run.request)) {
    if (request.width == run.request.width && request.height == run.request.height)
      return demo::success();
    run.request = std::move(request);
    auto resized = run.device->resize(run.request.width, run.request.height);
    if (resized && run.timed) resized = run.timed->resize(run.request.width, run.request.height);
    return resized;
  }
  for (std::unique_ptr<DeviceGraph>* device : {&run.device, &run.timed}) {
    device->reset();
    if (device == &run.timed && run.options.repeat == 1) break;
    auto made = DeviceGraph::create(run.host, request);
    if (!made) return made.error();
    *device = made.take();
  }
  run.request = std::move(request);
  return demo::success();
}

bool was_rendered(const CapturedFrame& frame, size_t pixel) {
  const Rectangle& render = frame.description.render;
  const size_t x = pixel % frame.description.width, y = pixel / frame.description.width;
  return x >= render.x && x < size_t{render.x} + render.width && y >= render.y &&
         y < size_t{render.y} + render.height;
}

// Returns the input light outside the render rectangle, where the graph writes nothing.
Image scattered_light(const CapturedFrame& frame, std::vector<float> written) {
  Image light{frame.lighting.width, frame.lighting.height, 3, std::move(written)};
  for (size_t i = 0; i < light.values.size(); ++i)
    if (!was_rendered(frame, i / 3)) light.values[i] = frame.lighting.values[i];
  return light;
}

// Combines as a host would. The graph already multiplies scattered light by albedo in pixels with a
// profile; elsewhere the captured albedo applies.
Image combine(const CapturedFrame& frame, const std::vector<float>& lighting) {
  Image combined = Image::sized(frame.lighting.width, frame.lighting.height, 3);
  for (size_t i = 0; i < combined.values.size(); ++i) {
    const bool is_colour = frame.profile[i / 3] != 0 && was_rendered(frame, i / 3);
    const float albedo =
        frame.albedo.values.empty() || is_colour ? 1.0f : std::min(frame.albedo.values[i], 1.0f);
    const float specular = frame.specular.values.empty() ? 0.0f : frame.specular.values[i];
    combined.values[i] =
        std::min(lighting[i] * albedo + specular, std::numeric_limits<float>::max());
  }
  return combined;
}

demo::Result<> write_frame(const CapturedFrame& frame, const std::string& name, DeviceGraph& device,
                           OutputFolder& out) {
  if (const std::string problem = out.open_below(name); !problem.empty())
    return demo::Error{demo::ErrorKind::environment, problem};
  const auto write = [&](const char* file, const Image& image) -> demo::Result<> {
    std::string problem;
    if (write_exr(out.path_of(name + "/" + file), image, rgb_names, problem))
      return demo::success();
    return demo::Error{demo::ErrorKind::environment, problem};
  };
  auto lighting = device.read_rgb("lighting");
  if (!lighting) return lighting.error();
  if (auto written = write("combined.exr", combine(frame, *lighting)); !written) return written;
  if (!device.has("scattered_light")) {
    out.remove(name + "/scattered.exr"); // of an earlier run
    return demo::success();
  }
  auto scattered = device.read_rgb("scattered_light");
  if (!scattered) return scattered.error();
  return write("scattered.exr", scattered_light(frame, scattered.take()));
}

demo::Result<> apply_frame(ApplyRun& run, const CapturedFrame& frame, const std::string& name,
                           OutputFolder& out) {
  const SlotChoice slots = choose_slots(run.loaded.graph, frame);
  if (!slots.problem.empty()) return demo::Error{demo::ErrorKind::input, slots.problem};
  if (auto ready = prepare(run, frame, slots); !ready) return ready;
  const auto run_on = [&](DeviceGraph& device) -> demo::Result<> {
    if (interrupted()) return stopped();
    device.skip_to(frame.description.frame_index);
    // also on repeats, since the graph may write into its inputs
    for (const SlotData& data : slots.data)
      if (auto given = device.upload(data.slot, data.texels, data.channels); !given) return given;
    return device.run(c_frame(frame.description));
  };
  if (auto ran = run_on(*run.device); !ran) return ran;
  DeviceGraph& timed = run.timed ? *run.timed : *run.device;
  for (uint32_t i = 0; i < run.options.repeat; ++i) {
    if (run.timed)
      if (auto ran = run_on(timed); !ran) return ran;
    // the first of several runs only warms caches
    if (run.runs++ == 0 && run.all_runs > 1) continue;
    run.times.begin_frame();
    for (const DeviceGraph::PassTime& time : timed.times())
      run.times.add(time.pass, time.milliseconds);
  }
  return write_frame(frame, name, *run.device, out);
}

ExitCode report(const ApplyRun& run, const CapturedSequence& sequence,
                const Diagnostics& surfaces) {
  if (!run.times.empty())
    say(run.session,
        format_times(run.times, run.all_runs == 1 ? std::string("pass") + first_frame : "pass"));
  say(run.session,
      fmt::format("{} in {}\ndevice: {}\n", format_count(sequence.folders.size(), "frame", true),
                  run.options.out, run.host.properties.deviceName));
  if (run.session.json) {
    JsonWriter answer;
    answer.open_object().member("ok", true).member("graph", run.options.graph);
    answer.member("device", std::string_view(run.host.properties.deviceName));
    answer.member("frames", static_cast<uint64_t>(sequence.folders.size()))
        .member("out", run.options.out);
    answer.member("sanitised_values", sequence.sanitised_values).key("passes");
    write_times(answer, run.times);
    answer.member("device_ms", run.times.total());
    answer.key("diagnostics").json(format_as_json(surfaces)).close();
    print(std::move(answer).finish());
  }
  return ExitCode::ok;
}

} // namespace

ExitCode apply(const Session& session, const ApplyOptions& options) {
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> loaded = load_graph(options.graph, options.inputs, diagnostics);
  if (!loaded) return fail_graph(session, options.graph, diagnostics);
  const CompileChoices choices = read_choices(loaded->graph, options.settings);
  if (!choices.problem.empty()) return fail(session, ExitCode::usage, choices.problem);
  const std::optional<CapturedSequence> sequence =
      check_sequence(session, options.frames, options.profiles, options.inputs.roots);
  if (!sequence) return ExitCode::problems;

  HostPasses host_passes(loaded->host_pass_types); // outlives the device's context
  auto host = demo::create_vulkan_host({});
  if (!host) return fail(session, host.error());
  OutputFolder out;
  if (const std::string problem = out.open(options.out); !problem.empty())
    return fail(session, ExitCode::environment, problem);

  ApplyRun run{session, options, *loaded, **host, nullptr, {}, {}};
  run.hooks = host_passes.hooks();
  run.all_runs = sequence->folders.size() * uint64_t{options.repeat};
  Progress progress(progress_style(session.quiet, session.json), "apply", "frame",
                    sequence->folders.size());
  Diagnostics surfaces; // warnings of the sequence, each once
  for (size_t i = 0; i < sequence->folders.size(); ++i) {
    const std::optional<CapturedFrame> frame = load_frame(*sequence, i);
    if (!frame) return fail(session, ExitCode::problems, "the capture changed while it was read");
    warn_of_surfaces(*frame, surfaces);
    const auto done = apply_frame(run, *frame, sequence->names[i], out);
    if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
    if (!done) return fail(session, done.error());
    progress.update(i + 1);
  }
  print_beside_document(session, surfaces);
  warn_of_earlier("apply", options.out, *sequence, {"combined.exr", "scattered.exr"});
  return report(run, *sequence, surfaces);
}

} // namespace dermis::tools
