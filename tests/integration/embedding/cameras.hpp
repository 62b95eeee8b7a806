#pragma once
// Several cameras of one graph, each with separate images and light. The graph accumulates light
// over frames, so a frame depends on all earlier frames of its camera.

#include "tests/integration/abi/in_flight.hpp"

namespace dermis::abi_test {

struct Camera {
  std::map<std::string, demo::Image> images;
  std::vector<dermis_image_binding> bound;
};

struct CameraTest : InFlightTest {
  static constexpr uint32_t side = 48; // Pixels.

  GraphOptions accumulating() const; // Accumulates light without clipping.
  dermis_graph make_accumulating();
  // Each seed gives a different pattern of light.
  Camera make_camera(dermis_graph graph, uint32_t seed);
  // Returns a frame of a camera at rest; `index` is dermis_frame.frame_index.
  dermis_frame frame_of(const Camera& camera, uint64_t index) const;
  std::vector<float> light_of(const Camera& camera) const; // Waits for the device first.
};

} // namespace dermis::abi_test
