#pragma once
// What benches measure: still frames by the names of their scene and framing, rendered or generated.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/files/capture.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// One entry of a bench file's list "scenes".
struct SceneRequest {
  std::string scene, framing;
  std::string file;                        // scene file to render; "": generated, see generate_scene
  std::optional<demo::CameraPlace> camera; // instead of the scene's own
  std::vector<double> d_px; // one subject each; of a rendered scene at most one; empty: as it comes
  bool model = false;       // shows the model of --head
  bool study = false;       // only with --study
};

struct Subject {
  std::string scene, framing;
  CapturedFrame frame;
  double d_px = 0; // median over subsurface pixels of the widest channel's projected d
};

struct SubjectOptions {
  uint32_t width = 640, height = 360; // pixels
  demo::ModelOptions model;           // mesh "": none
};

// An orthographic view of a white plane at 1 m that faces it, under light 1, all of the first profile (id 1).
// The pixel pitch makes the widest channel of that profile d_px wide. Laws and scenes paint over it.
CapturedFrame plane_frame(uint32_t width, uint32_t height, double d_px,
                          std::span<const CaptureProfile> profiles);
// One d of 1 mm in all channels, for planes of one d.
subsurface::Profile grey_profile();

// Names that generate_scene knows.
bool is_generated(std::string_view scene);

// A generated scene: an orthographic view, `d_px` exact for the widest channel of its profile. Names, with
// lengths in picture heights h: edge (a slanted edge of light), disc (discs of light of all sizes on a
// plane), bumps (hills with slopes to 50 degrees under a key light), sphere (radius .42 h, the same light),
// depth_step (steps of .5, 2, 5 and 20 d under a texture), texture_plane (edges, discs and contrasts of every
// scale on a plane; framing "varying": d falls from d_px to an eighth of it across the picture; "mixed":
// cells of four profiles, all alike). Thread: any.
CapturedFrame generate_scene(const std::string& scene, const std::string& framing, uint32_t width,
                             uint32_t height, double d_px, const subsurface::Profile& skin);

// Renders a scene without a graph and takes what a graph would be given. With a d_px the field of view is
// changed until the median is within 2 % of it. Errors: those of demo::render.
demo::Result<Subject> render_subject(const SceneRequest& request, const SubjectOptions& options);

// The scan in the folder that --head names, from the bottom of the shoulders to the crown; "": none.
demo::ModelOptions head_model(const std::string& folder);
// Why it cannot be shown; "" when it can.
std::string why_no_head(const std::string& folder);

// The light before scattering of each, exposed and tonemapped, at most 480 pixels wide.
ReportPictures scene_pictures(std::span<const Subject> subjects);

} // namespace dermis::tools
