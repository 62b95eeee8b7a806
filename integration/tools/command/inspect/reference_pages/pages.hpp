#pragma once
// Pages of documentation that follow from declarations, as Markdown.

#include "framegraph/model/graph.hpp"
#include "framegraph/model/pass_type.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace dermis::tools {

// A text inside a table.
inline std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text)
    out += c == '|' ? std::string("\\|") : c == '\n' ? std::string(" ") : std::string(1, c);
  return out;
}

// Tables of the keys of each schema (name, text), in this order.
std::string format_page(std::span<const std::pair<std::string_view, std::string>> schemas);

// Ports and settings of each pass type.
std::string pass_types_page(const PassTypeRegistry& pass_types);

struct NamedGraph {
  std::string name; // of the file, without its ending
  Graph graph;
};
// A table of all slots of `graphs`: direction, formats, in which graphs a slot is required or optional, and
// the note of its declaration. Where graphs differ, a cell names the graphs of each text.
std::string slot_table(std::span<const NamedGraph> graphs);

// `page` with the text between the two comments of block `name` replaced; "" where they are missing.
std::string replace_block(std::string_view page, std::string_view name, std::string_view block);

} // namespace dermis::tools
