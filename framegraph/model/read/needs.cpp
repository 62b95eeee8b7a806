// Checks declared sizes of images and buffers against the needs of kernels. Sizes follow the view,
// so several views are tried.

#include "framegraph/model/read/graph_reader.hpp"
#include "framegraph/model/scaled_side.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis {

namespace {

struct Size {
  uint64_t width = 0, height = 0; // 0: not known
};

constexpr uint64_t largest = uint64_t{1} << 32; // the compiler rejects larger sizes
constexpr Size tried_views[] = {{1, 1}, {127, 65}, {1919, 1079}, {3840, 2160}};

uint64_t side_of(uint64_t base, const Rational& factor, const SizeExpression& size) {
  const auto side = scaled_side(base, factor, size);
  return side ? *side : largest;
}

// Returns the sizes of all resources for one view. Sizes that depend on each other in a cycle stay
// unknown; the compiler rejects them.
std::vector<Size> sizes_for(const Graph& graph, const Size& view) {
  std::vector<Size> known(graph.resources.size());
  std::vector<uint32_t> chain;
  for (uint32_t r = 0; r < graph.resources.size(); ++r) {
    chain.assign(1, r);
    const auto expression = [&] { return graph.resources[chain.back()].size; };
    while (known[chain.back()].width == 0 && expression().base == SizeExpression::Base::resource &&
           chain.size() <= graph.resources.size())
      chain.push_back(expression().resource.value);
    if (chain.size() > graph.resources.size()) continue;
    for (; !chain.empty(); chain.pop_back()) {
      Size& size = known[chain.back()];
      if (size.width != 0) continue;
      const SizeExpression& from = graph.resources[chain.back()].size;
      const Size base =
          from.base == SizeExpression::Base::view || from.base == SizeExpression::Base::square_view
              ? view
          : from.base == SizeExpression::Base::resource ? known[from.resource.value]
                                                        : Size{1, 1};
      size = {side_of(base.width, from.x, from), side_of(base.height, from.y, from)};
    }
  }
  return known;
}

const PortNeed* need_of(const PassType& type, uint32_t port) {
  for (const PortNeed& need : type.needs)
    if (need.port == type.ports[port].name) return &need;
  return nullptr;
}

// Returns what is missing; "" if the resource is large enough.
// Returns whether the host decides the size. It must still provide the arguments of a dispatch,
// whose size the declaration states.
bool is_sized_by_host(const ResourceDeclaration& resource, const Port& port) {
  return resource.type == ResourceType::buffer && resource.origin == Origin::imported &&
         port.usage != Usage::indirect_arguments;
}

std::string unmet(const ResourceDeclaration& resource, const PortNeed& need, const Size& size,
                  const Size& view) {
  const uint64_t columns = need.square > 0 ? ceil_div(view.width, need.square) : 0;
  const uint64_t rows = need.square > 0 ? ceil_div(view.height, need.square) : 0;
  if (resource.type == ResourceType::image)
    return size.width >= columns && size.height >= rows
               ? ""
               : fmt::format("{}x{} texels for a view of {}x{}; '{}' has {}x{}", columns, rows,
                             view.width, view.height, resource.name, size.width, size.height);
  const uint64_t required = columns * rows * need.bytes + need.more;
  const uint64_t elements = std::min(size.width * size.height, largest) + resource.extra_elements;
  const uint64_t bytes = elements * std::max<uint32_t>(resource.stride, 1);
  return bytes >= required ? ""
                           : fmt::format("{} bytes for a view of {}x{}; '{}' has {}", required,
                                         view.width, view.height, resource.name, bytes);
}

} // namespace

void check_needs(const GraphReader& reader) {
  const Graph& graph = reader.graph;
  std::vector<bool> reported(graph.resources.size());
  for (const Size& view : tried_views) {
    const std::vector<Size> sizes = sizes_for(graph, view);
    for (const PassDeclaration& pass : graph.passes) {
      const PassType& type = reader.pass_types[pass.type];
      if (type.needs.empty()) continue;
      for (const PortBinding& binding : graph.bindings_of(pass)) {
        const uint32_t r = binding.resource.value;
        const PortNeed* need = need_of(type, binding.port);
        if (need == nullptr || reported[r] || binding.range.first_mip > 0 || sizes[r].width == 0)
          continue;
        if (is_sized_by_host(graph.resources[r], type.ports[binding.port])) continue;
        const std::string missing = unmet(graph.resources[r], *need, sizes[r], view);
        if (missing.empty()) continue;
        reported[r] = true;
        reader.diagnostics
            .add(DiagnosticId::resource_too_small, graph.resources[r].where,
                 fmt::format("the port '{}' of pass '{}' needs {}", need->port, pass.name, missing))
            .related.emplace_back(graph.place_of(binding), "the port is bound here");
      }
    }
  }
}

} // namespace dermis
