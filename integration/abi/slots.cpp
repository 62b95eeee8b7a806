#include "integration/abi/slots.hpp"

#include "framegraph/text/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis::abi {
namespace {

bool is_slot(const ResourceDeclaration& declared) {
  return declared.origin == Origin::imported || declared.exported;
}

const ResourceDeclaration* find_slot(const Graph& graph, const std::string& name, size_t& index) {
  for (index = 0; index < graph.resources.size(); ++index)
    if (graph.resources[index].name == name && is_slot(graph.resources[index]))
      return &graph.resources[index];
  return nullptr;
}

// A larger limit would also match valid names of different slots ("lights" and "lighting").
constexpr size_t max_slips = 2;

// Warns of a name that is probably a misspelt slot, and adds other names to `others`. A slot that
// the list also names itself is not suggested.
void check_name(const Graph& graph, const char* list, std::span<const std::string_view> names,
                std::string_view name, std::vector<std::string_view>& others,
                Diagnostics& diagnostics) {
  std::vector<std::string_view> slots;
  for (const ResourceDeclaration& declared : graph.resources) {
    if (!is_slot(declared)) continue;
    if (declared.name == name) return;
    if (edit_distance(name, declared.name, max_slips) <= max_slips &&
        std::find(names.begin(), names.end(), declared.name) == names.end())
      slots.emplace_back(declared.name);
  }
  std::string suggestion = did_you_mean(name, slots);
  if (suggestion.empty()) {
    if (std::find(others.begin(), others.end(), name) == others.end()) others.push_back(name);
    return;
  }
  diagnostics
      .add(DiagnosticId::host_names_no_slot, {},
           fmt::format("{} names '{}', which is not an import or export of graph '{}'", list, name,
                       graph.name))
      .suggestion = std::move(suggestion);
}

// Returns the best layout for the resource on entry: that of its first access.
Layout first_layout(const Plan& plan, uint32_t resource) {
  for (const PlanPass& pass : plan.passes)
    for (uint32_t i = 0; i < pass.access_count; ++i)
      if (const PlanAccess& access = plan.accesses[pass.first_access + i];
          access.resource == resource)
        return access.layout;
  return Layout::undefined;
}

struct SlotAccess {
  bool read = false, written = false;
};

// Returns how the plan uses the host's contents without the passes in `left_out`: `read` if the
// first pass that accesses them reads them.
SlotAccess access_of(const Plan& plan, uint32_t resource, std::span<const uint8_t> left_out = {}) {
  SlotAccess result;
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    if (p < left_out.size() && left_out[p] != 0) continue;
    const PlanPass& pass = plan.passes[p];
    bool reads = false, writes = false;
    for (uint32_t i = 0; i < pass.access_count; ++i) {
      const PlanAccess& access = plan.accesses[pass.first_access + i];
      if (access.resource != resource) continue;
      writes = writes || (access.access & all_write_access) != 0;
      reads = reads || (access.access & ~all_write_access) != 0;
    }
    result.read = result.read || (reads && !result.written);
    result.written = result.written || writes;
  }
  return result;
}

} // namespace

void report_unknown_slots(const Graph& graph, std::span<const std::string> unbound,
                          std::span<const HostFormat> formats, Diagnostics& diagnostics) {
  const std::vector<std::string_view> left_out(unbound.begin(), unbound.end());
  std::vector<std::string_view> formatted, others;
  for (const HostFormat& given : formats)
    formatted.emplace_back(given.slot);
  for (const std::string_view name : left_out)
    check_name(graph, "dermis_graph_desc.unbound", left_out, name, others, diagnostics);
  for (const std::string_view name : formatted)
    check_name(graph, "dermis_graph_desc.formats", formatted, name, others, diagnostics);
  if (others.empty()) return;
  std::string known;
  for (const ResourceDeclaration& declared : graph.resources)
    if (is_slot(declared)) known += fmt::format("{}'{}'", known.empty() ? "" : ", ", declared.name);
  diagnostics.add(
      DiagnosticId::host_names_other_slots, {},
      fmt::format(
          "graph '{}' has no slot for '{}', which dermis_graph_desc names; its slots are {}",
          graph.name, fmt::join(others, "', '"), known));
}

std::vector<Slot> make_slots(const Graph& graph, const Plan& plan,
                             std::span<const uint8_t> left_out) {
  std::vector<Slot> slots;
  for (uint32_t i = 0; i < graph.resources.size(); ++i) {
    const ResourceDeclaration& declared = graph.resources[i];
    if (!is_slot(declared)) continue;
    Slot slot;
    slot.name = declared.name;
    slot.resource = ResourceId{i};
    slot.type = declared.type;
    slot.stride = declared.stride;
    slot.required = !declared.optional;
    // if the plan does not use the slot
    if (!declared.formats.empty()) slot.format = declared.formats.front();
    const auto id = static_cast<int32_t>(slots.size());
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      const PlanResource& resource = plan.resources[r];
      if (resource.slot != id) continue;
      slot.in_plan = resource.first_instance == no_instance;
      slot.format = resource.format;
      slot.bytes = resource.bytes;
      slot.vk_usage = resource.vk_usage;
      slot.width = resource.width;
      slot.height = resource.height;
      slot.first_layout = first_layout(plan, r);
      const SlotAccess slot_access = access_of(plan, r);
      // A pass that is left out in frames with empty bounds may write what others read.
      slot.read = slot_access.read || access_of(plan, r, left_out).read;
      slot.written = slot_access.written;
    }
    slots.push_back(std::move(slot));
  }
  return slots;
}

std::vector<bool> bound_resources(const Graph& graph, std::span<const std::string> unbound,
                                  Diagnostics& diagnostics) {
  std::vector<bool> bound(graph.resources.size(), true);
  for (const std::string& name : unbound) {
    size_t index = 0;
    const ResourceDeclaration* declared = find_slot(graph, name, index);
    if (declared == nullptr) continue;
    if (!declared->optional)
      diagnostics.add(DiagnosticId::host_required_slot, declared->where,
                      fmt::format("slot '{}' is required, but the host lists it as unbound", name));
    else
      bound[index] = false;
  }
  return bound;
}

std::vector<Format> host_formats(const Graph& graph, std::span<const HostFormat> formats) {
  std::vector<Format> result(graph.resources.size(), Format::undefined);
  for (const HostFormat& given : formats) {
    size_t index = 0;
    if (find_slot(graph, given.slot, index) != nullptr) result[index] = given.format;
  }
  return result;
}

} // namespace dermis::abi
