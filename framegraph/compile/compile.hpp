#pragma once
// Graph -> Plan: resolve, choose, cull, order, lifetimes, pack, synchronize; one phase a file.

#include "framegraph/compile/device_profile.hpp"
#include "framegraph/compile/plan.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace dermis {

enum class PassOrder : uint8_t {
  memory,  // depth first where that lowers the most bytes alive at once, else that of the file
  program, // that of the file wherever dependencies allow it
  random   // any legal one, drawn from CompileInput::order_seed: for tests
};

enum class PackingLevel : uint8_t {
  fast,    // one placement, largest first
  tight,   // several orders and a short search: below 20 us a pass
  optimize // search until the lower bound is met or about a second of work is done
};

struct CompileInput {
  const Graph* graph = nullptr;
  const PassTypeRegistry* pass_types = nullptr;
  const DeviceProfile* device = nullptr;
  uint32_t view_width = 0, view_height = 0; // allocated view size, 1 .. device->max_image_dimension
  std::vector<SettingValue> settings;       // one per Graph::settings; empty: the defaults
  std::vector<bool> bound;          // one per Graph::resources: optional imports/exports the host binds;
                                    // empty: all. Required ones count as bound always.
  std::vector<Format> host_formats; // one per Graph::resources: what the host binds there; undefined or
                                    // empty: the first declared format
  bool reasons = true;              // fill CompiledPlan::reasons
  PassOrder order = PassOrder::memory;
  uint64_t order_seed = 0;
  PackingLevel packing = PackingLevel::tight;
  bool alias = true;        // false: no two transients share memory
  bool cull = true;         // false: every pass that is on and has what it needs runs
  bool single_queue = true; // false: passes that are declared `async` may get a queue of their own
  bool poison = false;   // true: the graph's own images and buffers can be filled: see ExecutorInput::poison
  ResourceId keep_alive; // valid: this transient shares memory with nothing
};

// The plan, or nullopt with errors in `diagnostics`. Same input, same bytes, on every compiler.
// Free-threaded.
std::optional<CompiledPlan> compile(const CompileInput& input, Diagnostics& diagnostics);

// The same, reusing memory: after the first few graphs of a size nothing is allocated. One thread at a time.
class Compiler {
public:
  Compiler();
  ~Compiler();
  Compiler(const Compiler&) = delete;
  Compiler& operator=(const Compiler&) = delete;

  // Overwrites `out`, whose memory is reused. False: errors in `diagnostics`, and `out` holds no plan.
  bool compile(const CompileInput& input, Diagnostics& diagnostics, CompiledPlan& out);

private:
  std::unique_ptr<struct CompileScratch> scratch_;
};

// "'hybrid'", "8": the value as a graph file would write it.
std::string setting_text(const SettingDeclaration& setting, const SettingValue& value);

} // namespace dermis
