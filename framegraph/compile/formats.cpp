// Chooses one format for each resource and requests its memory needs from the device profile.

#include "framegraph/compile/hardware.hpp"
#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

namespace dermis {
namespace {

struct FormatRejection { // why a format cannot be used for a resource
  bool exists = false;
  uint32_t use =
      invalid_index;       // use whose port cannot work with the format; invalid_index: the device
  bool unfiltered = false; // the device cannot filter it, as the port requires
};

bool same_description(const PlanResource& a, const PlanResource& b) {
  return a.width == b.width && a.height == b.height && a.format == b.format &&
         a.vk_usage == b.vk_usage && a.mips == b.mips && a.layers == b.layers &&
         a.bytes == b.bytes && a.type == b.type;
}

MemoryNeeds request_needs(const DeviceProfile& device, const PlanResource& resource) {
  if (resource.type == ResourceType::buffer)
    return device.buffer_needs({resource.bytes, resource.vk_usage});
  return device.image_needs({resource.format, resource.width, resource.height, resource.mips,
                             resource.layers, resource.vk_usage});
}

struct FormatResolver {
  const CompileInput& in;
  const Graph& graph;
  const Sizes& sizes;
  const Activation& active;
  const Versions& versions;
  const Usages& usages;
  Report& report;
  FormatScratch& scratch;
  ResourceMemory& memory = scratch.result;

  // Returns whether the setting that limits the port's formats rejects the format.
  bool setting_rejects(const Use& use, Format format) const {
    const PassType& type = active.type(use.pass);
    const SettingFormats& limit = type.ports[use.port].formats_while;
    for (uint32_t s = 0; !limit.setting.empty() && s < type.settings.size(); ++s)
      if (type.settings[s].name == limit.setting &&
          setting_value(graph, active, use.pass, s).integer == limit.option)
        return std::find(limit.formats.begin(), limit.formats.end(), format) == limit.formats.end();
    return false;
  }

  FormatRejection violation(ResourceId id, Format format) const {
    for (uint32_t n = usages.resources[id.value].first_constraint; n != invalid_index;
         n = usages.constraints[n].next) {
      const Use& use = versions.uses[usages.constraints[n].use];
      if (!works_with(active.type(use.pass).ports[use.port], format) ||
          setting_rejects(use, format))
        return {true, usages.constraints[n].use};
      if (active.type(use.pass).ports[use.port].filtered && !in.device->filters(format))
        return {true, usages.constraints[n].use, true};
    }
    const uint32_t usage = usages.resources[id.value].vk_usage;
    return {usage != 0 && !in.device->supports(format, usage), invalid_index};
  }

  void report_formats(ResourceId id, std::span<const Format> candidates) {
    const ResourceDeclaration& declared = graph.resources[id.value];
    std::string text = fmt::format("no format of '{}' can be used", declared.name);
    if (candidates.empty()) text += ": none is declared";
    for (const Format format : candidates) {
      const FormatRejection why = violation(id, format);
      text += fmt::format("; not {}: ", format_info(format).name);
      if (why.use == invalid_index) {
        text += fmt::format("the device '{}' does not support it with image usage {:#x}",
                            in.device->name, usages.resources[id.value].vk_usage);
      } else {
        const Use& use = versions.uses[why.use];
        const Port& port = active.type(use.pass).ports[use.port];
        text += why.unfiltered
                    ? fmt::format("the device '{}' does not filter it linearly, as port '{}' of "
                                  "pass '{}' needs",
                                  in.device->name, port.name, name_of(graph, use.pass))
                    : fmt::format("port '{}' of pass '{}' cannot work with it", port.name,
                                  name_of(graph, use.pass));
        if (works_with(port, format) && !why.unfiltered)
          text += fmt::format(", because of its setting '{}'", port.formats_while.setting);
      }
    }
    report.diagnostics.add(DiagnosticId::no_usable_format, declared.where, std::move(text));
  }

  void choose_format(ResourceId id, Format& chosen) {
    const ResourceDeclaration& declared = graph.resources[id.value];
    const Format bound = in.host_formats.empty() ? Format::undefined : in.host_formats[id.value];
    std::span<const Format> candidates = declared.formats;
    if (sizes.info[id.value].host_owned && bound != Format::undefined) {
      const auto found = std::find(candidates.begin(), candidates.end(), bound);
      if (found == candidates.end()) {
        std::string list;
        for (const Format format : candidates)
          list += fmt::format("{}{}", list.empty() ? "" : ", ", format_info(format).name);
        report.diagnostics.add(DiagnosticId::host_format, declared.where,
                               fmt::format("the host binds '{}' as {}; the graph declares {}",
                                           declared.name, format_info(bound).name, list));
        return;
      }
      candidates = candidates.subspan(static_cast<size_t>(found - candidates.begin()), 1);
    }
    const auto record_reason = [&](Reason::ReasonKind why, Format format, uint32_t b,
                                   uint32_t port = 0) {
      report.record_reason(Reason::About::resource, id.value, why, static_cast<uint32_t>(format), b,
                           port);
    };
    for (const Format format : candidates) {
      const FormatRejection why = violation(id, format);
      if (!why.exists) {
        chosen = format;
        const bool host = bound == format && sizes.info[id.value].host_owned;
        record_reason(Reason::ReasonKind::format, format,
                      host                           ? 2
                      : format == candidates.front() ? 0
                                                     : 1);
        return;
      }
      if (why.use == invalid_index)
        record_reason(Reason::ReasonKind::format_unsupported, format,
                      usages.resources[id.value].vk_usage);
      else if (why.unfiltered)
        record_reason(Reason::ReasonKind::format_unfiltered, format,
                      versions.uses[why.use].pass.value, versions.uses[why.use].port);
      else
        record_reason(Reason::ReasonKind::format_not_ported, format,
                      versions.uses[why.use].pass.value, versions.uses[why.use].port);
    }
    report_formats(id, candidates);
  }

  // Requests each description once: graphs have few, and a device takes long to answer.
  MemoryNeeds needs_of(const PlanResource& resource) {
    const uint64_t mixed = (uint64_t{resource.width} * 31 + resource.height) * 31 + resource.bytes +
                           static_cast<uint64_t>(resource.format) * 5 + resource.vk_usage;
    FormatScratch::DeviceAnswer& answer =
        scratch.answers[(mixed ^ mixed >> 7) % scratch.answers.size()];
    if (!answer.given || !same_description(answer.description, resource))
      answer = {true, resource, request_needs(*in.device, resource)};
    return answer.needs;
  }

  // Chooses format and memory needs. Resources of one shape and one usage share the decision,
  // unless the host, a port or a recorded reason makes a difference.
  void find_format(PlanResource& resource) {
    const ResourceId id = resource.declared;
    const ResourceUsage& usage = usages.resources[id.value];
    const bool host_owned = sizes.info[id.value].host_owned;
    const uint32_t shape_index = sizes.shape_of[id.value];
    const bool separate = host_owned || report.reasons_requested ||
                          usage.first_constraint != invalid_index || shape_index == invalid_index;
    FormatScratch::ShapeFormat* shape = separate ? nullptr : &scratch.shapes[shape_index];
    if (shape && shape->decided && shape->vk_usage == usage.vk_usage) {
      resource.format = shape->format;
      memory.needs.push_back(shape->needs);
      return;
    }
    if (resource.type == ResourceType::image) choose_format(id, resource.format);
    memory.needs.push_back(host_owned ? MemoryNeeds{} : needs_of(resource));
    if (!shape || (resource.type == ResourceType::image && resource.format == Format::undefined))
      return;
    *shape = {true, usage.vk_usage, resource.format, memory.needs.back()};
  }
};

} // namespace

const ResourceMemory& resolve_formats(const CompileInput& in, const Sizes& sizes,
                                      const Activation& active, const Versions& versions,
                                      const Usages& usages, Report& report,
                                      std::vector<PlanResource>& resources,
                                      FormatScratch& scratch) {
  const Graph& graph = *in.graph;
  const auto count = graph.resources.size();
  ResourceMemory& memory = scratch.result;
  memory.needs.clear();
  memory.plan_index.assign(count, invalid_index);
  memory.transient_bytes.assign(count, 0);
  scratch.answers.fill({});
  scratch.shapes.assign(sizes.shape_count, {});
  FormatResolver resolver{in, graph, sizes, active, versions, usages, report, scratch};
  constexpr size_t ahead = 8;
  int32_t slot = 0;
  for (uint32_t i = 0; i < count; ++i) {
    if (i + ahead < count) prefetch(&graph.resources[i + ahead].formats);
    const ResourceInfo& info = sizes.info[i];
    const int32_t own_slot = info.imported || info.exported ? slot++ : -1;
    const ResourceUsage& usage = usages.resources[i];
    if (!usage.used && !info.bound) continue;
    memory.plan_index[i] = static_cast<uint32_t>(resources.size());
    PlanResource& resource = resources.emplace_back();
    resource.declared = ResourceId{i};
    resource.type = info.type;
    resource.origin = info.imported ? Origin::imported : Origin::transient;
    resource.exported = info.exported && info.bound;
    resource.width = sizes.extents[i].width;
    resource.height = sizes.extents[i].height;
    resource.mips = sizes.extents[i].mips;
    resource.layers = info.layers;
    resource.bytes = sizes.extents[i].bytes;
    resource.vk_usage = usage.vk_usage;
    resource.instance_count = usage.deepest_read + 1;
    resource.slot = own_slot;
    resolver.find_format(resource);
    if (usage.deepest_read == 0) memory.transient_bytes[i] = memory.needs.back().size;
  }
  return memory;
}

} // namespace dermis
