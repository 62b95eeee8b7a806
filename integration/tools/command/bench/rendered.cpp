// Subjects rendered by the demo engine, converted to inputs of a graph.

#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/run/reference_run.hpp"
#include "integration/tools/command/run/rendered_frame.hpp"
#include "integration/tools/files/capture_reference.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr double half_a_degree = 0.5 * 3.14159265358979323846 / 180; // in radians
constexpr double close_enough = 0.02;                                // relative to d_px
constexpr int max_zooms = 5;

demo::Result<Subject> render_once(const SceneRequest& request, const SubjectOptions& options,
                                  const std::optional<demo::CameraPlace>& camera) {
  demo::RenderOptions engine;
  engine.scene = request.file;
  if (request.model) engine.model = options.model;
  engine.width = options.width;
  engine.height = options.height;
  engine.camera = camera;
  std::vector<CaptureProfile> profiles;
  Subject subject{request.scene, request.framing, {}, 0};
  demo::RenderCallbacks callbacks;
  callbacks.on_start = [&](const demo::RenderInfo& info) {
    return read_profiles(info.profiles, profiles);
  };
  callbacks.on_frame = [&](const demo::FrameOutputs& frame) -> demo::Result<> {
    auto captured = captured_frame(frame, profiles);
    if (!captured) return captured.error();
    subject.frame = captured.take();
    return demo::success();
  };
  if (auto done = demo::render(engine, callbacks); !done) return done.error();
  const ReferenceFrame reference = make_reference_frame(subject.frame);
  subject.d_px = median_d_px(reference.input());
  return subject;
}

} // namespace

demo::Result<Subject> render_subject(const SceneRequest& request, const SubjectOptions& options) {
  std::optional<demo::CameraPlace> camera = request.camera;
  auto subject = render_once(request, options, camera);
  if (!subject || request.d_px.empty() || !camera) return subject;
  const double target_d_px = request.d_px.front();
  for (int i = 0; i < max_zooms && subject->d_px > 0 &&
                  std::abs(subject->d_px / target_d_px - 1) > close_enough;
       ++i) {
    const double half =
        std::tan(camera->vertical_fov * half_a_degree) * subject->d_px / target_d_px;
    camera->vertical_fov = std::clamp(std::atan(half) / half_a_degree, 1.0, 150.0);
    subject = render_once(request, options, camera);
    if (!subject) return subject;
  }
  return subject;
}

} // namespace dermis::tools
