// Computes the size of each resource and which slots the host binds.

#include "framegraph/compile/hardware.hpp"
#include "framegraph/compile/phases.hpp"
#include "framegraph/model/scaled_side.hpp"

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
  Report& report;
  SizeScratch& scratch;
  Sizes& sizes = scratch.result;
  using Mark = SizeScratch::Mark;

  Mark& mark(ResourceId id) { return scratch.marks[id.value]; }

  void report_too_large(const ResourceDeclaration& declared, const std::string& what) {
    report.diagnostics.add(DiagnosticId::size_out_of_range, declared.where,
                           fmt::format("'{}' {}", declared.name, what));
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
    auto& diagnostic =
        report.diagnostics.add(DiagnosticId::size_cycle, graph.resources[start->value].where,
                               fmt::format("circular size dependency: {}", names));
    for (auto at = start + 1; at + 1 < chain.end(); ++at)
      diagnostic.related.emplace_back(graph.resources[at->value].where,
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
      if (mark(size.resource) == Mark::failed) return false; // already reported
      base_x = sizes.extents[size.resource.value].width;
      base_y = sizes.extents[size.resource.value].height;
    }
    const auto width = scaled_side(base_x, size.x, size);
    const auto height = scaled_side(base_y, size.y, size);
    if (!width || !height) {
      report_too_large(declared, "has a size beyond 32 bits");
      return false;
    }
    Extent& extent = sizes.extents[id.value];
    extent.width = *width;
    extent.height = *height;
    if (declared.type == ResourceType::acceleration_structure) return true; // it has no size
    return declared.type == ResourceType::image ? finish_image(declared, extent)
                                                : finish_buffer(declared, extent);
  }

  bool finish_image(const ResourceDeclaration& declared, Extent& extent) {
    const uint32_t limit = in.device->max_image_dimension;
    if (extent.width > limit || extent.height > limit) {
      report_too_large(declared,
                       fmt::format("is {}x{} texels; the device '{}' holds at most {} per side",
                                   extent.width, extent.height, in.device->name, limit));
      return false;
    }
    if (declared.layers < 1 || declared.layers > in.device->max_image_layers) {
      report_too_large(declared,
                       fmt::format("has {} layers; the device '{}' holds 1 .. {}", declared.layers,
                                   in.device->name, in.device->max_image_layers));
      return false;
    }
    const uint32_t full = full_chain(extent.width, extent.height);
    extent.mips = declared.mips == 0 ? full : declared.mips;
    if (extent.mips > full) {
      report_too_large(declared, fmt::format("asks for {} mip levels; {}x{} has {}", extent.mips,
                                             extent.width, extent.height, full));
      return false;
    }
    return true;
  }

  bool finish_buffer(const ResourceDeclaration& declared, Extent& extent) {
    const uint64_t elements = uint64_t{extent.width} * extent.height;
    const uint64_t limit = in.device->max_storage_buffer_bytes;
    const uint64_t stride = std::max<uint32_t>(declared.stride, 1);
    if (elements > limit / stride || declared.extra_elements > limit / stride - elements) {
      report_too_large(
          declared,
          fmt::format("has {} + {} elements of {} bytes; the device '{}' holds at most {} bytes",
                      elements, declared.extra_elements, stride, in.device->name, limit));
      return false;
    }
    extent.bytes = (elements + declared.extra_elements) * stride;
    return true;
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
  scratch.marks.assign(count, SizeScratch::Mark::unvisited);
  scratch.first_of_shape.clear();
  scratch.last_shape_of.fill(invalid_index);
  SizeResolver resolver{in, graph, report, scratch};
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
  return sizes;
}

} // namespace dermis
