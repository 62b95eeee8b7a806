#include "tests/passes/device/golden.hpp"

#include "framegraph/serialize/sha256.hpp"
#include "integration/examples/demo_engine/pixel_format.hpp"

#include <fstream>
#include <map>
#include <sstream>

namespace dermis::testing {
namespace {

constexpr const char* table = DERMIS_SOURCE_DIR "/tests/passes/device/golden_frames.txt";

// By driver, then by graph.
using Table = std::map<std::string, std::map<std::string, std::string>>;

Table read_table() {
  Table out;
  std::ifstream file(table);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    std::string driver, graph, hash;
    std::getline(words, driver, '\t');
    std::getline(words, graph, '\t');
    std::getline(words, hash);
    if (!hash.empty()) out[driver][graph] = hash;
  }
  return out;
}

} // namespace

std::string hash_of(const Played& played) {
  std::string all;
  for (const auto& frame : played)
    for (const auto& [slot, texels] : frame) {
      all += slot;
      all.append(reinterpret_cast<const char*>(texels.data()), texels.size());
    }
  return digest_text(sha256(all));
}

std::vector<float> light_of(const Played& played) {
  std::vector<float> out;
  for (const auto& frame : played)
    for (const auto& [slot, texels] : frame) {
      const bool halves = slot == "lighting";
      const auto* format = demo::find_pixel_format(halves ? VK_FORMAT_R16G16B16A16_SFLOAT
                                                          : VK_FORMAT_R32G32B32A32_SFLOAT);
      const std::vector<float> values = demo::decode_texels(*format, texels);
      for (size_t i = 0; i < values.size(); ++i)
        if (i % 4 != 3) out.push_back(values[i]);
    }
  return out;
}

std::string golden_hash(const std::string& driver, const std::string& graph) {
  Table all = read_table();
  return all[driver][graph];
}

std::string golden_drivers() {
  std::string out;
  for (const auto& [driver, of_graphs] : read_table())
    out += driver + "\n";
  return out;
}

void keep_golden_hash(const std::string& driver, const std::string& graph,
                      const std::string& hash) {
  Table all = read_table();
  all[driver][graph] = hash;
  std::ofstream file(table);
  file << "# SHA-256 of golden frames (golden_show) by driver and graph. DERMIS_GOLDEN_UPDATE=1\n"
          "# build/release/tests/test_passes_device "
          "--gtest_filter='Graphs/Golden.FramesMatchTheStoredHash*'\n"
          "# adds or replaces those of the driver it runs on.\n";
  for (const auto& [name, of_graphs] : all)
    for (const auto& [one, of_frames] : of_graphs)
      file << name << '\t' << one << '\t' << of_frames << '\n';
}

} // namespace dermis::testing
