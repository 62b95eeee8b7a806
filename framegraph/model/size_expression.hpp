#pragma once
// Parses sizes as exact rationals: "view", "view/2", "view*3/4", "square_view/2",
// "name/2", [width, height].

#include "framegraph/model/graph.hpp"
#include "framegraph/text/document.hpp"

#include <functional>
#include <optional>
#include <string_view>

namespace dermis {

// Reads the size at `node`: a string or an array of two integers. With `single`, a single integer n
// means [n, 1], a buffer of n elements. `find` returns the resource with a name, or an invalid id
// after reporting the error. `owner` may not be its own base. Rounding and alignment are separate
// keys and keep their defaults.
std::optional<SizeExpression> parse_size(const Document& document, NodeId node,
                                         std::string_view what, ResourceId owner, bool single,
                                         const std::function<ResourceId(std::string_view)>& find,
                                         Diagnostics& diagnostics);

} // namespace dermis
