#include "integration/tools/command/bench/error_table/error_table_file.hpp"

#include "integration/tools/command/bench/error_time/error_time_file.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

void read_root(BenchObject& root, ErrorTableFile& file) {
  root.count("subset", file.subset, 1, 1 << 24);
  root.file("skin", file.skin);
  const NodeId list = root.reader.array("d_px", 1, max_bench_entries);
  if (list.valid())
    for (const NodeId one : children(root.document, list))
      if (const auto d = read_number(root.document, one, "'d_px' of the bench file", min_d_px,
                                     max_d_px, root.diagnostics))
        file.d_px.push_back(*d);
  std::ranges::sort(file.d_px); // as the curves of a table
  file.d_px.erase(std::unique(file.d_px.begin(), file.d_px.end()), file.d_px.end());
  const NodeId choice = root.reader.array("choice", 0, max_bench_entries, Need::optional);
  if (choice.valid())
    for (const NodeId one : children(root.document, choice))
      if (const auto name =
              read_string(root.document, one, "'choice' of the bench file", root.diagnostics))
        file.choice.emplace_back(*name);
  root.entries("scenes", "scene", 0,
               [&](BenchObject& entry) { file.scenes.push_back(read_scene(entry)); });
  root.entries("techniques", "technique", 1, [&](BenchObject& entry) {
    TabledTechnique& technique = file.techniques.emplace_back();
    entry.count("frames", technique.frames, 1, 4096, Need::optional);
    entry.technique(technique);
  });
}

} // namespace

std::optional<ErrorTableFile> read_error_table(const std::string& path, Diagnostics& diagnostics) {
  return read_bench_file<ErrorTableFile>(path, diagnostics, read_root);
}

} // namespace dermis::tools
