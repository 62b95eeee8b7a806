#pragma once
// The engine's only acquaintance with Dermis: a context, a graph, and the targets it is given.

#include "integration/examples/demo_engine/context_hooks.hpp"
#include "integration/examples/demo_engine/engine.hpp"
#include "integration/examples/demo_engine/render/renderer.hpp"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace demo {

struct DermisDesc {
  std::string graph_file;
  std::vector<ScatteringProfile> profiles;
  std::vector<std::pair<std::string, std::string>> settings;
  uint32_t width = 1, height = 1;
  std::vector<NamedText> overlays = {};
  std::function<std::optional<NamedText>(const std::string&name)> include = {}, shaders = {};
  double budget_ms = 0;
  bool deterministic = false;
  NamedText calibration = {};
  bool sampling = false; // bind `sampling`, which costs the graph a write
  bool skips = false;    // the same of `skips`
  ContextHooks hooks = {};
};

struct DermisHost; // opaque: dermis.h stays in dermis_host.cpp
struct DermisHostDeleter {
  void operator()(DermisHost* host) const;
};
using DermisHandle = std::unique_ptr<DermisHost, DermisHostDeleter>;

// The slots of a graph that was built before, so that it need not be built to learn of them.
struct KnownSlots {
  std::string graph; // its text; "": none
  std::vector<std::string> names, unbound;
};

// Reads graph and profile files, builds the graph, names the slots that this engine cannot fill as unbound.
// `known` may be null; of a graph that is one file alone it is read and written. Errors: input (with all
// messages of the report), environment (the device lacks something), internal.
Result<DermisHandle> create_dermis_host(VulkanHost& host, const DermisDesc& desc,
                                        KnownSlots* known = nullptr);

// What the graph adds to each target's usage.
std::array<VkImageUsageFlags, target_count> usage_for_graph(const DermisHost& host);
// In place if the graph writes `lighting`, else apart if it writes `scattered_light`, else none.
Scattering scattering_of(const DermisHost& host);
bool hands_out_light(const DermisHost& host);
bool wants_rays(const DermisHost& host); // buffers and acceleration structures are bound
bool hands_out_sampling(const DermisHost& host);
bool hands_out_skips(const DermisHost& host);
const std::vector<std::string>& warnings_of(const DermisHost& host);

// The graph anew from another text; false: it has errors, and what ran runs on. Errors: environment,
// internal.
Result<bool> reload_graph(DermisHost& host, const std::string& text);

// Records the graph between lighting and composite. All targets rest before and after. frame_index from 1.
// Errors: environment, internal.
Result<> record_graph(DermisHost& host, const Renderer& renderer, const SceneState& state,
                      VkCommandBuffer commands, uint64_t frame_index);
// Device times of the frame; the device must have finished it. Empty where the device has no timestamps.
std::vector<PassTime> graph_times(DermisHost& host, uint64_t frame_index);
// What was chosen for the frame; the device must have finished it. Errors: internal.
Result<FrameChoice> graph_choice(DermisHost& host, uint64_t frame_index);
// What its histories hold now.
Result<std::vector<FrameHistory>> graph_histories(DermisHost& host);
// What the graph learned of the device's times, as JSON.
std::string graph_calibration(DermisHost& host);

} // namespace demo
