#pragma once
// Holds a compiled graph, ready to record. It is built next to the running one, which it then
// replaces.

#include "framegraph/compile/compile.hpp"
#include "framegraph/compose/compose.hpp"
#include "framegraph/serialize/plan_cache.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "framegraph/vulkan/heap_pool.hpp"
#include "integration/abi/context.hpp"
#include "integration/abi/left_out.hpp"
#include "integration/abi/shaders/runtime_shaders.hpp"
#include "passes/choice/configurations.hpp"
#include "passes/choice/time_margin.hpp"
#include "passes/common/kernel_tables.hpp"

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dermis::abi {

struct HostFormat {
  std::string slot;
  Format format = Format::undefined;
};

struct HostSetting {
  std::string name;
  std::string json; // as given by the host, to be carried over a reload
};

struct SourceText {
  std::string name, text;
};

// Input of a compiled graph; copied from the host and kept for reload and resize.
struct CompiledGraphInput {
  std::string source_name, source_text;
  std::vector<SourceText> overlays;
  dermis_include_fn include = nullptr;
  void* include_user = nullptr;
  // files that `include` delivered; requested again at a reload
  std::map<std::string, SourceText, std::less<>> included;
  uint32_t width = 0, height = 0;
  uint64_t max_bytes = 0; // memory budget of a view; 0: none
  PixelGrid pixel_grid = 0;
  std::vector<subsurface::NumberedProfile> profiles;
  std::vector<std::string> unbound;
  std::vector<HostFormat> formats;
  std::vector<HostSetting> settings;
  RuntimeShaders shaders;
  // of `profiles`, for the last compiled graph; may be null
  std::shared_ptr<const subsurface::KernelTables> tables;
  // `tables` in device memory, shared by all views; may be null
  std::shared_ptr<const vulkan::EnvironmentTables> device_tables;
};

// An import or export as the host sees it; `id` is its position in CompiledGraph::slots.
struct Slot {
  std::string name;
  ResourceId resource;
  ResourceType type = ResourceType::image;
  uint32_t stride = 0; // buffers: bytes per element
  uint64_t bytes = 0;  // buffers: minimum size of a binding
  bool required = false, read = false, written = false;
  bool in_plan = false; // the plan expects a binding
  Format format = Format::undefined;
  uint32_t vk_usage = 0;
  Layout first_layout = Layout::undefined;
  uint32_t width = 0, height = 0;
};

inline constexpr uint32_t no_plan = 0xffffffffu;

// One plan of the graph and its executor.
struct RunnablePlan {
  std::shared_ptr<const CompiledPlan> compiled; // shared by all views
  std::unique_ptr<vulkan::Executor> executor;
  bool recorded = false; // at least once
  // For frames with empty bounds: the plan that runs instead, as an index into
  // CompiledGraph::plans, or no_plan; and by plan pass whether the pass of this plan is left out.
  uint32_t without_bounds = no_plan;
  std::vector<uint8_t> left_out{};
  // by plan pass; only for plans of frames with empty bounds, others use Configuration::passes
  std::vector<choice::PassLoad> loads{};
  bool counts_tiles = false; // a pass counts the tiles that scatter; set by adopt()
};

// Holds the compiled graph of one view. Views of one graph share compiled plans and pipelines;
// everything else is per view.
struct CompiledGraph {
  bool without_material = false; // no profile: passes that serve scattering are off
  uint64_t serial = 0;           // unique among the compiled graphs of a graph
  uint64_t revision = 0;         // counts changes of work or techniques, and of tables
  Graph graph;
  std::vector<Change> changes;   // changes made by overlays and included files
  std::vector<SourceFile> files; // files of the changes, without their texts
  // configurations of the choices by budget; first: the defaults
  std::vector<choice::Configuration> configurations;
  choice::TimeMargins margins; // by configuration, learned
  // memory that plans share; null if there is only one plan
  std::unique_ptr<vulkan::HeapPool> heap_pool;
  std::shared_ptr<vulkan::ViewTables> tables; // of all executors
  // new kernels, until the context has them; then null
  std::unique_ptr<vulkan::KernelStore> kernels;
  std::vector<RunnablePlan>
      plans;                  // by Configuration::plan, then those of RunnablePlan::without_bounds
  uint32_t configuration = 0; // recorded last, or to be recorded first
  uint32_t plan = 0;          // recorded last, or to be recorded first
  std::vector<SettingValue> settings; // by Graph::settings: choices by budget at their defaults
  std::vector<std::vector<const char*>> option_names; // by Graph::settings, into `graph`
  std::vector<Slot> slots;
  // by slot; filled at each record, preallocated
  std::vector<vulkan::HostImage> images;
  std::vector<vulkan::HostBuffer> buffers;       // by slot, like `images`
  std::vector<vulkan::HostStructure> structures; // by slot, like `images`
  // last frame_index recorded with this compiled graph; 0: never
  uint64_t last_frame = 0;
  std::array<double, 2> last_jitter_px{}; // of that frame

  const RunnablePlan& current() const {
    return plans[configurations[configuration].plan];
  } // of the configuration
  const RunnablePlan& recorded() const { return plans[plan]; }
};

// Device memory of one view that a plan needs, with the plan that replaces it for empty bounds.
struct PlanBytes {
  uint64_t transient = 0, history = 0;
};
PlanBytes bytes_of_plan(const CompiledGraph& compiled_graph, uint32_t plan);

// Parses, compiles and allocates. Plans come from `cache` if it has them, and are added
// otherwise. On failure `diagnostics` says why and `compiled_graph` is unchanged. Stores files that
// the host delivers and fitted tables in `input`, and adds new entries to `costs`. Call adopt()
// before the first record. Thread: any.
dermis_result build_compiled_graph(dermis_context_t& context, CompiledGraphInput& input,
                                   vulkan::HistoryReason history, PlanCache& cache,
                                   const choice::ErrorModel& errors, choice::CostEstimator& costs,
                                   Diagnostics& diagnostics,
                                   std::shared_ptr<CompiledGraph>& compiled_graph);

// Adds the error to `diagnostics` and returns its result.
dermis_result rejected(dermis_context_t& context, const vulkan::Error& error,
                       Diagnostics& diagnostics);

// Fits the tables of input.profiles that passes `use`, and writes them to device memory.
vulkan::Error make_tables(dermis_context_t& context, const subsurface::TableUse& use,
                          CompiledGraphInput& input);

// Shares the compiled graph's new kernels with all graphs of the context. Call it once nothing can
// fail any more.
void share_kernels(CompiledGraph& compiled_graph) noexcept;

// Copies the compiled graph for another view. `input` must be the input that `of` was built from.
dermis_result copy_compiled_graph(dermis_context_t& context, CompiledGraphInput& input,
                                  const CompiledGraph& of, vulkan::HistoryReason history,
                                  Diagnostics& diagnostics,
                                  std::shared_ptr<CompiledGraph>& compiled_graph);

// Returns `configurations` with the costs of their passes and their technique, according to the
// given tables. Adds new entries to `costs`. Needed after a setting or a table changed.
std::vector<choice::Configuration> described(const PassTypeRegistry& pass_types,
                                             const CompiledGraph& compiled_graph,
                                             const choice::ErrorModel& errors,
                                             choice::CostEstimator& costs,
                                             std::vector<choice::Configuration> configurations);

// Returns the described configurations with a new value of a setting that turns no pass on or off.
std::vector<choice::Configuration> configurations_with(const CompiledGraph& compiled_graph,
                                                       const PassTypeRegistry& pass_types,
                                                       const choice::ErrorModel& errors,
                                                       choice::CostEstimator& costs,
                                                       uint32_t setting, const SettingValue& value);

// Pipelines by plan; see vulkan::Executor::make_pipelines.
using NewPipelines = std::vector<std::shared_ptr<const vulkan::PlanPipelines>>;

// Creates the pipelines that `configurations` need. Changes neither the compiled graph nor its
// executors, so that frames may be recorded meanwhile. New pipelines are added to `kernels`.
vulkan::Error make_pipelines(dermis_context_t& context, const CompiledGraphInput& input,
                             const CompiledGraph& compiled_graph,
                             std::span<const choice::Configuration> configurations,
                             vulkan::KernelStore& kernels, NewPipelines& pipelines);

// Returns the value that `json` gives to a declared setting; nullopt with errors in `diagnostics`.
std::optional<SettingValue> read_setting(const SettingDeclaration& declared,
                                         const std::string& json, Diagnostics& diagnostics);

} // namespace dermis::abi
