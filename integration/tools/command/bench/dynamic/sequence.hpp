#pragma once
// Sequences of frames of a scene, as inputs of a graph, with references at some pixels.

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
  // The camera zooms until the first frame's median is within 2 % of this value; 0: no zoom.
  double d_px = 0;
  uint32_t first = 0, frames = 60; // frame numbers of the scene
  // camera and surfaces rest, so that frames are comparable per pixel
  bool still = false;
  bool jitter = false;                          // sub-pixel jitter of the camera
  std::optional<demo::CameraPlace> camera = {}; // replaces the scene's camera
};

struct SequenceFrame {
  CapturedFrame captured; // without images that no technique of the bench reads
  bool cut = false;       // the camera jumped since the previous frame
};

struct Sequence {
  SequenceRequest request;
  std::vector<SequenceFrame> frames;
  // first frame's median over subsurface pixels of the widest channel's projected d
  double d_px = 0;
  double exposure = 1; // maps the 99.9th percentile of the light over all frames to 1
};

// Errors: those of demo::render.
demo::Result<Sequence> render_sequence(const SequenceRequest& request, uint32_t width,
                                       uint32_t height, const demo::ModelOptions& model);

} // namespace dermis::tools
