#include "framegraph/serialize/plan_key.hpp"

#include "framegraph/serialize/plan_fields.hpp"

namespace dermis {

PlanKey plan_key(const CompileInput& input) {
  const Graph& graph = *input.graph;
  const DeviceProfile& device = *input.device;
  PlanKey key;
  key.graph = sha256(graph_bytes(graph, *input.pass_types));
  key.view_width = input.view_width;
  key.view_height = input.view_height;
  key.pixel_grid = input.pixel_grid;
  key.device_profile = device.name;
  key.buffer_image_granularity = device.buffer_image_granularity;
  key.max_storage_buffer_bytes = device.max_storage_buffer_bytes;
  key.max_image_dimension = device.max_image_dimension;
  key.max_image_layers = device.max_image_layers;
  key.device_local_type_bits = device.device_local_type_bits;
  key.max_workgroup_count = device.max_workgroup_count;
  key.max_push_constants_bytes = device.max_push_constants_bytes;
  key.features = device.features;
  key.settings = input.settings;
  if (key.settings.empty())
    for (const SettingDeclaration& setting : graph.settings)
      key.settings.push_back(setting.default_value);
  for (size_t r = 0; r < graph.resources.size(); ++r)
    key.bound.push_back(!graph.resources[r].optional || r >= input.bound.size() || input.bound[r]);
  key.host_formats = input.host_formats;
  key.host_formats.resize(graph.resources.size(), Format::undefined);
  key.order = input.order;
  key.order_seed = input.order == PassOrder::random ? input.order_seed : 0;
  key.packing = input.packing;
  key.alias = input.alias;
  key.cull = input.cull;
  key.poison = input.poison;
  key.single_queue = input.single_queue;
  key.keep_alive = input.keep_alive;
  return key;
}

std::string key_bytes(const PlanKey& key) {
  serial::Writer writer;
  serial::fields(writer, key);
  return std::move(writer).finish();
}

} // namespace dermis
