// Table of the slots of graphs, from their declarations.
#include "integration/tools/command/inspect/reference_pages/pages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace dermis::tools {
namespace {

std::string type_text(const ResourceDeclaration& slot) {
  if (slot.type == ResourceType::acceleration_structure) return "acceleration structure";
  if (slot.type == ResourceType::buffer)
    return fmt::format("buffer, {} bytes per element", slot.stride);
  std::string formats;
  for (const Format format : slot.formats)
    formats += fmt::format("{}`{}`", formats.empty() ? "" : ", ", format_info(format).name);
  return formats;
}

std::string direction_text(const ResourceDeclaration& slot) {
  if (slot.origin != Origin::imported) return "out";
  return slot.exported ? "in, out" : "in";
}

// Texts of graphs; graphs with equal text share an entry.
class TextOfGraphs {
public:
  void add(std::string_view graph, std::string_view text) {
    auto same = std::find_if(entries_.begin(), entries_.end(),
                             [&](const Entry& e) { return e.text == text; });
    if (same == entries_.end()) same = entries_.insert(same, {std::string(text), {}, 0});
    same->graphs += fmt::format("{}`{}`", same->graphs.empty() ? "" : ", ", graph);
    ++same->count;
  }
  // Returns "text", or "text (`graph`); other text (`graph`, `graph`)" if graphs differ.
  std::string say() const {
    if (entries_.size() == 1) return entries_.front().text;
    std::string all;
    for (const Entry& entry : entries_)
      all += fmt::format("{}{} ({})", all.empty() ? "" : "; ", entry.text, entry.graphs);
    return all;
  }
  // Returns "text in all", or "text in `graph`, `graph`; other text in `graph`".
  std::string say_in(size_t graph_count) const {
    std::string all;
    for (const Entry& entry : entries_)
      all += fmt::format("{}{} in {}", all.empty() ? "" : "; ", entry.text,
                         entry.count == graph_count ? "all" : entry.graphs);
    return all;
  }

private:
  struct Entry {
    std::string text, graphs;
    size_t count;
  };
  std::vector<Entry> entries_;
};

struct SlotRow {
  std::string name;
  TextOfGraphs direction, type, need, meaning;
};

} // namespace

std::string slots_page(std::span<const NamedGraph> graphs) {
  std::vector<SlotRow> rows;
  for (const NamedGraph& one : graphs)
    for (const ResourceDeclaration& slot : one.graph.resources) {
      if (slot.origin != Origin::imported && !slot.exported) continue;
      auto row = std::find_if(rows.begin(), rows.end(),
                              [&](const SlotRow& r) { return r.name == slot.name; });
      if (row == rows.end()) {
        row = rows.insert(row, SlotRow{});
        row->name = slot.name;
      }
      row->direction.add(one.name, direction_text(slot));
      row->type.add(one.name, type_text(slot));
      row->need.add(one.name, slot.optional ? "optional" : "required");
      row->meaning.add(one.name, slot.note);
    }
  std::string out = "# Slots of the shipped graphs\n\n| slot | | type or formats | needed | is "
                    "|\n|---|---|---|---|---|\n";
  for (const SlotRow& row : rows)
    out += fmt::format("| `{}` | {} | {} | {} | {} |\n", row.name, row.direction.say(),
                       row.type.say(), row.need.say_in(graphs.size()), cell(row.meaning.say()));
  return out;
}

} // namespace dermis::tools
