// dermis capture: writes the graph inputs of a scene as captured frames.
#include "integration/tools/files/capture.hpp"
#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/capture/capture_scene.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/run/rendered_frame.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace dermis::tools {

demo::Result<> capture_scene(const Session& session, const CaptureOptions& options) {
  demo::RenderOptions engine;
  engine.scene = options.scene;
  engine.roots = options.roots;
  engine.model = {options.model.model, options.model.albedo, options.model.normal,
                  options.model.specular, options.model.height};
  engine.width = options.size.width;
  engine.pixel_aspect = options.pixel_aspect;
  engine.height = options.size.height;
  engine.first_frame = options.first;
  engine.frames = options.frames;

  CaptureWriter writer;
  std::vector<CaptureProfile> profiles;
  std::string problem;
  uint32_t done = 0;
  Progress progress(progress_style(session.quiet, session.json), "capture", "frame",
                    options.frames);
  demo::RenderCallbacks callbacks;
  callbacks.on_start = [&](const demo::RenderInfo& info) -> demo::Result<> {
    for (const std::string& warning : info.warnings)
      spdlog::warn("{}", warning);
    for (const std::string& credit : info.credits)
      say(session, credit + "\n");
    if (auto read = read_profiles(info.profiles, profiles); !read) return read;
    if (writer.begin(options.out, problem)) return demo::success();
    return demo::Error{demo::ErrorKind::environment, problem};
  };
  callbacks.on_frame = [&](const demo::FrameOutputs& frame) -> demo::Result<> {
    if (interrupted()) return stopped();
    const auto captured = captured_frame(frame, profiles);
    if (!captured) return captured.error();
    if (!writer.add(*captured, problem)) return demo::Error{demo::ErrorKind::environment, problem};
    progress.update(++done);
    return demo::success();
  };
  const auto summary = demo::render(engine, callbacks);
  if (!summary) return summary.error();
  if (!writer.finish(problem)) return demo::Error{demo::ErrorKind::environment, problem};
  return demo::success();
}

ExitCode capture(const Session& session, const CaptureOptions& options) {
  const auto captured = capture_scene(session, options);
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!captured) return fail(session, captured.error());
  say(session, fmt::format("{} in {}\n", format_count(options.frames, "frame", true), options.out));
  if (session.json) {
    JsonWriter answer;
    answer.open_object()
        .member("ok", true)
        .member("frames", options.frames)
        .member("out", options.out)
        .close();
    print(std::move(answer).finish());
  }
  return ExitCode::ok;
}

} // namespace dermis::tools
