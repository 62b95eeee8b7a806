#pragma once
// A graph compiled and ready to record: one candidate of a transaction. Built beside the running one, then
// swapped.

#include "framegraph/compile/compile.hpp"
#include "framegraph/compose/compose.hpp"
#include "framegraph/serial/plan_cache.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "framegraph/vulkan/heap_pool.hpp"
#include "integration/abi/context.hpp"
#include "integration/abi/left_out.hpp"
#include "integration/abi/shaders/runtime_shaders.hpp"
#include "passes/choice/configurations.hpp"
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
  std::string json; // as given by the host, so that it can be carried over a reload
};

struct SourceText {
  std::string name, text;
};

// All that a program is built from; copied from the host, kept for reload and resize.
struct ProgramInput {
  std::string source_name, source_text;
  std::vector<SourceText> overlays;
  dermis_include_fn include = nullptr;
  void* include_user = nullptr;
  std::map<std::string, SourceText, std::less<>>
      included; // what `include` delivered; asked again at a reload
  uint32_t width = 0, height = 0;
  std::vector<subsurface::NumberedProfile> profiles;
  std::vector<std::string> unbound;
  std::vector<HostFormat> formats;
  std::vector<HostSetting> settings;
  RuntimeShaders shaders;
  std::shared_ptr<const subsurface::KernelTables>
      tables; // of `profiles`, as the last program used them; or null
  std::shared_ptr<const vulkan::EnvironmentTables>
      device_tables; // `tables` on the device: all views read them; or null
};

// An import or export as the host sees it; `id` is the position in Program::slots.
struct Slot {
  std::string name;
  ResourceId resource;
  ResourceType type = ResourceType::image;
  uint32_t stride = 0; // buffers: bytes of an element
  uint64_t bytes = 0;  // buffers: least that is bound
  bool required = false, read = false, written = false;
  bool bound = false; // the plan expects a binding
  Format format = Format::undefined;
  uint32_t vk_usage = 0;
  Layout first_layout = Layout::undefined;
  uint32_t width = 0, height = 0;
};

inline constexpr uint32_t no_variant = 0xffffffffu;

// One plan of the graph, with what runs it.
struct Variant {
  std::shared_ptr<const CompiledPlan> compiled; // of all views
  std::unique_ptr<vulkan::Executor> executor;
  bool recorded = false; // at least once
  // For frames with empty bounds: the plan that then runs instead, into Program::variants; or no_variant, and
  // which passes of this plan do not run, by plan pass.
  uint32_t without_bounds = no_variant;
  std::vector<uint8_t> left_out{};
  std::vector<choice::PassLoad>
      loads{}; // of a plan of frames with empty bounds, by plan pass; others: Outcome::passes
};

// For one view: views of one graph share what was compiled and the pipelines, all the rest is their own.
struct Program {
  bool without_material = false; // no profile: passes that serve scattering are off
  uint64_t serial = 0;           // no two programs of a graph have the same
  Graph graph;
  std::vector<Change> changes;                  // what overlays and included files did
  std::vector<SourceFile> files;                // that the changes name; without their texts
  std::vector<choice::Outcome> outcomes;        // what the choices by budget can come to; first: the defaults
  std::unique_ptr<vulkan::HeapPool> heap_pool;  // of all variants' transients; null where there is one
  std::unique_ptr<vulkan::KernelStore> kernels; // what it compiled, until the context has it; then null
  std::vector<Variant> variants;                // by Outcome::plan, then those of Variant::without_bounds
  uint32_t outcome = 0;                         // recorded last, or to be recorded first
  uint32_t variant = 0;                         // likewise
  std::vector<SettingValue> settings;           // by Graph::settings: choices by budget at their defaults
  std::vector<std::vector<const char*>> option_names; // by Graph::settings, into `graph`
  std::vector<Slot> slots;
  std::vector<vulkan::HostImage>
      images; // by slot; filled at each record, so that recording allocates nothing
  std::vector<vulkan::HostBuffer> buffers;       // likewise
  std::vector<vulkan::HostStructure> structures; // likewise
  uint64_t last_frame = 0;                       // frame_index it was recorded with last; 0: never
  std::array<double, 2> last_jitter_px{};        // of that frame

  const Variant& current() const { return variants[outcomes[outcome].plan]; } // of the outcome
  const Variant& recorded() const { return variants[variant]; }
};

// Parses, compiles (or takes the plan from `plans`, where it then is) and allocates. On failure `diagnostics`
// tells why and `program` is unchanged. Keeps in `input` what the host delivers and what was fitted. `costs`
// gets entries for what is new. Before the first record: adopt(). Thread: any.
dermis_result build_program(dermis_context_t& context, ProgramInput& input, vulkan::HistoryReason history,
                            PlanCache& plans, const choice::ErrorModel& errors, choice::CostModel& costs,
                            Diagnostics& diagnostics, std::shared_ptr<Program>& program);

// Adds the error to `diagnostics` and returns its result.
dermis_result refused(dermis_context_t& context, const vulkan::Error& error, Diagnostics& diagnostics);

// Fits the tables of input.profiles for what passes `use`, and puts them on the device.
vulkan::Error make_tables(dermis_context_t& context, const subsurface::TableUse& use, ProgramInput& input);

// Nothing that makes it fails any more: what it compiled serves all graphs of the context.
void share_kernels(Program& program) noexcept;

// The same program for another view. `input` as it was built from.
dermis_result copy_program(dermis_context_t& context, ProgramInput& input, const Program& of,
                           vulkan::HistoryReason history, Diagnostics& diagnostics,
                           std::shared_ptr<Program>& program);

// The outcomes of `program` with what their passes cost and which technique they are, by these tables;
// `costs` gets entries for what is new. After a setting or a table changed.
std::vector<choice::Outcome> described(const PassTypeRegistry& pass_types, const Program& program,
                                       const choice::ErrorModel& errors, choice::CostModel& costs,
                                       std::vector<choice::Outcome> outcomes);

// The same with a new value of a setting that turns no pass on or off.
std::vector<choice::Outcome> outcomes_with(const Program& program, const PassTypeRegistry& pass_types,
                                           const choice::ErrorModel& errors, choice::CostModel& costs,
                                           uint32_t setting, const SettingValue& value);

// The value that `json` gives to a declared setting; nullopt with errors in `diagnostics`.
std::optional<SettingValue> read_setting(const SettingDeclaration& declared, const std::string& json,
                                         Diagnostics& diagnostics);

} // namespace dermis::abi
