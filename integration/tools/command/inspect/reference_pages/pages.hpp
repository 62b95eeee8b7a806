#pragma once
// Documentation pages generated from declarations, as Markdown.

#include "framegraph/model/graph.hpp"
#include "framegraph/model/pass_type.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace dermis::tools {

// Escapes text for a table cell.
inline std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text)
    out += c == '|' ? std::string("\\|") : c == '\n' ? std::string(" ") : std::string(1, c);
  return out;
}

// Returns tables of the keys of each schema (name, text), in this order.
std::string format_page(std::span<const std::pair<std::string_view, std::string>> schemas);

// Returns tables of the ports and settings of each pass type.
std::string pass_types_page(const PassTypeRegistry& pass_types);

struct NamedGraph {
  std::string name; // file name without its extension
  Graph graph;
};
// Returns a Markdown table of all slots of `graphs`: direction, formats, the graphs that require
// the slot, and the "note" of its declaration. Where graphs differ, the cell lists each variant
// with the graphs that have it.
std::string slots_page(std::span<const NamedGraph> graphs);

} // namespace dermis::tools
