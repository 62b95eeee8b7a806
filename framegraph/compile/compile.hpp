#pragma once
// Compiles a graph into a plan. compile.cpp lists the phases.

#include "framegraph/compile/device_profile.hpp"
#include "framegraph/compile/plan.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace dermis {

enum class PassOrder : uint8_t {
  memory,  // depth first if that lowers the maximum of bytes live at once, else as program
  program, // the order of the file wherever dependencies allow it
  random   // any legal order, randomly generated from CompileInput::order_seed: for tests
};

enum class PackingLevel : uint8_t {
  fast,    // one placement, largest first
  tight,   // several orders and a short search: below 20 us per pass
  optimize // search until the lower bound is met or about a second of work is done
};

struct CompileInput {
  const Graph* graph = nullptr;
  const PassTypeRegistry* pass_types = nullptr;
  const DeviceProfile* device = nullptr;
  uint32_t view_width = 0, view_height = 0; // allocated view size, 1 .. device->max_image_dimension
  PixelGrid pixel_grid = 0;                 // of the pixels of the view
  std::vector<SettingValue> settings;       // one per Graph::settings; empty: the defaults
  // One per Graph::resources: whether the host binds the optional import or export. Empty: all are
  // bound. Required slots always count as bound.
  std::vector<bool> bound;
  // One per Graph::resources: the format that the host binds. Undefined or empty: the first
  // declared format.
  std::vector<Format> host_formats;
  bool reasons = true; // fill CompiledPlan::reasons
  PassOrder order = PassOrder::memory;
  uint64_t order_seed = 0;
  PackingLevel packing = PackingLevel::tight;
  bool alias = true;        // false: no two transients share memory
  bool cull = true;         // false: every pass that is on and has what it needs runs
  bool single_queue = true; // false: passes that are declared `async` may run on the async queue
  bool poison =
      false; // true: the graph's own resources can be debug-filled: see ExecutorInput::poison
  ResourceId keep_alive; // valid: this transient shares memory with nothing
};

// Returns the plan, or nullopt with errors in `diagnostics`. The same input gives the same bytes
// with every compiler. Free-threaded.
std::optional<CompiledPlan> compile(const CompileInput& input, Diagnostics& diagnostics);

// Compiles and reuses memory: after the first few graphs of a size nothing is allocated. One thread
// at a time.
class Compiler {
public:
  Compiler();
  ~Compiler();
  Compiler(const Compiler&) = delete;
  Compiler& operator=(const Compiler&) = delete;

  // Overwrites `out` and reuses its memory. Returns false if there are errors in `diagnostics`;
  // `out` then holds no plan.
  bool compile(const CompileInput& input, Diagnostics& diagnostics, CompiledPlan& out);

private:
  std::unique_ptr<struct CompileScratch> scratch_;
};

// Returns the value as a graph file writes it: "'hybrid'", "8".
std::string setting_text(const SettingDeclaration& setting, const SettingValue& value);

} // namespace dermis
