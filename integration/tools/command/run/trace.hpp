#pragma once
// Frames as a Chrome trace: what the device and the host's thread did, and what was chosen, over time.

#include "integration/examples/demo_engine/engine.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

// Tracks: the device's queue (passes, one behind the other) and the host's thread (frames, and the phases in
// them). Durations are measured on either side; the device's passes are put behind the moment at which they
// were submitted, since their clock has no beginning in common with the host's.
class Trace {
public:
  void add(const demo::FrameOutputs& frame);
  // The whole document, times in microseconds.
  std::string json(const std::string& command, const std::string& device) const;

private:
  struct Span {
    bool on_device;
    std::string name;
    double begin_ms, duration_ms;
    uint32_t frame;
  };
  struct Chosen {
    double at_ms;
    uint32_t frame;
    demo::FrameChoice choice;
  };
  std::vector<Span> spans_;
  std::vector<Chosen> chosen_;
  double device_free_ms_ = 0; // from when on the device's track is free
};

} // namespace dermis::tools
