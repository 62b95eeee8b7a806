#pragma once
// What the phases of compile() share: one context of flat arrays, filled from top to bottom. Internal to
// compile/.

#include "framegraph/compile/compile.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dermis {

inline constexpr uint32_t no_value = 0xffffffffu;

// Size of a resource at the allocated view size.
struct Extent {
  uint32_t width = 1, height = 1, mips = 1;
  uint64_t bytes = 0; // buffers
};

// One version of one resource within a frame. Version 0 of an import is what the host put there.
struct Value {
  ResourceId resource;
  uint32_t version = 0;
  PassId producer;              // invalid: there before the frame
  uint32_t previous = no_value; // the version this one is written over, in place
};

// One bound port of one pass that is on.
struct Use {
  PassId pass;
  uint32_t port = 0;
  Usage usage = Usage::sampled_image;
  ResourceId resource; // whose memory is accessed, after `otherwise`
  uint32_t frames_back = 0;
  uint32_t read_value = no_value, write_value = no_value; // into CompileContext::values
  ResourceId asked;                                       // as bound in the file
  SourceLocation where;
  enum class Trouble : uint8_t {
    none,
    unbound,
    unwritten,
    ambiguous,
    replaced,
    history_unwritten
  } trouble = Trouble::none;
};

// A resource's interval in the final order, and how it is used there.
struct Lifetime {
  bool used = false;
  uint32_t first = 0, last = 0; // positions in Plan::passes
  uint32_t vk_usage = 0;
  uint32_t deepest_read = 0; // largest frames_back that a live pass reads
};

struct CompileContext {
  const CompileInput& input;
  const Graph& graph;
  const KindRegistry& kinds;
  const DeviceProfile& device;
  Diagnostics& diagnostics;

  // resolve
  std::vector<uint8_t> bound; // by resource: imports and exports the host binds
  std::vector<Extent> extents;
  std::vector<Format> formats;
  // choose
  std::vector<SettingValue> settings;
  std::vector<uint8_t> on; // by pass: `when` holds
  // versions
  std::vector<Value> values;
  std::vector<Use> uses;             // sorted by pass, then port
  std::vector<uint32_t> first_use;   // by pass, and one more: into uses
  std::vector<uint32_t> final_value; // by resource: its version when the frame ends, no_value if none
  // cull
  std::vector<uint8_t> live;
  // order
  std::vector<PassId> order;
  // lifetimes
  std::vector<Lifetime> lifetimes;     // by resource
  std::vector<uint32_t> plan_resource; // by resource: into Plan::resources, or no_value

  CompiledPlan out;

  const std::string& name(ResourceId id) const { return graph.resources[id.value].name; }
  const std::string& name(PassId id) const { return graph.passes[id.value].name; }
  const PassKind& kind(PassId id) const { return kinds[graph.passes[id.value].kind]; }
  bool host_owned(ResourceId id) const; // its memory comes from the host in this plan
  void because(Reason::About about, uint32_t index, std::string text) {
    out.reasons.push_back({about, index, std::move(text)});
  }
};

// The phases, in the order they run. Each adds diagnostics; compile() stops behind a phase that found errors.
void resolve_sizes(CompileContext& context); // bound slots, extents
void choose(CompileContext& context);        // values of settings; which passes are on
void resolve_versions(
    CompileContext& context);            // which version each port reads and writes, `otherwise` applied
void cull(CompileContext& context);      // which passes run: those that something bound needs
void order(CompileContext& context);     // in which order; refuses cycles
void lifetimes(CompileContext& context); // first and last use, union of usages, Plan::passes
void resolve_formats(CompileContext& context); // one format each, Plan::resources
void pack(CompileContext& context);            // heaps and placements
void synchronize(CompileContext& context);     // accesses and barriers

// "technique = 'hybrid'": the value as a graph file would write it.
std::string setting_text(const SettingDeclaration& setting, const SettingValue& value);

} // namespace dermis
