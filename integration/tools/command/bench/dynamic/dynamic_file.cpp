#include "integration/tools/command/bench/dynamic/dynamic_file.hpp"

namespace dermis::tools {
namespace {

constexpr int64_t max_sequence_frames = 3600, max_min_samples = 4096;
void read_sequence(BenchObject& entry, SequenceRequest& request) {
  entry.name("scene", request.scene);
  entry.name("framing", request.framing);
  entry.file("file", request.file);
  if (const auto d = entry.reader.number("d_px", min_d_px, max_d_px, Need::optional))
    request.d_px = *d;
  entry.camera(request.camera);
  entry.count("first", request.first, 0, max_sequence_frames, Need::optional);
  entry.count("frames", request.frames, 1, max_sequence_frames);
  entry.flag("still", request.still);
  entry.flag("jitter", request.jitter);
}

void read_guided_technique(BenchObject& entry, DynamicTechnique& technique) {
  entry.technique(technique);
  entry.name("guidance", technique.guidance);
  entry.count("min_samples", technique.min_samples, 0, max_min_samples);
}

} // namespace

std::optional<DynamicFile> read_dynamic(const std::string& path, Diagnostics& diagnostics) {
  return read_bench_file<DynamicFile>(path, diagnostics, [](BenchObject& root, DynamicFile& file) {
    root.count("counted", file.counted, 0, max_sequence_frames);
    root.count("subset", file.subset, 1, 1 << 24);
    root.entries("scenes", "scene", 1,
                 [&](BenchObject& entry) { read_sequence(entry, file.scenes.emplace_back()); });
    root.entries("techniques", "technique", 1, [&](BenchObject& entry) {
      read_guided_technique(entry, file.techniques.emplace_back());
    });
  });
}

} // namespace dermis::tools
