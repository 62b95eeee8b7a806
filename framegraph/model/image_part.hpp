#pragma once
// How a graph file names mips and layers of an image, behind its name: "#2", "#1..3", "#1..", "[0]",
// "#2[0..1]".

#include "framegraph/model/graph.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace dermis {

// "" is the whole image. nullopt: it is no such text, or names more than images have.
std::optional<ImagePart> parse_part(std::string_view text);

// As parse_part() reads it.
std::string part_text(const ImagePart& part);

} // namespace dermis
