#include "integration/tools/command/run/trace.hpp"

#include "framegraph/text/json_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string_view>

namespace dermis::tools {
namespace {

constexpr uint32_t process = 1, device_track = 1, host_track = 2;
constexpr double us_per_ms = 1000;

double begin_of(const demo::FrameOutputs& frame, std::string_view phase) {
  for (const demo::HostPhase& one : frame.phases)
    if (one.name == phase) return one.begin_ms;
  return 0;
}

void begin_event(JsonWriter& out, std::string_view name, std::string_view phase, double at_ms) {
  out.open_object(true).member("name", name).member("ph", phase).member("ts", us_per_ms * at_ms);
  out.member("pid", process);
}

void name_track(JsonWriter& out, std::string_view what, uint32_t track, std::string_view name) {
  out.open_object(true)
      .member("name", what)
      .member("ph", "M")
      .member("pid", process)
      .member("tid", track);
  out.key("args").open_object().member("name", name).close().close();
}

} // namespace

void Trace::add(const demo::FrameOutputs& frame) {
  if (frame.phases.empty()) return;
  const double begin = frame.phases.front().begin_ms;
  spans_.push_back({false, fmt::format("frame {}", frame.frame), begin,
                    frame.phases.back().end_ms - begin, frame.frame});
  for (const demo::HostPhase& phase : frame.phases)
    spans_.push_back(
        {false, phase.name, phase.begin_ms, phase.end_ms - phase.begin_ms, frame.frame});

  const auto run = [&](std::span<const demo::PassTime> passes, double from) {
    device_free_ms_ = std::max(device_free_ms_, from);
    for (const demo::PassTime& pass : passes) {
      spans_.push_back({true, pass.pass, device_free_ms_, pass.milliseconds, frame.frame});
      device_free_ms_ += pass.milliseconds;
    }
  };
  // The engine's composite pass runs after the graph; its other passes run before.
  const std::span<const demo::PassTime> host = frame.host_times;
  const bool composes = !host.empty() && host.back().pass == "composite";
  run(composes ? host.first(host.size() - 1) : host, begin_of(frame, "run scene"));
  run(frame.dermis_times, begin_of(frame, "run graph"));
  if (composes) run(host.last(1), begin_of(frame, "run graph"));
  if (frame.choice) chosen_.push_back({begin_of(frame, "run graph"), frame.frame, *frame.choice});
}

std::string Trace::json(const std::string& command, const std::string& device) const {
  JsonWriter out;
  out.open_object().key("traceEvents").open_array();
  name_track(out, "process_name", 0, "dermis");
  name_track(out, "thread_name", device_track, "device: " + device);
  name_track(out, "thread_name", host_track, "host");
  for (const Span& span : spans_) {
    begin_event(out, span.name, "X", span.begin_ms);
    out.member("dur", us_per_ms * span.duration_ms)
        .member("cat", span.on_device ? "device" : "host");
    out.member("tid", span.on_device ? device_track : host_track);
    out.key("args").open_object().member("frame", span.frame).close().close();
  }
  std::string_view before;
  for (const Chosen& one : chosen_) {
    const demo::FrameChoice& choice = one.choice;
    begin_event(out, "frame time, ms", "C", one.at_ms);
    out.key("args").open_object().member("predicted", choice.predicted_ms);
    if (choice.measured_ms >= 0) out.member("measured", choice.measured_ms);
    if (choice.budget_ms > 0) out.member("budget", choice.budget_ms);
    out.close().close();
    begin_event(out, "tiles", "C", one.at_ms);
    out.key("args").open_object().member("scatter", choice.scattering_tiles);
    out.member("uniform", choice.uniform_tiles)
        .member("copied", choice.copied_tiles)
        .close()
        .close();
    if (choice.configuration != before) {
      begin_event(out, choice.configuration, "i", one.at_ms);
      out.member("s", "p").member("cat", "choice").member("tid", host_track);
      out.key("args").open_object().member("frame", one.frame).member("why", choice.why);
      out.member("predicted_rmse", choice.predicted_rmse).close().close();
    }
    before = choice.configuration;
  }
  out.close().member("displayTimeUnit", "ms").key("otherData").open_object();
  out.member("command", command).member("device", device).close().close();
  return std::move(out).finish();
}

} // namespace dermis::tools
