#pragma once
// Everything that a plan depends on, as a value: two equal keys have equal plans. Whether reasons are
// collected is no part of it; plans do not hold them.

#include "framegraph/compile/compile.hpp"
#include "framegraph/serial/sha256.hpp"

#include <string>
#include <vector>

namespace dermis {

struct PlanKey {
  Digest graph{}; // of graph_bytes()
  uint32_t view_width = 0, view_height = 0;
  // The device profile: its name stands for what it says of formats and memory.
  std::string device_profile;
  uint64_t buffer_image_granularity = 1, max_storage_buffer_bytes = 0;
  uint32_t max_image_dimension = 0, max_image_layers = 0, device_local_type_bits = 0;
  uint32_t max_workgroup_count = 0, max_push_constants_bytes = 0;
  Features features = 0;
  std::vector<SettingValue> settings; // one per Graph::settings
  std::vector<uint8_t> bound;         // one per Graph::resources: 1 bound, or not optional
  std::vector<Format> host_formats;   // one per Graph::resources
  PassOrder order = PassOrder::memory;
  uint64_t order_seed = 0; // 0 unless the order is drawn
  PackingLevel packing = PackingLevel::tight;
  bool alias = true, cull = true, poison = false, single_queue = true;
  ResourceId keep_alive;
};

// What the input says, with what it leaves out filled in: settings at their defaults, all slots bound, first
// formats.
PlanKey plan_key(const CompileInput& input);

// Canonical bytes of what compiling reads of a graph and of the pass types it uses: neither notes nor places
// in files.
std::string graph_bytes(const Graph& graph, const PassTypeRegistry& pass_types);

std::string key_bytes(const PlanKey& key); // equal exactly where the keys are

} // namespace dermis
