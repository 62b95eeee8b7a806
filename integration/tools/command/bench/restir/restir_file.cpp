#include "integration/tools/command/bench/restir/restir_file.hpp"

namespace dermis::tools {
namespace {

constexpr int64_t max_ray_frames = 3600, max_paths = 1024;
constexpr double max_thin_mm = 1000;

void read_ray_scene(BenchObject& entry, SceneRequest& request) {
  entry.name("scene", request.scene);
  entry.file("file", request.file);
  entry.camera(request.camera);
  entry.flag("model", request.model);
}

void read_restir_root(BenchObject& root, RestirFile& file) {
  root.file("graph", file.graph);
  root.count("settle", file.settle, 1, max_ray_frames);
  root.count("frames", file.frames, 1, max_ray_frames);
  root.count("repetitions", file.repetitions, 1, max_ray_frames);
  if (const auto mm = root.reader.number("thin_mm", 0, max_thin_mm)) file.thin_mm = *mm;
  if (const NodeId list = root.reader.array("samples", 1, max_bench_entries); list.valid())
    for (const NodeId node : children(root.document, list))
      if (const auto n =
              read_integer(root.document, node, "'samples'", 1, max_paths, root.diagnostics))
        file.samples.push_back(uint32_t(*n));
  root.object("reference", Need::required, [&](BenchObject& reference) {
    reference.count("samples", file.reference.samples, 1, max_paths);
    reference.count("frames", file.reference.frames, 2, max_ray_frames);
  });
  root.entries("scenes", "scene", 1,
               [&](BenchObject& entry) { read_ray_scene(entry, file.scenes.emplace_back()); });
  root.entries("screen_space", "technique", 0,
               [&](BenchObject& entry) { entry.technique(file.screen_space.emplace_back()); });
}

} // namespace

std::optional<RestirFile> read_restir(const std::string& path, Diagnostics& diagnostics) {
  return read_bench_file<RestirFile>(path, diagnostics, read_restir_root);
}

} // namespace dermis::tools
