#pragma once
// Texts of the source tree for the C interface, and the slots of a graph.

#include <dermis/dermis.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace dermis::abi_test {

// The path starts at the root of the sources.
inline std::string read_text(const std::string& path) {
  std::ifstream file(std::string(DERMIS_SOURCE_DIR) + "/" + path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

// Points into both arguments.
inline dermis_source source_of(const std::string& text, const char* name) {
  dermis_source source = DERMIS_SOURCE_INIT;
  source.name = name;
  source.text = text.data();
  source.length = text.size();
  return source;
}

// Reloads the graph with another text; all else stays equal.
inline dermis_result reload_text(dermis_graph graph, const dermis_source& source,
                                 dermis_report* report = nullptr) {
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  desc.source = source;
  desc.keep = DERMIS_KEEP_ALL & ~DERMIS_KEEP_SOURCE;
  return dermis_graph_reload(graph, &desc, report);
}

inline std::vector<dermis_slot> slots_of(dermis_graph graph) { // Empty on failure.
  uint32_t count = 0;
  if (dermis_graph_slots(graph, &count, nullptr) != DERMIS_OK) return {};
  std::vector<dermis_slot> slots(count, dermis_slot DERMIS_SLOT_INIT);
  if (dermis_graph_slots(graph, &count, slots.data()) != DERMIS_OK) return {};
  return slots;
}

} // namespace dermis::abi_test
