#pragma once
// Graph -> Plan: resolve, choose, cull, order, lifetimes, pack, synchronize; one phase a file.

#include "framegraph/compile/device_profile.hpp"
#include "framegraph/compile/plan.hpp"

#include <optional>
#include <vector>

namespace dermis {

struct CompileInput {
  const Graph* graph = nullptr;
  const KindRegistry* kinds = nullptr;
  const DeviceProfile* device = nullptr;
  uint32_t view_width = 0, view_height = 0; // allocated view size, 1 .. device->max_image_dimension
  std::vector<SettingValue> settings;       // one per Graph::settings; empty: the defaults
  std::vector<bool> bound;          // one per Graph::resources: optional imports/exports the host binds;
                                    // empty: all. Required ones count as bound always.
  std::vector<Format> host_formats; // one per Graph::resources: what the host binds there; undefined or
                                    // empty: the first declared format
};

// The plan, or nullopt with errors in `diagnostics`. Same input, same bytes, on every compiler.
// Free-threaded.
std::optional<CompiledPlan> compile(const CompileInput& input, Diagnostics& diagnostics);

} // namespace dermis
