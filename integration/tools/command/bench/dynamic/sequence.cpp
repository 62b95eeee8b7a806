#include "integration/tools/command/bench/dynamic/sequence.hpp"

#include "integration/tools/command/run/reference_run.hpp"
#include "integration/tools/command/run/rendered_frame.hpp"
#include "integration/tools/files/capture_reference.hpp"

#include <cmath>

namespace dermis::tools {
namespace {

constexpr double little_change = 0.02; // relative to d_px
constexpr int max_tries = 4;

demo::Result<Sequence> render_frames(const SequenceRequest& request, demo::RenderOptions options,
                                     uint32_t frames) {
  options.first_frame = request.first;
  options.frames = frames;
  Sequence sequence{request, {}, 0, 1};
  ExposureMeter meter;
  std::vector<CaptureProfile> profiles;
  demo::RenderCallbacks callbacks;
  callbacks.on_start = [&](const demo::RenderInfo& info) {
    return read_profiles(info.profiles, profiles);
  };
  callbacks.on_frame = [&](const demo::FrameOutputs& frame) -> demo::Result<> {
    auto captured = captured_frame(frame, profiles);
    if (!captured) return captured.error();
    SequenceFrame one{captured.take(), frame.cut};
    for (Image* unused : {&one.captured.normal, &one.captured.specular, &one.captured.thickness,
                          &one.captured.back_lighting, &one.captured.albedo})
      *unused = {};
    const ReferenceFrame reference = make_reference_frame(one.captured);
    meter.add(reference.light, reference.profile);
    if (sequence.frames.empty()) sequence.d_px = median_d_px(reference.input());
    sequence.frames.push_back(std::move(one));
    return demo::success();
  };
  if (auto done = demo::render(options, callbacks); !done) return done.error();
  sequence.exposure = meter.result();
  for (SequenceFrame& frame : sequence.frames)
    frame.captured.description.exposure = sequence.exposure;
  return sequence;
}

} // namespace

demo::Result<Sequence> render_sequence(const SequenceRequest& request, uint32_t width,
                                       uint32_t height, const demo::ModelOptions& model) {
  demo::RenderOptions options;
  options.scene = request.file;
  options.model = model;
  options.camera = request.camera;
  options.jitter = request.jitter;
  options.width = width;
  options.height = height;
  for (int i = 0; i < max_tries && request.d_px > 0; ++i) {
    auto first = render_frames(request, options, 1);
    if (!first) return first;
    if (!(first->d_px > 0) || std::abs(first->d_px / request.d_px - 1) <= little_change) break;
    options.zoom *= request.d_px / first->d_px;
  }
  return render_frames(request, options, request.frames);
}

} // namespace dermis::tools
