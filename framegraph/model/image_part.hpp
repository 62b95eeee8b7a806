#pragma once
// Parses the suffix that names mips and layers of an image in a graph file: "#2", "#1..3", "#1..",
// "[0]", "#2[0..1]".

#include "framegraph/model/graph.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace dermis {

// Returns the part; "" is the whole image. Returns nullopt if the text is malformed or exceeds the
// limits of images.
std::optional<ImagePart> parse_part(std::string_view text);

// Returns the text that parse_part() reads.
std::string part_text(const ImagePart& part);

} // namespace dermis
