#pragma once
// Frames of a scene one after the other, as a graph would be given them, and their truth at some pixels.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/bench/reference.hpp"
#include "integration/tools/files/capture.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct SequenceRequest {
  std::string scene, framing;
  std::string file; // scene file
  double d_px = 0;  // the camera zooms until the first frame's median is within 2 % of it; 0: as it is
  uint32_t first = 0, frames = 60; // of the scene
  bool still = false;              // camera and surfaces rest, so that frames can be compared pixel by pixel
  std::optional<demo::CameraPlace> camera = {}; // instead of the scene's own
};

struct SequenceFrame {
  CapturedFrame captured; // without what no technique of the bench reads
  bool cut = false;       // the camera has jumped since the frame before
};

struct Sequence {
  SequenceRequest request;
  std::vector<SequenceFrame> frames;
  double d_px = 0;     // median over subsurface pixels of the widest channel's projected d, first frame
  double exposure = 1; // 99.9th percentile of the light over all frames at 1
};

// Errors: those of demo::render.
demo::Result<Sequence> render_sequence(const SequenceRequest& request, uint32_t width, uint32_t height,
                                       const demo::ModelOptions& model);

} // namespace dermis::tools
