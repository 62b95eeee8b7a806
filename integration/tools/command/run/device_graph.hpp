#pragma once
// A graph on a device through the C interface alone: images for its slots, frames run one at a time and
// waited for.

#include "framegraph/compose/compose.hpp"
#include "integration/examples/demo_engine/context_hooks.hpp"
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

struct DeviceGraphRequest {
  std::string graph_name, graph_text;                        // file name for messages, JSON
  std::vector<std::pair<std::string, std::string>> overlays; // the same
  OpenFile open;                                             // what graph and overlays include
  uint32_t width = 0, height = 0;                            // allocated size, pixels
  struct Profile {
    uint32_t id = 0;
    std::string name, text; // for messages, JSON
    bool operator==(const Profile&) const = default;
  };
  std::vector<Profile> profiles;
  std::vector<std::pair<std::string, VkFormat>> formats;     // of slots
  std::vector<std::string> unbound;                          // optional slots
  std::vector<std::pair<std::string, std::string>> settings; // name, JSON text
  demo::ContextHooks hooks = {}; // of the first graph's context, and of each frame
};
// Do both differ in size at most?
bool same_but_size(const DeviceGraphRequest& a, const DeviceGraphRequest& b);

// Owns a graph, in the context of all graphs of the host, and one image a bound slot; all die before the
// host. One thread.
class DeviceGraph {
public:
  // Errors: input (the graph; the text holds all messages), environment, internal.
  static demo::Result<std::unique_ptr<DeviceGraph>> create(demo::VulkanHost& host,
                                                           const DeviceGraphRequest& request);
  ~DeviceGraph();
  DeviceGraph(const DeviceGraph&) = delete;
  DeviceGraph& operator=(const DeviceGraph&) = delete;

  // Another allocated size; histories go on where the graph says so. What images held is lost. Errors: as
  // create; the graph is then of no use.
  demo::Result<> resize(uint32_t width, uint32_t height);

  bool has(std::string_view slot) const; // bound
  // Fills the image of a slot; missing channels are 0, alpha 1. Slots that are not bound are ignored.
  demo::Result<> upload(std::string_view slot, std::span<const float> texels, uint32_t channels);
  // Three floats a texel of an image with at least three channels.
  demo::Result<std::vector<float>> read_rgb(std::string_view slot);
  // The next frame has this number, if it is higher than the one that would follow.
  void skip_to(uint64_t frame_index) {
    frame_index_ = std::max(frame_index_, frame_index > 0 ? frame_index - 1 : 0);
  }
  // Runs one frame and waits. Command buffer, bindings and frame numbers are filled in here.
  demo::Result<> run(dermis_frame frame);

  struct PassTime {
    std::string pass;
    double milliseconds = 0.0;
  };
  // Of the last frame, in plan order; empty if the device has no timestamps.
  std::vector<PassTime> times();
  dermis_memory memory();
  // Of the last frame; its strings live as long as the graph. nullopt: nothing was counted.
  std::optional<dermis_choice> choice();

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
  std::shared_ptr<dermis_context_t> context_; // the host's, which its graphs share
  dermis_graph graph_ = nullptr;
  std::vector<Slot> slots_;
  std::function<demo::Result<>()> recorded_; // asked after each recorded frame, if not empty
  uint64_t frame_index_ = 0;
};

} // namespace dermis::tools
