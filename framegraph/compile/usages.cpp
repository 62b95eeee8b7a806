// Gathers how the live passes use each resource: Vulkan usage, history depth, and ports that limit
// the format.

#include "framegraph/compile/phases.hpp"

#include <algorithm>

namespace dermis {
namespace {

constexpr uint32_t transfer_source_usage =
    0x1; // VK_IMAGE_USAGE_TRANSFER_SRC_BIT, the same bit for buffers

// Returns whether the port, which names no formats, works with every format that the resource may
// get. read_graph has checked single formats, except those of a substitute.
bool takes_all_formats(const Graph& graph, const Use& use, const Port& port) {
  const FormatList& formats = graph.resources[use.resource.value].formats;
  if (formats.size() <= 1 && use.resource == use.requested) return true;
  return std::all_of(formats.begin(), formats.end(),
                     [&](Format format) { return works_with(port, format); });
}

// Adds use number `u` to the usage of its resource.
void add_use(const Graph& graph, const Versions& versions, uint32_t u, const PassType& type,
             Usages& usages) {
  const Use& use = versions.uses[u];
  if (use.bind_error != Use::BindError::none) return;
  ResourceUsage& usage = usages.resources[use.resource.value];
  usage.used = true;
  usage.vk_usage |= usage_info(use.usage).vk_usage;
  usage.deepest_read = std::max(usage.deepest_read, use.frames_back);
  const Port& port = type.ports[use.port];
  if (port.formats.empty() && !port.filtered && takes_all_formats(graph, use, port)) return;
  usages.constraints.push_back({u, usage.first_constraint});
  usage.first_constraint = static_cast<uint32_t>(usages.constraints.size() - 1);
}

// Adds the usages with which histories are cleared, kept and rescaled.
void add_history_usages(const HistoryDeclaration& declared, ResourceUsage& usage) {
  if (usage.deepest_read > 0)
    // Instances start from zero, or with the contents that another plan of the graph kept.
    usage.vk_usage |= usage_info(Usage::clear).vk_usage | transfer_source_usage;
  const uint32_t stored = usage_info(Usage::storage_image_write).vk_usage;
  if (declared.on_resize == HistoryDeclaration::OnResize::rescale && (usage.vk_usage & stored) != 0)
    usage.vk_usage |=
        usage_info(Usage::sampled_image).vk_usage; // the rescaling kernel reads the old size
}

void explain_history(uint32_t resource, const ResourceUsage& usage, Report& report) {
  const Reason::ReasonKind why = !usage.used               ? Reason::ReasonKind::history_unused
                                 : usage.deepest_read == 0 ? Reason::ReasonKind::history_unread
                                                           : Reason::ReasonKind::history_read;
  report.record_reason(Reason::About::resource, resource, why, usage.deepest_read);
}

} // namespace

const Usages& gather_usages(const CompileInput& in, const Sizes& sizes, const Activation& active,
                            const Versions& versions, const LiveSet& live, Report& report,
                            UsageScratch& scratch) {
  const Graph& graph = *in.graph;
  Usages& usages = scratch.result;
  usages.resources.assign(graph.resources.size(), {});
  usages.constraints.clear();
  // From the last use to the first, because each resource's constraints are a stack.
  for (auto u = static_cast<uint32_t>(versions.uses.size()); u-- > 0;)
    if (live.contains(versions.uses[u].pass))
      add_use(graph, versions, u, active.type(versions.uses[u].pass), usages);
  for (uint32_t i = 0; i < graph.resources.size(); ++i) {
    if (!sizes.info[i].history) continue;
    add_history_usages(graph.resources[i].history, usages.resources[i]);
    explain_history(i, usages.resources[i], report);
  }
  for (uint32_t i = 0; in.poison && i < graph.resources.size(); ++i)
    if (usages.resources[i].used && !sizes.info[i].host_owned)
      usages.resources[i].vk_usage |= usage_info(Usage::clear).vk_usage;
  return usages;
}

} // namespace dermis
