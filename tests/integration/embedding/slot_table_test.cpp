// A host that binds what the generated table of slots states runs every shipped graph.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>

namespace dermis::abi_test {
namespace {

struct TableRow {
  std::string slot, type, needed;
};

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  for (size_t at = line.find('|'); at != std::string::npos;) {
    const size_t end = line.find('|', at + 1);
    if (end == std::string::npos) break;
    cells.push_back(line.substr(at + 2, end - at - 3)); // Cells have a blank at both ends.
    at = end;
  }
  return cells;
}

// Returns the words between backquotes.
std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> words;
  for (size_t at = text.find('`'); at != std::string::npos;) {
    const size_t end = text.find('`', at + 1);
    words.push_back(text.substr(at + 1, end - at - 1));
    at = text.find('`', end + 1);
  }
  return words;
}

std::vector<TableRow> slot_table() {
  std::ifstream page(DERMIS_BINARY_DIR "/docs/slots.md");
  std::vector<TableRow> rows;
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("| `")) continue;
    const std::vector<std::string> cells = cells_of(line);
    rows.push_back({names_in(cells[0]).front(), cells[2], cells[3]});
  }
  return rows;
}

// Returns "required", "optional", or "" if the graph has no such slot.
std::string need_in(const TableRow& row, const std::string& graph) {
  std::stringstream parts(row.needed);
  for (std::string part; std::getline(parts, part, ';');) {
    part = part.substr(part.find_first_not_of(' '));
    const std::vector<std::string> graphs = names_in(part);
    if (part.ends_with(" in all") || std::ranges::find(graphs, graph) != graphs.end())
      return part.substr(0, part.find(' '));
  }
  return "";
}

VkFormat format_named(const std::string& name) {
  static const std::map<std::string, VkFormat> formats = {
      {"rgba16f", VK_FORMAT_R16G16B16A16_SFLOAT},
      {"rgba32f", VK_FORMAT_R32G32B32A32_SFLOAT},
      {"b10g11r11f", VK_FORMAT_B10G11R11_UFLOAT_PACK32},
      {"d32f", VK_FORMAT_D32_SFLOAT},
      {"d24", VK_FORMAT_X8_D24_UNORM_PACK32},
      {"d16", VK_FORMAT_D16_UNORM},
      {"d24s8", VK_FORMAT_D24_UNORM_S8_UINT},
      {"d32fs8", VK_FORMAT_D32_SFLOAT_S8_UINT},
      {"r32f", VK_FORMAT_R32_SFLOAT},
      {"r16f", VK_FORMAT_R16_SFLOAT},
      {"r8_unorm", VK_FORMAT_R8_UNORM},
      {"r8_uint", VK_FORMAT_R8_UINT},
      {"r16_uint", VK_FORMAT_R16_UINT},
      {"r32_uint", VK_FORMAT_R32_UINT},
      {"rgba8_srgb", VK_FORMAT_R8G8B8A8_SRGB},
      {"rgba8_unorm", VK_FORMAT_R8G8B8A8_UNORM},
      {"rg16f", VK_FORMAT_R16G16_SFLOAT},
      {"rg32f", VK_FORMAT_R32G32_SFLOAT}};
  const auto found = formats.find(name);
  EXPECT_NE(found, formats.end()) << name;
  return found == formats.end() ? VK_FORMAT_UNDEFINED : found->second;
}

// The null device never reads the handle.
template <class Handle> Handle invented(uint64_t number) {
  Handle out = VK_NULL_HANDLE;
  std::memcpy(&out, &number, sizeof out);
  return out;
}

constexpr dermis_image_state no_image{VK_IMAGE_LAYOUT_UNDEFINED, 0,
                                      VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                      VK_ACCESS_2_MEMORY_WRITE_BIT, 0};

// Runs one frame of configs/graphs/<name>.json with the table's bindings: each required slot, and
// with `with_optional` the optional slots. `choice` counts through the formats of each slot.
void follow(const std::vector<TableRow>& table, const std::string& name, bool with_optional,
            size_t choice) {
  SCOPED_TRACE(name + (with_optional ? ", all slots" : ", required slots") + ", format " +
               std::to_string(choice));
  NullHost host;
  ASSERT_OK(host.make_context(host.context_desc()));
  std::vector<dermis_slot_format> formats;
  std::vector<const char*> unbound;
  std::map<std::string, std::string> bind; // Maps slots to types.
  for (const TableRow& row : table) {
    const std::string need = need_in(row, name);
    if (need.empty()) continue;
    if (need == "optional" && !with_optional) {
      unbound.push_back(row.slot.c_str());
      continue;
    }
    bind[row.slot] = row.type;
    const std::vector<std::string> names = names_in(row.type);
    if (names.empty()) continue;
    dermis_slot_format& format = formats.emplace_back(dermis_slot_format DERMIS_SLOT_FORMAT_INIT);
    format.name = row.slot.c_str();
    format.format = format_named(names[choice % names.size()]);
  }
  const std::string text = read_text(dermis::shipped::graph_file(name));
  dermis_profile profile = skin_profile();
  dermis_graph_desc graph = graph_desc(text, "graph.json", 64);
  graph.profiles = &profile;
  graph.profile_count = 1;
  graph.formats = formats.data();
  graph.format_count = static_cast<uint32_t>(formats.size());
  graph.unbound = unbound.data();
  graph.unbound_count = static_cast<uint32_t>(unbound.size());
  dermis_report report = nullptr;
  ASSERT_OK(dermis_graph_create(host.context, &graph, &host.graph, &report))
      << dermis_report_text(report);
  EXPECT_THAT(dermis_report_text(report), Not(HasSubstr("D06")))
      << "the graph knows every name of the table";
  dermis_report_destroy(report);

  std::vector<dermis_image_binding> images;
  std::vector<dermis_buffer_binding> buffers;
  std::vector<dermis_acceleration_structure_binding> structures;
  size_t bound = 0;
  for (const dermis_slot& slot : slots_of(host.graph)) {
    const auto reported = bind.find(slot.name);
    EXPECT_EQ(reported != bind.end(), slot.bound == 1) << slot.name;
    if (reported == bind.end()) continue;
    ++bound;
    if (reported->second == "acceleration structure") {
      auto& one = structures.emplace_back(
          dermis_acceleration_structure_binding DERMIS_ACCELERATION_STRUCTURE_BINDING_INIT);
      one.slot = slot.id;
      one.structure = invented<VkAccelerationStructureKHR>(0x52);
      one.before = one.after = no_image;
    } else if (reported->second.starts_with("buffer, ")) {
      EXPECT_EQ(std::stoul(reported->second.substr(8)), slot.stride) << slot.name;
      auto& one = buffers.emplace_back(dermis_buffer_binding DERMIS_BUFFER_BINDING_INIT);
      one.slot = slot.id;
      one.buffer = invented<VkBuffer>(0x100 + bound);
      one.bytes = slot.bytes + uint64_t{slot.stride} * 16;
      one.before = one.after = no_image;
    } else {
      auto& one = images.emplace_back(host.image_for(slot));
      const std::vector<std::string> names = names_in(reported->second);
      one.format = format_named(names[choice % names.size()]);
    }
  }
  EXPECT_EQ(bound, bind.size()) << "the table has slots that the graph does not have";
  dermis_frame frame = host.frame_at(1);
  frame.bindings = images.data();
  frame.binding_count = static_cast<uint32_t>(images.size());
  frame.buffers = buffers.data();
  frame.buffer_count = static_cast<uint32_t>(buffers.size());
  frame.structures = structures.data();
  frame.structure_count = static_cast<uint32_t>(structures.size());
  frame.depth_kind = DERMIS_DEPTH_VIEW_UNITS;
  const auto depth = bind.find("depth");
  if (depth != bind.end()) {
    const std::vector<std::string> names = names_in(depth->second);
    if (names[choice % names.size()].starts_with("d")) frame.depth_kind = DERMIS_DEPTH_DEVICE;
  }
  EXPECT_OK(dermis_view_record(dermis_graph_view(host.graph), &frame));
}

TEST(SlotTable, FollowingTheTable_BindsEveryShippedGraph) {
  const std::vector<TableRow> table = slot_table();
  ASSERT_GT(table.size(), 8u);
  size_t graphs = 0;
  for (const std::string& file : dermis::shipped::graph_files()) {
    ++graphs;
    const std::string name = std::filesystem::path(file).stem().string();
    follow(table, name, false, 0);
    for (size_t choice = 0; choice < 6; ++choice) // Depth has the most formats.
      follow(table, name, true, choice);
  }
  EXPECT_EQ(graphs, 16u);
}

} // namespace
} // namespace dermis::abi_test
