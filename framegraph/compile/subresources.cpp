// Which parts of images are told apart: ports that name mips or layers cut an image into rectangles of mips
// and layers, the fewest for which every port sees each of them whole or not at all.

#include "framegraph/compile/phases.hpp"
#include "framegraph/model/image_part.hpp"
#include "framegraph/text/limits.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis {
namespace {

enum Side : uint8_t { mips, layers };

struct SubresourceSplitter {
  CompileContext& c;

  // Where the range of a binding begins and ends; false beyond what the image has at this size.
  bool range_of(const PortBinding& binding, SubresourceRange& range) const {
    const uint32_t has_mips = c.extents[binding.resource.value].mips;
    const uint32_t has_layers = c.graph->resources[binding.resource.value].layers;
    const ImagePart& part = binding.part;
    const uint32_t end_mip = part.mips == 0 ? has_mips : part.first_mip + part.mips;
    const uint32_t end_layer = part.layers == 0 ? has_layers : uint32_t{part.first_layer} + part.layers;
    if (part.first_mip >= end_mip || end_mip > has_mips || part.first_layer >= end_layer ||
        end_layer > has_layers)
      return false;
    range = {part.first_mip, static_cast<uint16_t>(end_mip - part.first_mip), part.first_layer,
             static_cast<uint16_t>(end_layer - part.first_layer)};
    return true;
  }

  void refuse(PassId pass, const PortBinding& binding) {
    const ResourceDeclaration& resource = c.graph->resources[binding.resource.value];
    const Extent& extent = c.extents[binding.resource.value];
    c.diagnostics
        ->add(DiagnosticId::part_missing, c.graph->place_of(binding),
              fmt::format("pass '{}' binds '{}{}', but at {}x{} texels '{}' has {} mip{} and {} layer{}",
                          c.name(pass), resource.name, part_text(binding.part), extent.width, extent.height,
                          resource.name, extent.mips, extent.mips == 1 ? "" : "s", resource.layers,
                          resource.layers == 1 ? "" : "s"))
        .related.emplace_back(resource.where, fmt::format("'{}' is declared here", resource.name));
  }

  void cut(PassId pass) {
    for (const PortBinding& binding : c.graph->bindings_of(c.graph->passes[pass.value])) {
      if (binding.part.whole()) continue;
      SubresourceRange range;
      if (!range_of(binding, range)) {
        refuse(pass, binding);
        continue;
      }
      auto& cuts = c.cuts[binding.resource.value];
      cuts[mips].push_back(range.first_mip);
      cuts[mips].push_back(static_cast<uint16_t>(range.first_mip + range.mips));
      cuts[layers].push_back(range.first_layer);
      cuts[layers].push_back(static_cast<uint16_t>(range.first_layer + range.layers));
    }
  }

  // Adds 0 and `end`, and leaves each place once.
  static void sort_cuts(std::vector<uint16_t>& cuts, uint32_t end) {
    cuts.push_back(0);
    cuts.push_back(static_cast<uint16_t>(end));
    std::sort(cuts.begin(), cuts.end());
    cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  }

  void number(ResourceId id) {
    auto& cuts = c.cuts[id.value];
    if (cuts[mips].empty()) return;
    const ResourceDeclaration& declared = c.graph->resources[id.value];
    sort_cuts(cuts[mips], c.extents[id.value].mips);
    sort_cuts(cuts[layers], declared.layers);
    const size_t count = (cuts[mips].size() - 1) * (cuts[layers].size() - 1);
    if (count > limits::image_parts) {
      c.diagnostics->add(DiagnosticId::limit_exceeded, declared.where,
                         fmt::format("ports tell {} parts of '{}' apart, at most {} are accepted", count,
                                     declared.name, limits::image_parts));
      return;
    }
    c.info[id.value].parts = static_cast<uint32_t>(count);
    c.further_subresources[id.value] = static_cast<uint32_t>(c.parts.size());
    for (size_t m = 0; m + 1 < cuts[mips].size(); ++m)
      for (size_t l = 0; l + 1 < cuts[layers].size(); ++l) {
        const SubresourceRange range{cuts[mips][m], static_cast<uint16_t>(cuts[mips][m + 1] - cuts[mips][m]),
                                     cuts[layers][l],
                                     static_cast<uint16_t>(cuts[layers][l + 1] - cuts[layers][l])};
        if (m == 0 && l == 0)
          c.parts[id.value] = range;
        else
          c.parts.push_back(range);
      }
  }
};

} // namespace

void split_subresources(CompileContext& c) {
  c.parts.clear();
  if (!c.graph->parts) return;
  const size_t resources = c.graph->resources.size();
  c.parts.resize(resources);
  c.further_subresources.assign(resources, 0);
  c.cuts.resize(resources);
  for (auto& cuts : c.cuts)
    for (std::vector<uint16_t>& side : cuts)
      side.clear();
  SubresourceSplitter splitter{c};
  for (uint32_t pass = 0; pass < c.graph->passes.size(); ++pass)
    if (c.on[pass]) splitter.cut(PassId{pass});
  for (uint32_t r = 0; r < resources; ++r)
    splitter.number(ResourceId{r});
}

} // namespace dermis
