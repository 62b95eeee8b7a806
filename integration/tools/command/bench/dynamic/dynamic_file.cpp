#include "integration/tools/command/bench/dynamic/dynamic_file.hpp"

#include "integration/tools/command/shipped.hpp"

#include <fmt/format.h>

namespace dermis::tools {
namespace {

constexpr size_t max_entries = 256;
constexpr int64_t max_frames = 3600, max_samples = 4096;
constexpr double min_d_px = 0.05, max_d_px = 64;

void read_scene(const Document& document, NodeId node, Diagnostics& diagnostics, DynamicFile& file) {
  ObjectReader object(document, node, fmt::format("scene {}", file.scenes.size()), diagnostics);
  SequenceRequest request;
  if (const auto name = object.name("scene")) request.scene = *name;
  if (const auto name = object.name("framing")) request.framing = *name;
  if (const auto path = object.string("file")) request.file = shipped(std::string(*path));
  if (const auto d = object.number("d_px", min_d_px, max_d_px, Need::optional)) request.d_px = *d;
  request.camera = read_camera(document, object, diagnostics);
  if (const auto n = object.integer("first", 0, max_frames, Need::optional)) request.first = uint32_t(*n);
  if (const auto n = object.integer("frames", 1, max_frames)) request.frames = uint32_t(*n);
  if (const auto flag = object.boolean("still", Need::optional)) request.still = *flag;
  if (object.finish()) file.scenes.push_back(std::move(request));
}

void read_one_technique(const Document& document, NodeId node, Diagnostics& diagnostics, DynamicFile& file) {
  ObjectReader object(document, node, fmt::format("technique {}", file.techniques.size()), diagnostics);
  DynamicTechnique technique;
  technique.request = read_technique(document, object, diagnostics);
  if (const auto name = object.name("guidance")) technique.guidance = *name;
  if (const auto n = object.integer("min_samples", 0, max_samples)) technique.min_samples = uint32_t(*n);
  if (object.finish()) file.techniques.push_back(std::move(technique));
}

} // namespace

std::optional<DynamicFile> read_dynamic(const std::string& path, Diagnostics& diagnostics) {
  const auto document = read_document(path, diagnostics);
  if (!document || !check_version(*document, "dermis_benchmark", 1, diagnostics)) return std::nullopt;
  DynamicFile file;
  ObjectReader object(*document, document->root(), "the bench file", diagnostics);
  object.integer("dermis_benchmark", 1, 1);
  if (const auto n = object.integer("counted", 0, max_frames)) file.counted = uint32_t(*n);
  if (const auto n = object.integer("subset", 1, 1 << 24)) file.subset = uint32_t(*n);
  const NodeId scenes = object.array("scenes", 1, max_entries);
  const NodeId techniques = object.array("techniques", 1, max_entries);
  object.finish();
  if (scenes.valid())
    for (const NodeId node : children(*document, scenes))
      read_scene(*document, node, diagnostics, file);
  if (techniques.valid())
    for (const NodeId node : children(*document, techniques))
      read_one_technique(*document, node, diagnostics, file);
  if (diagnostics.has_errors()) return std::nullopt;
  return file;
}

} // namespace dermis::tools
