#pragma once
// Sizes as exact rationals: "view", "view/2", "view*3/4", "name/2", [width, height].

#include "framegraph/model/graph.hpp"
#include "framegraph/text/document.hpp"

#include <functional>
#include <optional>
#include <string_view>

namespace dermis {

// Reads the size at `node` (a string or an array of two integers; a single integer n is [n, 1], for buffers
// of n elements, where `single` allows it). `find` turns a name into the resource, or an invalid id after
// having reported it; `owner` may not be its own base. Rounding and alignment are separate keys and left at
// their defaults.
std::optional<SizeExpression> parse_size(const Document& document, NodeId node, std::string_view what,
                                         ResourceId owner, bool single,
                                         const std::function<ResourceId(std::string_view)>& find,
                                         Diagnostics& diagnostics);

} // namespace dermis
