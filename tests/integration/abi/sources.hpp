#pragma once
// Texts of the source tree for the C interface, and the slots of a graph.

#include "tests/integration/abi/results.hpp"
#include "tests/support/text_file.hpp"

#include <span>
#include <string>
#include <vector>

namespace dermis::abi_test {

// The path starts at the root of the sources.
inline std::string read_text(const std::string& path) {
  return test::read_text(std::string(DERMIS_SOURCE_DIR) + "/" + path);
}
using test::replaced;

// Points into both arguments.
inline dermis_source source_of(const std::string& text, const char* name) {
  dermis_source source = DERMIS_SOURCE_INIT;
  source.name = name;
  source.text = text.data();
  source.length = text.size();
  return source;
}

// Describes a square graph; points into both arguments.
inline dermis_graph_desc graph_desc(const std::string& text, const char* name, uint32_t side) {
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  desc.source = source_of(text, name);
  desc.width = desc.height = side;
  return desc;
}

// Returns configs/profiles/skin.json as profile `id`.
inline dermis_profile skin_profile(uint32_t id = 1) {
  static const std::string text = read_text("configs/profiles/skin.json");
  dermis_profile profile = DERMIS_PROFILE_INIT;
  profile.id = id;
  profile.source = source_of(text, "skin.json");
  return profile;
}

inline dermis_slot_format slot_format(const char* name, VkFormat format) {
  dermis_slot_format out = DERMIS_SLOT_FORMAT_INIT;
  out.name = name;
  out.format = format;
  return out;
}

inline dermis_port port_of(const char* name, dermis_port_usage usage = DERMIS_PORT_SAMPLED_IMAGE,
                           bool optional = false) {
  dermis_port port = DERMIS_PORT_INIT;
  port.name = name;
  port.usage = usage;
  port.optional = optional ? 1 : 0;
  return port;
}

// Returns a real setting from 0 to `maximum`.
inline dermis_pass_setting real_setting(const char* name, double maximum, double standard = 0) {
  dermis_pass_setting setting = DERMIS_PASS_SETTING_INIT;
  setting.name = name;
  setting.type = DERMIS_PASS_SETTING_REAL;
  setting.default_value = standard;
  setting.maximum = maximum;
  return setting;
}

// Returns a pass type of the host; points into `ports`.
inline dermis_pass_type pass_type_of(const char* name, std::span<const dermis_port> ports,
                                     dermis_pass_fn record, void* user = nullptr) {
  dermis_pass_type type = DERMIS_PASS_TYPE_INIT;
  type.name = name;
  type.ports = ports.data();
  type.port_count = static_cast<uint32_t>(ports.size());
  type.record = record;
  type.user = user;
  return type;
}

// Reloads the graph with another text; all else stays equal.
inline dermis_result reload_text(dermis_graph graph, const dermis_source& source,
                                 dermis_report* report = nullptr) {
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  desc.source = source;
  desc.keep = DERMIS_KEEP_ALL & ~DERMIS_KEEP_SOURCE;
  return dermis_graph_reload(graph, &desc, report);
}

// Calls query(arguments..., &count, NULL), then query(arguments..., &count, items).
template <class Item, class Query, class... Arguments>
std::vector<Item> list_of(const Item& init, Query query, Arguments... arguments) {
  uint32_t count = 0;
  EXPECT_OK(query(arguments..., &count, nullptr));
  std::vector<Item> items(count, init);
  EXPECT_OK(query(arguments..., &count, items.data()));
  return items;
}

// Calls query(arguments..., &size, NULL), then query(arguments..., &size, text).
template <class Query, class... Arguments>
std::string text_from(Query query, Arguments... arguments) {
  size_t size = 0;
  EXPECT_OK(query(arguments..., &size, nullptr));
  std::string text(size, ' ');
  EXPECT_OK(query(arguments..., &size, text.data()));
  return text;
}

inline std::vector<dermis_slot> slots_of(dermis_graph graph) { // Empty on failure.
  uint32_t count = 0;
  if (dermis_graph_slots(graph, &count, nullptr) != DERMIS_OK) return {};
  std::vector<dermis_slot> slots(count, dermis_slot DERMIS_SLOT_INIT);
  if (dermis_graph_slots(graph, &count, slots.data()) != DERMIS_OK) return {};
  return slots;
}

inline dermis_memory memory_of(dermis_graph graph) {
  dermis_memory memory = DERMIS_MEMORY_INIT;
  EXPECT_OK(dermis_graph_memory(graph, &memory));
  return memory;
}

inline dermis_view view_of(dermis_graph graph) { // The caller destroys the view.
  dermis_view view = nullptr;
  EXPECT_OK(dermis_view_create(graph, nullptr, &view, nullptr));
  return view;
}

inline dermis_budget budget_of(float milliseconds, uint32_t flags) {
  dermis_budget budget = DERMIS_BUDGET_INIT;
  budget.milliseconds = milliseconds;
  budget.flags = flags;
  return budget;
}

} // namespace dermis::abi_test
