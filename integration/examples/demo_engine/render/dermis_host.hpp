#pragma once
// The engine's only interface to Dermis: a context, a graph, and the bound targets.

#include "integration/examples/demo_engine/context_hooks.hpp"
#include "integration/examples/demo_engine/engine.hpp"
#include "integration/examples/demo_engine/render/renderer.hpp"

#include <array>
#include <memory>
#include <string>
#include <vector>

struct dermis_graph_t; // of dermis.h

namespace demo {

struct DermisDesc {
  std::string graph_file, graph_text; // text "": that of the file
  std::vector<ScatteringProfile> profiles;
  std::vector<std::pair<std::string, std::string>> settings;
  uint32_t width = 1, height = 1;
  double pixel_aspect = 1; // width / height of a pixel
  std::vector<NamedText> overlays = {};
  std::function<std::optional<NamedText>(const std::string&name)> include = {}, shaders = {};
  Budget budget = {};
  bool sampling = false;   // binds `sampling`, which adds a write to the graph
  bool tile_class = false; // binds `tile_class`
  ContextHooks hooks = {};
  std::vector<std::string> unbound = {}; // optional slots that are not bound
};

struct DermisHost; // opaque: only dermis_host.cpp and dermis_reports.cpp include dermis.h
struct DermisHostDeleter {
  void operator()(DermisHost* host) const;
};
using DermisHandle = std::unique_ptr<DermisHost, DermisHostDeleter>;

// Cache of a graph's slots. Slots that this engine has no image for must be declared as unbound,
// and finding them takes a build of the graph; with the cache one build is enough.
struct KnownSlots {
  std::string graph; // text of the graph; "": none
  std::vector<std::string> names, unbound;
};

// Reads graph and profile files, and builds the graph. Declares as unbound the slots that this
// engine has no image for. `known` may be null; it is ignored if the graph includes files or has
// overlays. Errors: input (the message lists all diagnostics), environment (the device lacks a
// required feature), internal.
Result<DermisHandle> create_dermis_host(VulkanHost& host, const DermisDesc& desc,
                                        KnownSlots* known = nullptr);

// Returns the usage that the graph adds to each target.
std::array<VkImageUsageFlags, target_count> usage_for_graph(const DermisHost& host);
// Returns in_place if the graph writes `lighting`, else apart if it writes `scattered_light`, else
// none.
Scattering scattering_of(const DermisHost& host);
bool exports_light(const DermisHost& host);
bool uses_rays(const DermisHost& host); // buffers and acceleration structures are bound
bool exports_sampling(const DermisHost& host);
bool exports_tile_class(const DermisHost& host);
const std::vector<std::string>& warnings_of(const DermisHost& host);

// Reloads the graph from another text. Returns false if the text has errors; the present graph then
// continues. Errors: environment, internal.
Result<bool> reload_graph(DermisHost& host, const std::string& text);

// Records the graph between lighting and composite. All targets are in the resting state before and
// after. frame_index starts at 1. Errors: environment, internal.
Result<> record_graph(DermisHost& host, const Renderer& renderer, const SceneState& state,
                      VkCommandBuffer commands, uint64_t frame_index);
dermis_graph_t* graph_of(const DermisHost& host); // valid as long as the host
// Returns the device times of the frame, which the device must have finished. Empty if the device
// has no timestamps.
std::vector<PassTime> graph_times(DermisHost& host, uint64_t frame_index);
// Returns the choice for the frame, which the device must have finished. Errors: internal.
Result<FrameChoice> graph_choice(DermisHost& host, uint64_t frame_index);
// Returns what each configuration is expected to take in a frame like the newest one.
Result<std::vector<FrameOutcome>> graph_frontier(DermisHost& host);
// Returns the present state of the graph's histories.
Result<std::vector<FrameHistory>> graph_histories(DermisHost& host);
// Returns the learned costs of the device, as JSON.
std::string graph_calibration(DermisHost& host);

} // namespace demo
