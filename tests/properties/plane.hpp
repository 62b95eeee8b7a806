#pragma once
// Runs a shipped graph on the device, on a plane that faces the camera, for which closed forms
// exist.

#include "integration/examples/demo_engine/vulkan_host.hpp"

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
  double pixel_pitch_m = 1e-3; // Geometric mean of a pixel's width and height.
  double pixel_aspect = 1;     // Width / height of a pixel, also for the plan.
  // False: the camera is orthographic. True: it is 1 m above the plane at a depth of 1 m, on which
  // the pixels have their pitch.
  bool perspective = false;
  std::array<double, 3> d_px = {4, 4, 4}; // d of profile 1 in pixels; profile 2 has the same d.
  std::function<float(double x, double y)> light = [](double, double) {
    return 1.0f;
  }; // Pixel centres are integers.
  std::function<uint8_t(int x, int y)> profile = [](int, int) { return uint8_t{1}; };
  // Profile of all frames except the last; empty: equal to `profile`.
  std::function<uint8_t(int x, int y)> earlier_profile = {};
  std::function<float(int x, int y)> depth_m = [](int, int) { return 1.0f; };
  std::function<float(int x, int y)> scatter_scale = {}; // Empty: not bound.
  // Rectangle of the allocated size; width 0: all of it.
  std::array<uint32_t, 4> rectangle = {0, 0, 0, 0};
  // Empty: neither thickness nor back lighting is bound. Back lighting is 1.
  std::function<float(int x, int y)> thickness_m = {};
  uint32_t frame_step = 1;  // Difference of the indices of two frames.
  uint32_t cut_frame = 0;   // Number, from 1, of the frame that resets histories; 0: none.
  std::string overlay = {}; // Name in configs/overlays/ without .json; "": none.
  // Text of a profile for both ids, in place of d_px; "": Burley with d_px.
  std::string profile_file = {};
  demo::KernelShape kernels = demo::KernelShape::by_device;
};

struct Picture {
  uint32_t width = 0, height = 0;
  std::vector<float> rgb;

  double at(uint32_t x, uint32_t y, uint32_t c) const {
    return rgb[3 * (size_t{y} * width + x) + c];
  }
};

using Settings = std::vector<std::pair<std::string, std::string>>; // Name, JSON text.

// Runs configs/graphs/<graph>.json under the validation layer and returns `scattered_light`. Fails
// the test on any error and on any validation message.
Picture run(const std::string& graph, const Plane& plane, const Settings& settings);
// Runs many frames, whose indices begin at 1; calls `each` with every picture.
void run_frames(const std::string& graph, const Plane& plane, const Settings& settings,
                uint32_t frames, const std::function<void(const Picture&)>& each);

// Returns the program's host with these kernels, whose context keeps compiled kernels: drivers on
// the CPU take seconds to compile them. Throws if there is no device.
demo::VulkanHost& shared_host(demo::KernelShape kernels = demo::KernelShape::by_device);
// Fails the test for each validation message of these hosts since the last call.
void report_messages();

// Returns why tests of this folder cannot run here, or "" if they can. The result is cached.
const std::string& missing();

// Validation messages fail the test.
class DeviceTest : public ::testing::Test {
protected:
  void SetUp() override {
    if (!missing().empty()) GTEST_SKIP() << missing();
  }
  void TearDown() override { report_messages(); }
};

} // namespace properties
