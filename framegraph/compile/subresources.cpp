// Divides images into subresource ranges. Ports that name mips or layers divide an image into
// rectangles of mips and layers: the fewest for which every port accesses each rectangle as a whole
// or not at all.

#include "framegraph/compile/phases.hpp"
#include "framegraph/model/image_range.hpp"
#include "framegraph/text/limits.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis {
namespace {

enum Side : uint8_t { mips, layers };

struct SubresourceSplitter {
  const Graph& graph;
  const Sizes& sizes;
  Report& report;
  SubresourceScratch& scratch;
  Subresources& subresources = scratch.result;

  // Returns the range of a binding; false if the image has no such mips or layers at this size.
  bool range_of(const PortBinding& binding, SubresourceRange& range) const {
    const uint32_t has_mips = sizes.extents[binding.resource.value].mips;
    const uint32_t has_layers = graph.resources[binding.resource.value].layers;
    const ImageRange& named = binding.range;
    const uint32_t end_mip = named.mips == 0 ? has_mips : named.first_mip + named.mips;
    const uint32_t end_layer =
        named.layers == 0 ? has_layers : uint32_t{named.first_layer} + named.layers;
    if (named.first_mip >= end_mip || end_mip > has_mips || named.first_layer >= end_layer ||
        end_layer > has_layers)
      return false;
    range = {named.first_mip, static_cast<uint16_t>(end_mip - named.first_mip), named.first_layer,
             static_cast<uint16_t>(end_layer - named.first_layer)};
    return true;
  }

  void report_missing_range(PassId pass, const PortBinding& binding) {
    const ResourceDeclaration& resource = graph.resources[binding.resource.value];
    const Extent& extent = sizes.extents[binding.resource.value];
    report.diagnostics
        .add(DiagnosticId::subresource_missing, graph.place_of(binding),
             fmt::format(
                 "pass '{}' binds '{}{}', but at {}x{} texels '{}' has {} mip{} and {} layer{}",
                 name_of(graph, pass), resource.name, image_range_text(binding.range), extent.width,
                 extent.height, resource.name, extent.mips, extent.mips == 1 ? "" : "s",
                 resource.layers, resource.layers == 1 ? "" : "s"))
        .related.emplace_back(resource.where, fmt::format("'{}' is declared here", resource.name));
  }

  void add_cuts(PassId pass) {
    for (const PortBinding& binding : graph.bindings_of(graph.passes[pass.value])) {
      if (binding.range.whole()) continue;
      SubresourceRange range;
      if (!range_of(binding, range)) {
        if (sizes.extents[binding.resource.value].known()) report_missing_range(pass, binding);
        continue;
      }
      auto& cuts = scratch.cuts[binding.resource.value];
      cuts[mips].push_back(range.first_mip);
      cuts[mips].push_back(static_cast<uint16_t>(range.first_mip + range.mips));
      cuts[layers].push_back(range.first_layer);
      cuts[layers].push_back(static_cast<uint16_t>(range.first_layer + range.layers));
    }
  }

  // Adds 0 and `end`, sorts, and removes duplicates.
  static void sort_cuts(std::vector<uint16_t>& cuts, uint32_t end) {
    cuts.push_back(0);
    cuts.push_back(static_cast<uint16_t>(end));
    std::sort(cuts.begin(), cuts.end());
    cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  }

  void number_ranges(ResourceId id) {
    auto& cuts = scratch.cuts[id.value];
    if (cuts[mips].empty()) return;
    const ResourceDeclaration& declared = graph.resources[id.value];
    sort_cuts(cuts[mips], sizes.extents[id.value].mips);
    sort_cuts(cuts[layers], declared.layers);
    const size_t count = (cuts[mips].size() - 1) * (cuts[layers].size() - 1);
    if (count > limits::image_ranges) {
      report.diagnostics.add(
          DiagnosticId::limit_exceeded, declared.where,
          fmt::format("ports name {} different subresource ranges of '{}', at most {} are accepted",
                      count, declared.name, limits::image_ranges));
      return;
    }
    subresources.counts[id.value] = static_cast<uint32_t>(count);
    subresources.second[id.value] = static_cast<uint32_t>(subresources.ranges.size());
    for (size_t m = 0; m + 1 < cuts[mips].size(); ++m)
      for (size_t l = 0; l + 1 < cuts[layers].size(); ++l) {
        const SubresourceRange range{
            cuts[mips][m], static_cast<uint16_t>(cuts[mips][m + 1] - cuts[mips][m]),
            cuts[layers][l], static_cast<uint16_t>(cuts[layers][l + 1] - cuts[layers][l])};
        if (m == 0 && l == 0)
          subresources.ranges[id.value] = range;
        else
          subresources.ranges.push_back(range);
      }
  }
};

} // namespace

const Subresources& split_subresources(const CompileInput& in, const Sizes& sizes,
                                       const Activation& active, Report& report,
                                       SubresourceScratch& scratch) {
  const Graph& graph = *in.graph;
  Subresources& subresources = scratch.result;
  subresources.counts.clear();
  subresources.second.clear();
  subresources.ranges.clear();
  if (!graph.names_ranges) return subresources;
  const size_t resources = graph.resources.size();
  subresources.counts.assign(resources, 1);
  subresources.second.assign(resources, 0);
  subresources.ranges.resize(resources);
  scratch.cuts.resize(resources);
  for (auto& cuts : scratch.cuts)
    for (std::vector<uint16_t>& side : cuts)
      side.clear();
  SubresourceSplitter splitter{graph, sizes, report, scratch};
  for (uint32_t pass = 0; pass < graph.passes.size(); ++pass)
    if (active.on[pass]) splitter.add_cuts(PassId{pass});
  for (uint32_t r = 0; r < resources; ++r)
    splitter.number_ranges(ResourceId{r});
  return subresources;
}

} // namespace dermis
