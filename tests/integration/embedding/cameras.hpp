#pragma once
// Cameras of one graph, each with images and a light of its own, on a graph that keeps light over frames: a
// frame of a camera hangs on all the frames that it saw before.

#include "tests/integration/abi/in_flight.hpp"

namespace dermis::abi_test {

struct Camera {
  std::map<std::string, demo::Image> images;
  std::vector<dermis_image_binding> bound;
};

struct CameraTest : InFlightTest {
  static constexpr uint32_t side = 48; // pixels

  GraphOptions accumulating() const; // its light over frames, without clipping
  dermis_graph make_accumulating();
  Camera make_camera(dermis_graph graph, uint32_t seed); // light of its own pattern
  // A resting camera; `index` as dermis_frame.frame_index.
  dermis_frame frame_of(const Camera& camera, uint64_t index) const;
  std::vector<float> light_of(const Camera& camera) const; // waits for the device first
};

} // namespace dermis::abi_test
