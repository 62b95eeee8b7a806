#pragma once
// Heads in perspective, in colour: the scanned head and the sculpted bust in three framings, and errors there
// by kind of pixel. Definitions of the framings, of edges and of what is sure: shared with the notes that the
// acceptance numbers come from.

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
  bool scan; // the scanned head, else the bust
  demo::CameraPlace camera;
};
// 36 mm, 120 mm and 960 mm from top to bottom, at the scan's nose, ear and whole head.
std::vector<HeadFraming> head_framings();

// RMS of luminance errors, in units of the exposed scene's light.
struct HeadErrors {
  double rmse = 0;
  double edge = 0, edge_p99 = 0; // pixels near a depth step or another material
  double inner = 0;              // all others
  double sure = 0;               // pixels with a confidence of .9 or more; 0 without confidence
  double unsure_pixels = 0;      // share of the others
};

class HeadTest : public DeviceTest {
protected:
  // Skips where the scan's file is not there. `most`: pixels compared.
  void show(const HeadFraming& framing, uint32_t width, uint32_t height, uint32_t maximum);
  HeadErrors errors_of(const std::vector<float>& light, const std::vector<float>* confidence = nullptr) const;
  double luminance_at(const std::vector<float>& light, size_t pixel) const;
  // Runs a shipped graph on the device, under validation: the last of so many frames of a head that rests.
  // `samples`: those of that frame, a subsurface pixel.
  std::vector<float> scatter(const std::string& graph, const std::vector<dermis::tools::NamedValue>& set = {},
                             uint32_t frames = 1, double* samples = nullptr);
  // The pyramid's CPU twin.
  static dermis::subsurface::SapResult<float> cpu_kernel(const dermis::tools::CapturedFrame& frame,
                                                         dermis::subsurface::SapVariant variant,
                                                         uint32_t first_layered = 2);

  void TearDown() override; // fails on validation messages

  dermis::tools::CapturedFrame frame_;
  dermis::tools::Reference reference_;
  std::vector<bool> edge_; // by pixel
  std::string overlay_;    // of configs/overlays/, without .json, for scatter(); "": none

private:
  void close_host();

  std::unique_ptr<demo::VulkanHost> host_;
};

} // namespace properties
