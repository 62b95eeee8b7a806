#pragma once
// Heads in perspective, in colour: the scanned head and the sculpted bust in three framings, and
// errors by kind of pixel.

#include "tests/properties/plane.hpp"

#include "integration/tools/command/bench/reference.hpp"
#include "integration/tools/command/bench/technique.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "tests/passes/sap/cpu/sap_cpu.hpp"

#include <memory>
#include <optional>

namespace properties {

struct HeadFraming {
  const char* name;
  bool scan; // True: the scanned head; false: the bust.
  demo::CameraPlace camera;
};
// Returns framings of 36 mm, 120 mm and 960 mm height, at the scan's nose, ear and whole head.
std::vector<HeadFraming> head_framings();

// RMS of luminance errors, in units of the exposed scene's light.
struct HeadErrors {
  double rmse = 0;
  double edge = 0, edge_p99 = 0; // Pixels near a depth step or another material.
  double inner = 0;              // All other pixels.
  double sure = 0;               // Pixels with a confidence of 0.95 or more; 0 without confidence.
  double unsure_pixels = 0;      // Fraction of the other pixels.
};

class HeadTest : public DeviceTest {
protected:
  // Skips the test if the scan's file does not exist. `maximum` limits the compared pixels.
  void show(const HeadFraming& framing, uint32_t width, uint32_t height, uint32_t maximum);
  HeadErrors errors_of(const std::vector<float>& light,
                       const std::vector<float>* confidence = nullptr) const;
  double luminance_at(const std::vector<float>& light, size_t pixel) const;
  // Runs a shipped graph on the device, under validation, and returns the last of `frames` frames
  // of a head at rest. `samples` receives that frame's samples per subsurface pixel.
  std::vector<float> scatter(const std::string& graph,
                             const std::vector<dermis::tools::NamedValue>& set = {},
                             uint32_t frames = 1, double* samples = nullptr);
  // Runs the pyramid's CPU implementation.
  static dermis::subsurface::SapResult<float> cpu_kernel(const dermis::tools::CapturedFrame& frame,
                                                         dermis::subsurface::SapVariant variant,
                                                         uint32_t first_layered = 1);

  dermis::tools::CapturedFrame frame_;
  dermis::tools::Reference reference_;
  std::vector<bool> edge_; // By pixel.
  std::string overlay_;    // Name in configs/overlays/ without .json, for scatter(); "" means none.
};

} // namespace properties
