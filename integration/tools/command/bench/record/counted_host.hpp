#pragma once
// A host that measures the library itself: runs a graph through the C interface on a device that
// executes nothing.

#include "integration/examples/demo_engine/context_hooks.hpp"
#include "integration/tools/null_device/null_device.hpp"

#include <dermis/dermis.h>

#include <string>
#include <vector>

namespace dermis::tools {

struct CountedInput {
  std::string name, graph; // name for messages, JSON text
  std::string profile_name, profile;
  uint32_t width = 0, height = 0;
  float budget_ms = 0; // 0: none
  demo::ContextHooks hooks = {};
};

// One thread at a time.
class CountedHost {
public:
  CountedHost() = default;
  ~CountedHost();
  CountedHost(const CountedHost&) = delete;
  CountedHost& operator=(const CountedHost&) = delete;

  // Binds every image that the graph can use, but no buffers or scenes. Returns the problem, or "".
  std::string open(const CountedInput& input);
  // Records the next frame. Images alternate between two sets, as in hosts with two frames in
  // flight.
  dermis_result record_frame();

  NullDevice& device() { return device_; }
  dermis_graph graph() const { return graph_; }
  // Returns whether a budget chooses settings of the graph.
  bool chooses() const;
  // Returns the number of passes of the plan.
  uint32_t passes() const;

private:
  static constexpr uint32_t image_sets = 2;
  std::string create(const dermis_graph_desc& desc);
  std::vector<dermis_slot> slots() const; // empty on failure; dermis_last_error() has the reason
  std::string bind();

  NullDevice device_;
  dermis_context context_ = nullptr;
  dermis_graph graph_ = nullptr;
  std::vector<dermis_image_binding> bindings_[image_sets];
  uint64_t last_image_ = 0; // dermis_image_binding.content_id
  dermis_frame frame_ = DERMIS_FRAME_INIT;
};

} // namespace dermis::tools
