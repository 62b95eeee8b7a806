#pragma once
// Holds everything that a plan depends on: equal keys have equal plans. The key omits whether
// reasons are collected, because plans do not hold them.

#include "framegraph/compile/compile.hpp"
#include "framegraph/serialize/sha256.hpp"

#include <string>
#include <vector>

namespace dermis {

struct PlanKey {
  Digest graph{}; // of graph_bytes()
  uint32_t view_width = 0, view_height = 0;
  PixelGrid pixel_grid = 0;
  // Device profile. Its name represents its formats and memory requirements: two devices of one
  // name must have equal ones.
  std::string device_profile;
  uint64_t buffer_image_granularity = 1, max_storage_buffer_bytes = 0;
  uint32_t max_image_dimension = 0, max_image_layers = 0, device_local_type_bits = 0;
  uint32_t max_workgroup_count = 0, max_push_constants_bytes = 0;
  Features features = 0;
  std::vector<SettingValue> settings; // one per Graph::settings
  std::vector<uint8_t> bound;         // one per Graph::resources: 1: bound, or not optional
  std::vector<Format> host_formats;   // one per Graph::resources
  PassOrder order = PassOrder::memory;
  uint64_t order_seed = 0; // 0 unless the order is random
  PackingLevel packing = PackingLevel::tight;
  bool alias = true, cull = true, poison = false, single_queue = true;
  ResourceId keep_alive;
};

// Returns the key of the input, with defaults for what the input omits: default settings, all slots
// bound, first formats.
PlanKey plan_key(const CompileInput& input);

// Returns the canonical bytes of everything that the compiler reads from a graph and its pass
// types, without notes and source locations.
std::string graph_bytes(const Graph& graph, const PassTypeRegistry& pass_types);

std::string key_bytes(const PlanKey& key); // equal exactly if the keys are equal

} // namespace dermis
