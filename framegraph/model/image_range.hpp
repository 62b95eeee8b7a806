#pragma once
// Parses the suffix that names mips and layers of an image in a graph file: "#2", "#1..3", "#1..",
// "[0]", "#2[0..1]".

#include "framegraph/model/graph.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace dermis {

// Returns the range; "" is the whole image. Returns nullopt if the text is malformed or exceeds the
// limits of images.
std::optional<ImageRange> parse_image_range(std::string_view text);

// Returns the text that parse_image_range() reads.
std::string image_range_text(const ImageRange& range);

} // namespace dermis
