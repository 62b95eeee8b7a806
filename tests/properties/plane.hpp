#pragma once
// A plane that faces an orthographic camera, run through a shipped graph on the device: where the closed
// forms hold.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace properties {

using Rgb = std::array<double, 3>;

struct Plane {
  uint32_t width = 256, height = 256;
  double pixel_pitch_m = 1e-3;
  std::array<double, 3> d_px = {4, 4, 4}; // of profile 1, in pixels; profile 2 has the same
  std::function<float(double x, double y)> light = [](double, double) {
    return 1.0f;
  }; // pixel centres: integers
  std::function<uint8_t(int x, int y)> profile = [](int, int) { return uint8_t{1}; };
  std::function<uint8_t(int x, int y)> earlier_profile; // of all frames but the last; empty: as `profile`
  std::function<float(int x, int y)> depth_m = [](int, int) { return 1.0f; };
  std::function<float(int x, int y)> scatter_scale; // empty: not bound
  std::array<uint32_t, 4> rectangle = {0, 0, 0, 0}; // of the allocated size; width 0: all of it
  std::function<float(int x, int y)> thickness_m;   // empty: not bound, nor light from behind, which is 1
  std::string overlay;                              // of configs/overlays/, without .json; "": none
  std::string profile_file; // text of a profile for both ids, in place of d_px; "": Burley with d_px
};

struct Picture {
  uint32_t width = 0, height = 0;
  std::vector<float> rgb;

  double at(uint32_t x, uint32_t y, uint32_t c) const { return rgb[3 * (size_t{y} * width + x) + c]; }
};

using Settings = std::vector<std::pair<std::string, std::string>>; // name, JSON text

// Runs configs/graphs/<graph>.json under the validation layer and returns `scattered_light`. Fails the test
// on any error and on any validation message.
Picture run(const std::string& graph, const Plane& plane, const Settings& settings);
// The same for many frames, whose indices begin at 1; `each` sees every picture.
void run_frames(const std::string& graph, const Plane& plane, const Settings& settings, uint32_t frames,
                const std::function<void(const Picture&)>& each);

// Why tests of this room cannot run here; "" when they can. The answer is found once.
const std::string& missing();

class DeviceTest : public ::testing::Test {
protected:
  void SetUp() override {
    if (!missing().empty()) GTEST_SKIP() << missing();
  }
};

} // namespace properties
