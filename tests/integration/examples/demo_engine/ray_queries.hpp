#pragma once
// Renderings on a driver with ray queries, which tests/scripts/fetch_driver.sh stores in
// build/drivers. Without the driver these tests are skipped.

#include "tests/integration/examples/demo_engine/rendering.hpp"
#include "tests/support/fetched_driver.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>

namespace demo {

inline const std::string source = DERMIS_SOURCE_DIR;

// The loader reads the variable whenever an instance is created.
struct WithRayQueries : ::testing::Test {
  void SetUp() override {
    if (const char* own = std::getenv("VK_DRIVER_FILES")) before = own;
    const std::string driver = dermis::testing::driver_with_ray_queries();
    if (driver.empty())
      GTEST_SKIP() << "no driver in build/drivers: run tests/scripts/fetch_driver.sh";
    setenv("VK_DRIVER_FILES", driver.c_str(), 1);
  }
  void TearDown() override {
    if (before)
      setenv("VK_DRIVER_FILES", before->c_str(), 1);
    else
      unsetenv("VK_DRIVER_FILES");
  }

  std::optional<std::string> before; // The variable's value for the suite's own driver.
};

inline RenderOptions by_rays(const std::string& scene, uint32_t side, uint32_t frames,
                             std::vector<std::pair<std::string, std::string>> settings) {
  RenderOptions options;
  options.scene = scene;
  options.roots = {source + "/configs"};
  options.graph = source + "/configs/graphs/papers/restir.json";
  options.width = options.height = side;
  options.frames = frames;
  options.validation = true;
  options.settings = std::move(settings);
  return options;
}

inline bool ran(const FrameOutputs& frame, const std::string& pass) {
  return std::any_of(frame.dermis_times.begin(), frame.dermis_times.end(),
                     [&](const PassTime& time) { return time.pass == pass; });
}

inline double luminance(const FloatImage& image, size_t pixel) {
  const float* rgb = image.texels.data() + pixel * image.channels;
  return 0.2126 * double(rgb[0]) + 0.7152 * double(rgb[1]) + 0.0722 * double(rgb[2]);
}

} // namespace demo
