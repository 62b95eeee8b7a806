// What every resource is: whether the host binds it, its size, its format.

#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace dermis {
namespace {

constexpr uint64_t largest_side = 0xffffffffull;

// align_up(round(base * factor), align), at least 1, and the border on both sides; nullopt beyond 32 bits.
std::optional<uint32_t> scaled(uint64_t base, Rational factor, const SizeExpression& size) {
  if (factor.numerator < 0 || factor.denominator <= 0) return std::nullopt;
  const auto numerator = static_cast<uint64_t>(factor.numerator);
  const auto denominator = static_cast<uint64_t>(factor.denominator);
  const bool wide = ((base | numerator) >> 32) != 0;
  if (wide && numerator != 0 && base > UINT64_MAX / numerator) return std::nullopt;
  const uint64_t product = base * numerator;
  const uint64_t whole = product / denominator;
  const bool up = (size.rounding == Rounding::ceil) & (whole * denominator != product);
  const uint64_t value = std::max<uint64_t>(whole + (up ? 1 : 0), 1);
  if (value > largest_side) return std::nullopt;
  const uint64_t step = std::max<uint32_t>(size.align, 1);
  const uint64_t aligned = step == 1 ? value : (value + step - 1) / step * step;
  const uint64_t side = aligned + 2 * uint64_t{size.border};
  if (side > largest_side) return std::nullopt;
  return static_cast<uint32_t>(side);
}

uint32_t full_chain(uint32_t width, uint32_t height) {
  return static_cast<uint32_t>(std::bit_width(std::max({width, height, 1u})));
}

struct SizeResolver {
  CompileContext& c;
  enum Mark : uint8_t { untouched, open, done, failed };

  void too_large(const ResourceDeclaration& declared, const std::string& what) {
    c.diagnostics->add(DiagnosticId::size_out_of_range, declared.where,
                       fmt::format("'{}' {}", declared.name, what));
  }

  // Sizes of resources that others are sized by are few and shallow, but a file may chain thousands: no
  // recursion.
  void resolve(ResourceId wanted) {
    if (c.size_marks[wanted.value] != untouched) return;
    std::vector<ResourceId>& chain = c.size_chain;
    chain.assign(1, wanted);
    while (true) { // walk to the first resource whose base is known
      const ResourceId id = chain.back();
      if (c.size_marks[id.value] == done || c.size_marks[id.value] == failed) break;
      if (c.size_marks[id.value] == open) return report_cycle(chain);
      c.size_marks[id.value] = open;
      const SizeExpression& size = c.graph->resources[id.value].size;
      if (size.base != SizeExpression::Base::resource) break;
      chain.push_back(size.resource);
    }
    while (!chain.empty()) {
      const ResourceId id = chain.back();
      chain.pop_back();
      if (c.size_marks[id.value] == open) c.size_marks[id.value] = evaluate(id) ? done : failed;
    }
  }

  void report_cycle(const std::vector<ResourceId>& chain) {
    const auto start = std::find(chain.begin(), chain.end(), chain.back());
    std::string names;
    for (auto at = start; at != chain.end(); ++at)
      names += fmt::format("{}'{}'", at == start ? "" : " -> ", c.name(*at));
    auto& diagnostic = c.diagnostics->add(DiagnosticId::size_cycle, c.graph->resources[start->value].where,
                                          fmt::format("sizes refer to each other in a circle: {}", names));
    for (auto at = start + 1; at + 1 < chain.end(); ++at)
      diagnostic.related.emplace_back(c.graph->resources[at->value].where,
                                      fmt::format("'{}' is declared here", c.name(*at)));
    for (const ResourceId id : chain)
      c.size_marks[id.value] = failed;
  }

  bool evaluate(ResourceId id) {
    const ResourceDeclaration& declared = c.graph->resources[id.value];
    const SizeExpression& size = declared.size;
    uint64_t base_x = 1, base_y = 1;
    if (size.base == SizeExpression::Base::view) {
      base_x = c.input->view_width;
      base_y = c.input->view_height;
    } else if (size.base == SizeExpression::Base::resource) {
      if (c.size_marks[size.resource.value] == failed) return false; // already reported
      base_x = c.extents[size.resource.value].width;
      base_y = c.extents[size.resource.value].height;
    }
    const auto width = scaled(base_x, size.x, size);
    const auto height = scaled(base_y, size.y, size);
    if (!width || !height) {
      too_large(declared, "has a size beyond 32 bits");
      return false;
    }
    Extent& extent = c.extents[id.value];
    extent.width = *width;
    extent.height = *height;
    if (declared.type == ResourceType::acceleration_structure) return true; // it has no size
    return declared.type == ResourceType::image ? finish_image(declared, extent)
                                                : finish_buffer(declared, extent);
  }

  bool finish_image(const ResourceDeclaration& declared, Extent& extent) {
    const uint32_t limit = c.device->max_image_dimension;
    if (extent.width > limit || extent.height > limit) {
      too_large(declared, fmt::format("is {}x{} texels; the device '{}' holds at most {} a side",
                                      extent.width, extent.height, c.device->name, limit));
      return false;
    }
    if (declared.layers < 1 || declared.layers > c.device->max_image_layers) {
      too_large(declared, fmt::format("has {} layers; the device '{}' holds 1 .. {}", declared.layers,
                                      c.device->name, c.device->max_image_layers));
      return false;
    }
    const uint32_t full = full_chain(extent.width, extent.height);
    extent.mips = declared.mips == 0 ? full : declared.mips;
    if (extent.mips > full) {
      too_large(declared, fmt::format("asks for {} mip levels; {}x{} has {}", extent.mips, extent.width,
                                      extent.height, full));
      return false;
    }
    return true;
  }

  bool finish_buffer(const ResourceDeclaration& declared, Extent& extent) {
    const uint64_t elements = uint64_t{extent.width} * extent.height;
    const uint64_t limit = c.device->max_storage_buffer_bytes;
    const uint64_t stride = std::max<uint32_t>(declared.stride, 1);
    if (elements > limit / stride || declared.extra_elements > limit / stride - elements) {
      too_large(declared,
                fmt::format("has {} + {} elements of {} bytes; the device '{}' holds at most {} bytes",
                            elements, declared.extra_elements, stride, c.device->name, limit));
      return false;
    }
    extent.bytes = (elements + declared.extra_elements) * stride;
    return true;
  }
};

struct FormatRejection { // why a format cannot be used for a resource
  bool exists = false;
  uint32_t use = no_value; // whose port cannot work with it; none: the device
};

FormatRejection violation(const CompileContext& c, ResourceId id, Format format) {
  for (uint32_t n = c.lifetimes[id.value].first_narrow; n != no_value; n = c.narrow[n].next) {
    const Use& use = c.uses[c.narrow[n].use];
    if (!works_with(c.type(use.pass).ports[use.port], format)) return {true, c.narrow[n].use};
  }
  const uint32_t usage = c.lifetimes[id.value].vk_usage;
  return {usage != 0 && !c.device->supports(format, usage), no_value};
}

void report_formats(CompileContext& c, ResourceId id, std::span<const Format> candidates) {
  const ResourceDeclaration& declared = c.graph->resources[id.value];
  std::string text = fmt::format("no format of '{}' can be used", declared.name);
  if (candidates.empty()) text += ": none is declared";
  for (const Format format : candidates) {
    const FormatRejection why = violation(c, id, format);
    text += fmt::format("; not {}: ", format_info(format).name);
    if (why.use == no_value) {
      text += fmt::format("the device '{}' does not support it with image usage {:#x}", c.device->name,
                          c.lifetimes[id.value].vk_usage);
    } else {
      const Use& use = c.uses[why.use];
      text += fmt::format("port '{}' of pass '{}' cannot work with it", c.type(use.pass).ports[use.port].name,
                          c.name(use.pass));
    }
  }
  c.diagnostics->add(DiagnosticId::no_usable_format, declared.where, std::move(text));
}

void choose_format(CompileContext& c, ResourceId id, Format& chosen) {
  const ResourceDeclaration& declared = c.graph->resources[id.value];
  const Format bound = c.input->host_formats.empty() ? Format::undefined : c.input->host_formats[id.value];
  std::span<const Format> candidates = declared.formats;
  if (c.host_owned(id) && bound != Format::undefined) {
    const auto found = std::find(candidates.begin(), candidates.end(), bound);
    if (found == candidates.end()) {
      std::string list;
      for (const Format format : candidates)
        list += fmt::format("{}{}", list.empty() ? "" : ", ", format_info(format).name);
      c.diagnostics->add(DiagnosticId::host_format, declared.where,
                         fmt::format("the host binds '{}' as {}; declared are {}", declared.name,
                                     format_info(bound).name, list));
      return;
    }
    candidates = candidates.subspan(static_cast<size_t>(found - candidates.begin()), 1);
  }
  const auto record_reason = [&](Reason::ReasonKind why, Format format, uint32_t b, uint32_t port = 0) {
    c.record_reason(Reason::About::resource, id.value, why, static_cast<uint32_t>(format), b, port);
  };
  for (const Format format : candidates) {
    const FormatRejection why = violation(c, id, format);
    if (!why.exists) {
      chosen = format;
      const bool host = bound == format && c.host_owned(id);
      record_reason(Reason::ReasonKind::format, format, host ? 2 : format == candidates.front() ? 0 : 1);
      return;
    }
    if (why.use == no_value)
      record_reason(Reason::ReasonKind::format_unsupported, format, c.lifetimes[id.value].vk_usage);
    else
      record_reason(Reason::ReasonKind::format_not_ported, format, c.uses[why.use].pass.value,
                    c.uses[why.use].port);
  }
  report_formats(c, id, candidates);
}

bool same_description(const PlanResource& a, const PlanResource& b) {
  return a.width == b.width && a.height == b.height && a.format == b.format && a.vk_usage == b.vk_usage &&
         a.mips == b.mips && a.layers == b.layers && a.bytes == b.bytes && a.type == b.type;
}

MemoryNeeds ask(const DeviceProfile& device, const PlanResource& resource) {
  if (resource.type == ResourceType::buffer) return device.buffer_needs({resource.bytes, resource.vk_usage});
  return device.image_needs(
      {resource.format, resource.width, resource.height, resource.mips, resource.layers, resource.vk_usage});
}

// Graphs have few different descriptions, and devices take their time.
MemoryNeeds needs_of(CompileContext& c, const PlanResource& resource) {
  const uint64_t mixed = (uint64_t{resource.width} * 31 + resource.height) * 31 + resource.bytes +
                         static_cast<uint64_t>(resource.format) * 5 + resource.vk_usage;
  Answer& answer = c.answers[(mixed ^ mixed >> 7) % c.answers.size()];
  if (!answer.given || !same_description(answer.to, resource))
    answer = {true, resource, ask(*c.device, resource)};
  return answer.needs;
}

bool same(Rational a, Rational b) {
  return a.numerator == b.numerator && a.denominator == b.denominator;
}

// Whether two declarations, sized by no other resource, have the same size and formats at every view.
bool alike(const ResourceDeclaration& a, const ResourceDeclaration& b) {
  return same(a.size.x, b.size.x) && same(a.size.y, b.size.y) && a.size.base == b.size.base &&
         a.size.rounding == b.size.rounding && a.size.align == b.size.align &&
         a.size.border == b.size.border && a.type == b.type && a.mips == b.mips && a.layers == b.layers &&
         a.stride == b.stride && a.extra_elements == b.extra_elements && a.formats == b.formats;
}

// Graphs have few shapes: most resources are like one that was looked at before.
void find_extent(CompileContext& c, SizeResolver& resolver, ResourceId id) {
  const ResourceDeclaration& declared = c.graph->resources[id.value];
  const SizeExpression& size = declared.size;
  const uint64_t mixed = static_cast<uint64_t>(size.x.numerator) * 31 +
                         static_cast<uint64_t>(size.x.denominator) * 7 + declared.mips +
                         (declared.formats.empty() ? 0 : static_cast<uint64_t>(declared.formats.front()));
  uint32_t& met = c.shape_of_remainder[mixed % c.shape_of_remainder.size()];
  if (met == no_value || !alike(c.graph->resources[c.shapes[met].first.value], declared)) {
    if (!resolver.evaluate(id)) {
      c.size_marks[id.value] = SizeResolver::failed;
      return;
    }
    met = static_cast<uint32_t>(c.shapes.size());
    Shape& shape = c.shapes.emplace_back();
    shape.first = id;
    shape.extent = c.extents[id.value];
  }
  c.extents[id.value] = c.shapes[met].extent;
  c.shape_of[id.value] = met;
  c.size_marks[id.value] = SizeResolver::done;
}

// Format and memory. Those of a shape are the same wherever nothing but the usage counts.
void find_format(CompileContext& c, PlanResource& resource) {
  const ResourceId id = resource.declared;
  const Lifetime& life = c.lifetimes[id.value];
  const bool host_owned = c.host_owned(id);
  const bool alone = host_owned || c.input->reasons || life.first_narrow != no_value;
  Shape* shape = alone || c.shape_of[id.value] == no_value ? nullptr : &c.shapes[c.shape_of[id.value]];
  if (shape && shape->answered && shape->vk_usage == life.vk_usage) {
    resource.format = shape->format;
    c.needs.push_back(shape->needs);
    return;
  }
  if (resource.type == ResourceType::image) choose_format(c, id, resource.format);
  c.needs.push_back(host_owned ? MemoryNeeds{} : needs_of(c, resource));
  if (!shape || (resource.type == ResourceType::image && resource.format == Format::undefined)) return;
  shape->answered = true;
  shape->vk_usage = life.vk_usage;
  shape->format = resource.format;
  shape->needs = c.needs.back();
}

} // namespace

void resolve_sizes(CompileContext& c) {
  const auto count = c.graph->resources.size();
  c.bound.assign(count, 0);
  c.extents.assign(count, {});
  c.info.assign(count, {});
  c.size_marks.assign(count, SizeResolver::untouched);
  c.shapes.clear();
  c.shape_of.assign(count, no_value);
  c.shape_of_remainder.fill(no_value);
  SizeResolver resolver{c};
  bool by_others = false;
  constexpr size_t ahead = 6;
  for (uint32_t i = 0; i < count; ++i) {
    if (i + ahead < count) {
      fetch(&c.graph->resources[i + ahead].type);
      fetch(&c.graph->resources[i + ahead].size);
      fetch(&c.graph->resources[i + ahead].history);
    }
    const ResourceDeclaration& declared = c.graph->resources[i];
    const bool slot = declared.origin == Origin::imported || declared.exported;
    ResourceInfo& info = c.info[i];
    info.type = declared.type;
    info.image = declared.type == ResourceType::image;
    info.imported = declared.origin == Origin::imported;
    info.exported = declared.exported;
    info.optional = declared.optional;
    info.history = declared.history.frames != 0;
    info.layers = declared.layers;
    if (slot) {
      c.bound[i] = !declared.optional || c.input->bound.empty() || c.input->bound[i];
      info.host_owned = info.imported || c.bound[i];
      if (!c.bound[i]) c.record_reason(Reason::About::resource, i, Reason::ReasonKind::unbound);
      if (info.history)
        c.diagnostics->add(
            DiagnosticId::history_of_host_memory, declared.where,
            fmt::format("'{}' is bound by the host, so its earlier frames are not the graph's to keep",
                        declared.name));
    }
    if (declared.size.base == SizeExpression::Base::resource)
      by_others = true;
    else
      find_extent(c, resolver, ResourceId{i});
  }
  for (uint32_t i = 0; by_others && i < count; ++i)
    resolver.resolve(ResourceId{i});
}

void resolve_formats(CompileContext& c) {
  const auto count = c.graph->resources.size();
  Plan& plan = c.out->plan;
  constexpr size_t ahead = 8;
  c.needs.clear();
  c.answers.fill({});
  c.plan_resource.assign(count, no_value);
  c.transient_bytes.assign(count, 0);
  int32_t slot = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const ResourceId id{i};
    if (i + ahead < count) fetch(&c.graph->resources[i + ahead].formats);
    const bool is_slot = c.info[i].imported || c.info[i].exported;
    const int32_t own_slot = is_slot ? slot++ : -1;
    const Lifetime& life = c.lifetimes[i];
    if (!life.used && !c.bound[i]) continue;
    const ResourceInfo& info = c.info[i];
    PlanResource& resource = plan.resources.emplace_back();
    resource.declared = id;
    resource.type = info.type;
    resource.origin = info.imported ? Origin::imported : Origin::transient;
    resource.exported = info.exported && c.bound[i];
    resource.width = c.extents[i].width;
    resource.height = c.extents[i].height;
    resource.mips = c.extents[i].mips;
    resource.layers = info.layers;
    resource.bytes = c.extents[i].bytes;
    resource.vk_usage = life.vk_usage;
    resource.instance_count = life.deepest_read + 1;
    resource.slot = own_slot;
    c.plan_resource[i] = static_cast<uint32_t>(plan.resources.size() - 1);
    find_format(c, resource);
    if (life.deepest_read == 0) c.transient_bytes[i] = c.needs.back().size;
  }
}

} // namespace dermis
