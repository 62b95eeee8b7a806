// Prints a SHA-256 of each plan: all graph files below a folder in every combination of bound
// slots, then random graphs at every packing level and order. usage: plan_digests FOLDER COUNT

#include "framegraph/model/read_graph.hpp"
#include "framegraph/serialize/plan_file.hpp"
#include "passes/common/pass_types.hpp"
#include "tests/framegraph/random_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace {

using namespace dermis;

bool print_digest(const std::string& name, const CompileInput& input) {
  Diagnostics diagnostics;
  const auto compiled = compile(input, diagnostics);
  if (!compiled) {
    fmt::print(stderr, "{}: {}\n", name, format_as_json(diagnostics));
    return false;
  }
  fmt::print("{} {}\n", digest_text(sha256(write_plan(saved_plan(input, compiled->plan)))), name);
  return true;
}

bool digest_file(const std::filesystem::path& path) {
  static const PassTypeRegistry pass_types = subsurface::make_pass_types();
  static const DeviceProfile device = generic_profile();
  Diagnostics diagnostics;
  const auto document = read_document(path.string(), diagnostics);
  const auto graph = document ? read_graph(*document, pass_types, diagnostics) : std::nullopt;
  if (!graph) {
    fmt::print(stderr, "{}\n", format_as_json(diagnostics));
    return false;
  }
  CompileInput input;
  input.graph = &*graph;
  input.pass_types = &pass_types;
  input.device = &device;
  input.view_width = 1920;
  input.view_height = 1080;
  bool good = true;
  for (const bool bound : {true, false}) {
    input.bound.assign(graph->resources.size(), bound);
    good = print_digest(fmt::format("{} {}", path.stem().string(), bound ? "bound" : "unbound"),
                        input) &&
           good;
  }
  return good;
}

bool digest_random(uint64_t seed) {
  const dermis::testing::GraphBuilder builder = dermis::testing::random_graph(seed);
  CompileInput input = builder.input();
  input.packing = static_cast<PackingLevel>(seed % 3);
  input.order = static_cast<PassOrder>(seed / 3 % 3);
  input.single_queue = seed % 2 == 0;
  input.order_seed = seed;
  return print_digest(fmt::format("drawn {}", seed), input);
}

} // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[1])) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".json") && !name.ends_with(".expect.json")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return a.filename() < b.filename(); });
  bool good = !files.empty();
  for (const auto& file : files)
    good = digest_file(file) && good;
  const uint64_t random_graphs = std::strtoull(argv[2], nullptr, 10);
  for (uint64_t seed = 0; seed < random_graphs; ++seed)
    good = digest_random(seed) && good;
  return good ? 0 : 1;
}
