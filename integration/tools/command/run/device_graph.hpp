#pragma once
// A graph on a device, used only through the C interface: creates images for its slots, runs one
// frame at a time and waits.

#include "integration/examples/demo_engine/dermis_calls.hpp"
#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "integration/examples/demo_engine/vulkan_image.hpp"

#include <dermis/dermis.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

struct DeviceGraphRequest : demo::GraphRequest {
  std::vector<std::pair<std::string, std::string>> settings; // name, JSON text
  demo::ContextHooks hooks = {}; // for the first graph's context and for each frame
};
// Returns whether the requests are equal or differ only in size.
bool same_but_size(const DeviceGraphRequest& a, const DeviceGraphRequest& b);

// Owns a graph, in the context shared by all graphs of the host, and one image per bound slot.
// Destroy before the host. One thread.
class DeviceGraph {
public:
  // Errors: input (the graph; the text holds all messages), environment, internal.
  static demo::Result<std::unique_ptr<DeviceGraph>> create(demo::VulkanHost& host,
                                                           const DeviceGraphRequest& request);
  ~DeviceGraph();
  DeviceGraph(const DeviceGraph&) = delete;
  DeviceGraph& operator=(const DeviceGraph&) = delete;

  // Changes the allocated size. Histories continue if the graph declares so; contents of images are
  // lost. Errors: as create; the graph is unusable after an error.
  demo::Result<> resize(uint32_t width, uint32_t height);

  // Sets the budget of the next frames. Errors: input (the calibration or the error table).
  demo::Result<> set_budget(const dermis_budget& budget);

  bool has(std::string_view slot) const; // whether the slot is bound
  // Fills the image of a slot; missing channels are 0, alpha 1. Unbound slots are ignored.
  demo::Result<> upload(std::string_view slot, std::span<const float> texels, uint32_t channels);
  // Reads three floats per texel of an image with at least three channels.
  demo::Result<std::vector<float>> read_rgb(std::string_view slot);
  // Sets the number of the next frame if it is higher than the regular next number.
  void skip_to(uint64_t frame_index) {
    frame_index_ = std::max(frame_index_, frame_index > 0 ? frame_index - 1 : 0);
  }
  // Runs one frame and waits. Fills in command buffer, bindings and frame numbers.
  demo::Result<> run(dermis_frame frame);

  struct PassTime {
    std::string pass;
    double milliseconds = 0.0;
  };
  // Returns the times of the last frame in plan order. Empty if the device has no timestamps.
  std::vector<PassTime> times();
  dermis_memory memory();
  // Returns the choice of the last frame, whose strings live as long as the graph. Returns nullopt
  // if nothing was counted.
  std::optional<demo::ReportedFrame> choice();

private:
  struct Slot {
    dermis_slot slot = DERMIS_SLOT_INIT;
    std::string name;
    demo::Image image;
    demo::ImageState state;
  };
  explicit DeviceGraph(demo::VulkanHost& host) : host_(host) {}
  demo::Result<> create_images();
  Slot* find(std::string_view name);

  demo::VulkanHost& host_;
  std::shared_ptr<dermis_context_t> context_; // shared by all graphs of the host
  dermis_graph graph_ = nullptr;
  std::vector<Slot> slots_;
  std::function<demo::Result<>()> recorded_; // called after each recorded frame, if set
  uint64_t frame_index_ = 0;
};

} // namespace dermis::tools
