#pragma once
// Runs frames of shipped scenes through shipped graphs in order, on the device, and measures the
// error of their light. For tests of behaviour across frames.

#include "tests/properties/plane.hpp"

#include "integration/tools/command/bench/dynamic/sequence.hpp"
#include "integration/tools/command/bench/technique.hpp"

#include <functional>
#include <map>
#include <memory>

namespace properties {

// Pixels. The larger size is for effects that are few pixels wide. What comments of the tests call
// measured was measured at the larger size.
inline constexpr uint32_t sequence_width = 160, sequence_height = 90;
inline constexpr uint32_t larger_width = 240, larger_height = 136;
inline constexpr double close_d_px = 4;

std::string root(); // Returns the root of the source tree.
// Returns the request for a shipped graph by name.
dermis::tools::TechniqueRequest request_of(const std::string& graph,
                                           const std::vector<dermis::tools::NamedValue>& set = {});

using Frames = std::vector<uint32_t>;
Frames range(uint32_t first, uint32_t end);

struct SequenceRun {
  std::map<uint32_t, double> psnr_db;              // For the requested frames.
  double mean_psnr_db = 0;                         // PSNR of the frames' mean square error.
  std::map<uint32_t, std::vector<float>> pictures; // For the requested frames, 3 values per pixel.
  // For the requested frames: samples, samples behind the history, confidence.
  std::map<uint32_t, std::vector<float>> sampling;
  std::vector<double> samples; // Samples per subsurface pixel and frame; NaN for skipped frames.
  uint64_t history_bytes = 0;
};

// The techniques of a test share the references.
struct Judge {
  const dermis::tools::Sequence& sequence;
  std::map<uint32_t, dermis::tools::Reference> references = {};
  const dermis::tools::Reference& at(uint32_t frame);
};

// Returns whether a frame continues the previous frame; empty: as the scene states.
using Follows = std::function<bool(uint32_t frame)>;

// Repeats one frame, like a host with a static scene.
dermis::tools::Sequence standing_still(dermis::tools::Sequence sequence, uint32_t count);

// Validation messages fail the test. A graph without histories only runs the first frame and the
// compared frames, or all frames if none is compared.
class SequenceTest : public DeviceTest {
protected:
  static dermis::tools::Sequence frames_of(const std::string& scene, uint32_t first, uint32_t count,
                                           uint32_t width = sequence_width,
                                           uint32_t height = sequence_height);
  SequenceRun run(Judge& judge, const dermis::tools::TechniqueRequest& request,
                  const Frames& judged, const Follows& follows = {});
};

} // namespace properties
