#include "integration/abi/slots.hpp"

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

void warn_of_no_slot(const Graph& graph, const char* list, const std::string& name,
                     Diagnostics& diagnostics) {
  std::string known;
  for (const ResourceDeclaration& declared : graph.resources)
    if (is_slot(declared)) known += fmt::format("{}'{}'", known.empty() ? "" : ", ", declared.name);
  diagnostics.add(DiagnosticId::host_names_no_slot, {},
                  fmt::format("{} names '{}', which is no import or export of graph '{}'; its slots are {}",
                              list, name, graph.name, known));
}

// The first access of each resource decides in which layout it comes best.
Layout first_layout(const Plan& plan, uint32_t resource) {
  for (const PlanPass& pass : plan.passes)
    for (uint32_t i = 0; i < pass.access_count; ++i)
      if (const PlanAccess& access = plan.accesses[pass.first_access + i]; access.resource == resource)
        return access.layout;
  return Layout::undefined;
}

struct Touch {
  bool read = false, written = false;
};

// What the host's contents are to the plan: read if the first pass to touch them reads them.
Touch touch(const Plan& plan, uint32_t resource) {
  Touch result;
  for (const PlanPass& pass : plan.passes) {
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

std::vector<Slot> make_slots(const Graph& graph, const Plan& plan) {
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
    if (!declared.formats.empty()) slot.format = declared.formats.front(); // when the plan has no use for it
    const auto id = static_cast<int32_t>(slots.size());
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      const PlanResource& resource = plan.resources[r];
      if (resource.slot != id) continue;
      slot.bound = resource.first_instance == no_instance;
      slot.format = resource.format;
      slot.bytes = resource.bytes;
      slot.vk_usage = resource.vk_usage;
      slot.width = resource.width;
      slot.height = resource.height;
      slot.first_layout = first_layout(plan, r);
      const Touch touched = touch(plan, r);
      slot.read = touched.read;
      slot.written = touched.written;
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
    if (declared == nullptr)
      warn_of_no_slot(graph, "the list of unbound slots", name, diagnostics);
    else if (!declared->optional)
      diagnostics.add(DiagnosticId::host_required_slot, declared->where,
                      fmt::format("slot '{}' is required, but the host lists it as unbound", name));
    else
      bound[index] = false;
  }
  return bound;
}

std::vector<Format> host_formats(const Graph& graph, std::span<const HostFormat> formats,
                                 Diagnostics& diagnostics) {
  std::vector<Format> result(graph.resources.size(), Format::undefined);
  for (const HostFormat& given : formats) {
    size_t index = 0;
    if (find_slot(graph, given.slot, index) == nullptr)
      warn_of_no_slot(graph, "the list of formats", given.slot, diagnostics);
    else
      result[index] = given.format;
  }
  return result;
}

} // namespace dermis::abi
