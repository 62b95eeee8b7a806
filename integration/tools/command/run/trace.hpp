#pragma once
// Writes frames as a Chrome trace: device passes, host phases and choices over time.

#include "integration/examples/demo_engine/engine.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

// Tracks are the device's queue (passes in sequence) and the host's thread (frames and their
// phases). Durations are measured on each side. Device passes are placed after their submission
// time, since the device's clock has no common origin with the host's.
class Trace {
public:
  void add(const demo::FrameOutputs& frame);
  // Returns the whole document, times in microseconds.
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
  double device_free_ms_ = 0; // time from which the device's track is free
};

} // namespace dermis::tools
