// Computes the size of each resource and which slots the host binds. An error of a size is reported
// only if the plan needs the resource, which a later phase decides.

#include "framegraph/compile/hardware.hpp"
#include "framegraph/compile/phases.hpp"
#include "framegraph/model/scaled_side.hpp"
#include "framegraph/text/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace dermis {
namespace {

uint32_t full_chain(uint32_t width, uint32_t height) {
  return static_cast<uint32_t>(std::bit_width(std::max({width, height, 1u})));
}

struct SizeResolver {
  const CompileInput& in;
  const Graph& graph;
  SizeScratch& scratch;
  Sizes& sizes = scratch.result;
  using Mark = SizeScratch::Mark;

  Mark& mark(ResourceId id) { return scratch.marks[id.value]; }

  void add_error(ResourceId id, DiagnosticId what, std::string text) {
    sizes.errors.push_back({id, {what, graph.resources[id.value].where, std::move(text), "", {}}});
  }

  void report_too_large(ResourceId id, const std::string& what) {
    add_error(id, DiagnosticId::size_out_of_range,
              fmt::format("'{}' {}", name_of(graph, id), what));
  }

  // Evaluates a size that follows another resource's. Not recursive: a file may chain thousands.
  void resolve(ResourceId requested) {
    if (mark(requested) != Mark::unvisited) return;
    std::vector<ResourceId>& chain = scratch.chain;
    chain.assign(1, requested);
    while (true) { // to the first resource whose base is known
      const ResourceId id = chain.back();
      if (mark(id) == Mark::done || mark(id) == Mark::failed) break;
      if (mark(id) == Mark::open) return report_cycle(chain);
      mark(id) = Mark::open;
      const SizeExpression& size = graph.resources[id.value].size;
      if (size.base != SizeExpression::Base::resource) break;
      chain.push_back(size.resource);
    }
    while (!chain.empty()) {
      const ResourceId id = chain.back();
      chain.pop_back();
      if (mark(id) == Mark::open) mark(id) = evaluate(id) ? Mark::done : Mark::failed;
    }
  }

  void report_cycle(const std::vector<ResourceId>& chain) {
    const auto start = std::find(chain.begin(), chain.end(), chain.back());
    std::string names;
    for (auto at = start; at != chain.end(); ++at)
      names += fmt::format("{}'{}'", at == start ? "" : " -> ", name_of(graph, *at));
    add_error(*start, DiagnosticId::size_cycle, fmt::format("circular size dependency: {}", names));
    for (auto at = start + 1; at + 1 < chain.end(); ++at)
      sizes.errors.back().diagnostic.related.emplace_back(
          graph.resources[at->value].where,
          fmt::format("'{}' is declared here", name_of(graph, *at)));
    for (const ResourceId id : chain)
      mark(id) = Mark::failed;
  }

  bool evaluate(ResourceId id) {
    const ResourceDeclaration& declared = graph.resources[id.value];
    const SizeExpression& size = declared.size;
    uint64_t base_x = 1, base_y = 1;
    if (size.base == SizeExpression::Base::view) {
      base_x = in.view_width;
      base_y = in.view_height;
    } else if (size.base == SizeExpression::Base::square_view) {
      base_x = uint64_t{in.view_width} << pixel_doublings(in.pixel_grid, 0);
      base_y = uint64_t{in.view_height} << pixel_doublings(in.pixel_grid, 1);
    } else if (size.base == SizeExpression::Base::resource) {
      if (mark(size.resource) == Mark::failed) return false; // an error already
      base_x = sizes.extents[size.resource.value].width;
      base_y = sizes.extents[size.resource.value].height;
    }
    const auto width = scaled_side(base_x, size.x, size);
    const auto height = scaled_side(base_y, size.y, size);
    if (!width || !height) {
      report_too_large(id, "has a size beyond 32 bits");
      return false;
    }
    Extent& extent = sizes.extents[id.value];
    extent.width = *width;
    extent.height = *height;
    if (declared.type == ResourceType::acceleration_structure) return true; // it has no size
    return declared.type == ResourceType::image ? finish_image(id, extent)
                                                : finish_buffer(id, extent);
  }

  bool finish_image(ResourceId id, Extent& extent) {
    const ResourceDeclaration& declared = graph.resources[id.value];
    const uint32_t limit = in.device->max_image_dimension;
    if (extent.width > limit || extent.height > limit) {
      report_too_large(id, fmt::format("is {}x{} texels; the device '{}' holds at most {} per side",
                                       extent.width, extent.height, in.device->name, limit));
      return false;
    }
    if (declared.layers < 1 || declared.layers > in.device->max_image_layers) {
      report_too_large(id,
                       fmt::format("has {} layers; the device '{}' holds 1 .. {}", declared.layers,
                                   in.device->name, in.device->max_image_layers));
      return false;
    }
    const uint32_t full = full_chain(extent.width, extent.height);
    extent.mips = declared.mips == 0 ? full : declared.mips;
    if (extent.mips > full) {
      report_too_large(id, fmt::format("asks for {} mip levels; {}x{} has {}", extent.mips,
                                       extent.width, extent.height, full));
      return false;
    }
    return true;
  }

  bool finish_buffer(ResourceId id, Extent& extent) {
    const ResourceDeclaration& declared = graph.resources[id.value];
    const uint64_t elements = uint64_t{extent.width} * extent.height;
    const uint64_t limit = in.device->max_storage_buffer_bytes;
    const uint64_t stride = std::max<uint32_t>(declared.stride, 1);
    if (elements > limit / stride || declared.extra_elements > limit / stride - elements) {
      report_too_large(
          id,
          fmt::format("has {} + {} elements of {} bytes; the device '{}' holds at most {} bytes",
                      elements, declared.extra_elements, stride, in.device->name, limit));
      return false;
    }
    extent.bytes = (elements + declared.extra_elements) * stride;
    return true;
  }

  // Marks the sizes with errors. Ports may name any mip that is declared or that images can have,
  // because the error of the size is the root cause.
  void clear_failed() {
    for (uint32_t i = 0; i < graph.resources.size(); ++i) {
      if (scratch.marks[i] != Mark::failed) continue;
      const uint32_t mips = graph.resources[i].mips;
      sizes.extents[i] = {0, 0, mips != 0 ? mips : limits::image_mips, 0};
    }
  }
};

bool same(Rational a, Rational b) {
  return a.numerator == b.numerator && a.denominator == b.denominator;
}

// Returns whether two declarations whose sizes follow no other resource have equal sizes and
// formats at every view.
bool alike(const ResourceDeclaration& a, const ResourceDeclaration& b) {
  return same(a.size.x, b.size.x) && same(a.size.y, b.size.y) && a.size.base == b.size.base &&
         a.size.rounding == b.size.rounding && a.size.align == b.size.align &&
         a.size.border == b.size.border && a.type == b.type && a.mips == b.mips &&
         a.layers == b.layers && a.stride == b.stride && a.extra_elements == b.extra_elements &&
         a.formats == b.formats;
}

// Graphs have few shapes: most resources share the shape of an earlier one.
void find_extent(SizeResolver& resolver, ResourceId id) {
  const ResourceDeclaration& declared = resolver.graph.resources[id.value];
  const SizeExpression& size = declared.size;
  SizeScratch& scratch = resolver.scratch;
  Sizes& sizes = scratch.result;
  const uint64_t mixed =
      static_cast<uint64_t>(size.x.numerator) * 31 + static_cast<uint64_t>(size.x.denominator) * 7 +
      declared.mips +
      (declared.formats.empty() ? 0 : static_cast<uint64_t>(declared.formats.front()));
  uint32_t& shape = scratch.last_shape_of[mixed % scratch.last_shape_of.size()];
  const bool known = shape != invalid_index &&
                     alike(resolver.graph.resources[scratch.first_of_shape[shape].value], declared);
  if (!known) {
    if (!resolver.evaluate(id)) {
      resolver.mark(id) = SizeScratch::Mark::failed;
      return;
    }
    shape = sizes.shape_count++;
    scratch.first_of_shape.push_back(id);
  }
  sizes.extents[id.value] = sizes.extents[scratch.first_of_shape[shape].value];
  sizes.shape_of[id.value] = shape;
  resolver.mark(id) = SizeScratch::Mark::done;
}

// Import or export: whether the host binds it.
void resolve_slot(const CompileInput& in, ResourceId id, ResourceInfo& info, Report& report) {
  const ResourceDeclaration& declared = in.graph->resources[id.value];
  info.bound = !declared.optional || in.bound.empty() || in.bound[id.value];
  info.host_owned = info.imported || info.bound;
  if (!info.bound)
    report.record_reason(Reason::About::resource, id.value, Reason::ReasonKind::unbound);
  if (!info.history) return;
  report.diagnostics.add(
      DiagnosticId::history_of_host_memory, declared.where,
      fmt::format("'{}' is bound by the host, so the graph cannot keep its earlier frames",
                  declared.name));
}

} // namespace

const Sizes& resolve_sizes(const CompileInput& in, Report& report, SizeScratch& scratch) {
  const Graph& graph = *in.graph;
  const auto count = graph.resources.size();
  Sizes& sizes = scratch.result;
  sizes.extents.assign(count, {});
  sizes.info.assign(count, {});
  sizes.shape_of.assign(count, invalid_index);
  sizes.shape_count = 0;
  sizes.errors.clear();
  scratch.marks.assign(count, SizeScratch::Mark::unvisited);
  scratch.first_of_shape.clear();
  scratch.last_shape_of.fill(invalid_index);
  SizeResolver resolver{in, graph, scratch};
  bool any_follows_resource = false;
  constexpr size_t ahead = 6;
  for (uint32_t i = 0; i < count; ++i) {
    if (i + ahead < count) {
      prefetch(&graph.resources[i + ahead].type);
      prefetch(&graph.resources[i + ahead].size);
      prefetch(&graph.resources[i + ahead].history);
    }
    const ResourceDeclaration& declared = graph.resources[i];
    ResourceInfo& info = sizes.info[i];
    info.type = declared.type;
    info.image = declared.type == ResourceType::image;
    info.imported = declared.origin == Origin::imported;
    info.exported = declared.exported;
    info.optional = declared.optional;
    info.history = declared.history.frames != 0;
    info.layers = declared.layers;
    if (info.imported || info.exported) resolve_slot(in, ResourceId{i}, info, report);
    if (declared.size.base == SizeExpression::Base::resource)
      any_follows_resource = true;
    else
      find_extent(resolver, ResourceId{i});
  }
  for (uint32_t i = 0; any_follows_resource && i < count; ++i)
    resolver.resolve(ResourceId{i});
  if (!sizes.errors.empty()) resolver.clear_failed();
  return sizes;
}

void report_size_errors(const CompileInput& in, const Sizes& sizes, const Versions& versions,
                        const LiveSet& live, Report& report) {
  if (sizes.errors.empty()) return;
  const Graph& graph = *in.graph;
  std::vector<uint8_t> needed(graph.resources.size(), 0);
  const auto need = [&](ResourceId id) { // and what its size follows
    while (needed[id.value] == 0) {
      needed[id.value] = 1;
      const SizeExpression& size = graph.resources[id.value].size;
      if (size.base == SizeExpression::Base::resource) id = size.resource;
    }
  };
  for (const Use& use : versions.uses)
    if (live.contains(use.pass) && use.bind_error != Use::BindError::unbound) need(use.resource);
  for (uint32_t i = 0; i < needed.size(); ++i)
    if (sizes.info[i].exported && sizes.info[i].bound) need(ResourceId{i});
  for (const SizeError& error : sizes.errors) {
    if (needed[error.resource.value] == 0) continue;
    const Diagnostic& found = error.diagnostic;
    report.diagnostics.add(found.id, found.where, found.text).related = found.related;
  }
}

} // namespace dermis
