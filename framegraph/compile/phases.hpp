#pragma once
// The phases of compile() before placement and barriers. Each function returns its result by
// reference; the result and the phase's private memory are located in the phase's scratch, which is
// reused between compilations. No phase reads another phase's scratch. Internal to compile/.

#include "framegraph/compile/values.hpp"

#include <array>
#include <utility>
#include <vector>

namespace dermis {

// ---- sizes.cpp ----

struct SizeScratch {
  enum class Mark : uint8_t { unvisited, open, done, failed };

  Sizes result;
  std::vector<Mark> marks;                  // by resource
  std::vector<ResourceId> first_of_shape;   // by shape
  std::array<uint32_t, 32> last_shape_of{}; // by remainder of a hash: the shape found last
  std::vector<ResourceId> chain;            // resources whose sizes follow each other
};
// Computes the size of each resource, and which slots the host binds. Errors of sizes are returned.
const Sizes& resolve_sizes(const CompileInput& in, Report& report, SizeScratch& scratch);
// Reports the errors of sizes that live passes and bound exports need.
void report_size_errors(const CompileInput& in, const Sizes& sizes, const Versions& versions,
                        const LiveSet& live, Report& report);

// ---- activation.cpp ----

struct ActivationScratch {
  Activation result;
};
// Resolves the settings, and evaluates which passes are on.
const Activation& evaluate_conditions(const CompileInput& in, Report& report,
                                      ActivationScratch& scratch);
// Returns the value of a setting of the pass's type.
SettingValue setting_value(const Graph& graph, const Activation& active, PassId pass,
                           uint32_t setting);

// ---- subresources.cpp ----

struct SubresourceScratch {
  Subresources result;
  // By resource, for mips and for layers: the numbers at which ranges begin.
  std::vector<std::array<std::vector<uint16_t>, 2>> cuts;
};
// Divides images into the subresource ranges that ports name.
const Subresources& split_subresources(const CompileInput& in, const Sizes& sizes,
                                       const Activation& active, Report& report,
                                       SubresourceScratch& scratch);

// ---- versions.cpp, races.cpp ----

struct VersionScratch {
  // How a subresource's name is understood at one point of the file.
  struct Binding {
    uint32_t version = invalid_index;
    ResourceId later; // valid: the version that the only producer of this resource writes later
  };
  struct ResourceDef {
    uint32_t producers = 0; // passes that are on and write the subresource
    uint32_t first_version = invalid_index;
    bool replaced = false; // by `otherwise` of a pass that is off
    Binding substitute;
  };
  struct ForwardReference { // a use that reads before any pass in file order has written
    uint32_t use = 0, subresource = 0;
  };

  Versions result;
  std::vector<Binding> current;         // by subresource
  std::vector<uint32_t> last_version;   // by subresource: the latest version in its own memory
  std::vector<ResourceDef> definitions; // by subresource
  std::vector<ForwardReference> forward_references;
  std::vector<uint8_t> unneeded; // by resource: see find_unneeded in versions.cpp
};
// Resolves which version of which resource each port accesses, and applies `otherwise`.
const Versions& resolve_versions(const CompileInput& in, const Sizes& sizes,
                                 const Activation& active, const Subresources& subresources,
                                 Report& report, VersionScratch& scratch);

// Reports passes that read what they write, with these settings.
void report_races(const CompileInput& in, const Activation& active, const Versions& versions,
                  Report& report);

// ---- cull.cpp ----

struct CullScratch {
  LiveSet result;
  std::vector<uint64_t> unvisited; // bit set of live passes whose reads were not followed yet
};
// Finds the passes that a bound export or a side effect needs.
const LiveSet& cull(const CompileInput& in, const Sizes& sizes, const Activation& active,
                    const Versions& versions, Report& report, CullScratch& scratch);

// ---- bind_errors.cpp ----

struct BindErrorScratch {
  std::vector<uint8_t> reported; // by resource: one root cause gives one diagnostic
};
// Reports ports of live passes and exports that resolve_versions could not bind.
void report_bind_errors(const CompileInput& in, const Sizes& sizes, const Activation& active,
                        const Subresources& subresources, const Versions& versions,
                        const LiveSet& live, Report& report, BindErrorScratch& scratch);

// ---- queues.cpp ----

struct QueueScratch {
  QueueAssignment result;
};
// Assigns live passes to the main queue or the async queue.
const QueueAssignment& assign_queues(const CompileInput& in, const Sizes& sizes,
                                     const Subresources& subresources, const Versions& versions,
                                     const LiveSet& live, Report& report, QueueScratch& scratch);

// ---- usages.cpp ----

struct UsageScratch {
  Usages result;
};
// Gathers how the live passes use each resource.
const Usages& gather_usages(const CompileInput& in, const Sizes& sizes, const Activation& active,
                            const Versions& versions, const LiveSet& live, Report& report,
                            UsageScratch& scratch);

// ---- formats.cpp ----

struct FormatScratch {
  struct DeviceAnswer { // the memory that the device needs for one description
    bool given = false;
    PlanResource description;
    MemoryNeeds needs;
  };
  struct ShapeFormat { // the decision for one shape and one usage
    bool decided = false;
    uint32_t vk_usage = 0;
    Format format = Format::undefined;
    MemoryNeeds needs;
  };

  ResourceMemory result;
  std::vector<ShapeFormat> shapes;        // by shape
  std::array<DeviceAnswer, 32> answers{}; // at most one for each remainder of a hash
};
// Chooses formats and memory needs. Fills `resources`, which is Plan::resources.
const ResourceMemory& resolve_formats(const CompileInput& in, const Sizes& sizes,
                                      const Activation& active, const Versions& versions,
                                      const Usages& usages, Report& report,
                                      std::vector<PlanResource>& resources, FormatScratch& scratch);

// ---- schedule.cpp, schedule_backward.cpp ----

struct ScheduleScratch {
  Schedule result;
  std::vector<uint32_t> first_before,
      before; // by pass, and one more: passes that must run before it
  std::vector<std::pair<uint32_t, uint32_t>>
      readers;                      // pass that overwrites a version, pass that reads it
  std::vector<uint32_t> overwriter; // by version: pass that overwrites it
  std::vector<uint64_t> peak_bytes, output_bytes; // by pass
  std::vector<uint32_t> depth_first, stack, cursors;
  std::vector<uint8_t> visited;
  std::vector<uint32_t> position;  // by pass
  std::vector<Interval> lifetimes; // in the depth-first order
  std::vector<int64_t> changes;    // by position: bytes that become live less those that end
};
// Orders the live passes, and computes the lifetime of each resource. Reports cycles.
const Schedule& schedule_passes(const CompileInput& in, const Activation& active,
                                const Versions& versions, const LiveSet& live,
                                const ResourceMemory& memory, Report& report,
                                ScheduleScratch& scratch);

// Returns the live passes in the order of the file, dependencies before all. Only for graphs in
// which some pass depends on a pass that is located after it. Reports cycles, also among the passes
// that are on but not live.
std::vector<PassId> sort_backward_graph(const Graph& graph, const Activation& active,
                                        const Versions& versions, const LiveSet& live,
                                        Report& report);

// ---- passes.cpp ----

struct PassScratch {
  enum class Fit : uint8_t { unknown, yes, no };
  std::vector<Fit> fits; // by pass type: within the device's limits
};
// Fills Plan::passes and Plan::settings, and checks the device's limits.
void plan_passes(const CompileInput& in, const Activation& active, const QueueAssignment& queues,
                 const Schedule& schedule, Report& report, Plan& plan, PassScratch& scratch);

// ---- histories.cpp ----

struct HistoryScratch {
  Histories result;
};
// Finds when a history's oldest frame is last read, and whether it is overwritten in place. Sets
// PlanResource::instance_count of histories.
const Histories& analyze_histories(const CompileInput& in, const Activation& active,
                                   const Versions& versions, const Usages& usages,
                                   const Schedule& schedule, Report& report,
                                   std::vector<PlanResource>& resources, HistoryScratch& scratch);

} // namespace dermis
