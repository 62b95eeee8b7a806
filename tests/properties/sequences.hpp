#pragma once
// Frames of shipped scenes through shipped graphs, one after the other, on the device, and how far their
// light is from the truth. For tests of what goes on from frame to frame.

#include "tests/properties/plane.hpp"

#include "integration/tools/command/bench/dynamic/sequence.hpp"
#include "integration/tools/command/bench/technique.hpp"

#include <functional>
#include <map>
#include <memory>

namespace properties {

inline constexpr uint32_t sequence_width = 240, sequence_height = 136; // pixels
inline constexpr double close_d_px = 4;

std::string root(); // of the source tree
// A shipped graph by its name.
dermis::tools::TechniqueRequest request_of(const std::string& graph,
                                           const std::vector<dermis::tools::NamedValue>& set = {});

using Frames = std::vector<uint32_t>;
Frames range(uint32_t first, uint32_t end);

struct SequenceRun {
  std::map<uint32_t, double> psnr_db;              // of the frames asked for
  double mean_psnr_db = 0;                         // of their mean square error
  std::map<uint32_t, std::vector<float>> pictures; // of the frames asked for, 3 values a pixel
  std::map<uint32_t, std::vector<float>> sampling; // likewise: samples, those behind history, confidence
  std::vector<double> samples; // a subsurface pixel, each frame; NaN of frames that were left out
  uint64_t history_bytes = 0;
};

// Truths are shared by the techniques of a test.
struct Judge {
  const dermis::tools::Sequence& sequence;
  std::map<uint32_t, dermis::tools::Reference> references = {};
  const dermis::tools::Reference& at(uint32_t frame);
};

// Whether a frame goes on where the one before ended; none: as the scene says.
using Follows = std::function<bool(uint32_t frame)>;

// Repeats one frame, as a host does whose scene stands still.
dermis::tools::Sequence standing_still(dermis::tools::Sequence sequence, uint32_t count);

// Validation messages fail the test. Of a graph without histories frames run that are judged, and the first;
// all of them where none is judged.
class SequenceTest : public DeviceTest {
protected:
  void TearDown() override;
  static dermis::tools::Sequence frames_of(const std::string& scene, uint32_t first, uint32_t count);
  SequenceRun run(Judge& judge, const dermis::tools::TechniqueRequest& request, const Frames& judged,
                  const Follows& follows = {});

  std::unique_ptr<demo::VulkanHost> host_;
};

} // namespace properties
