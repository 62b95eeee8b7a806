#include "integration/tools/command/bench/restir/restir_file.hpp"

#include "integration/tools/command/shipped.hpp"

#include <fmt/format.h>

namespace dermis::tools {
namespace {

constexpr size_t max_entries = 256;
constexpr int64_t max_frames = 3600, max_samples = 1024;
constexpr double max_thin_mm = 1000;

void read_scene(const Document& document, NodeId node, Diagnostics& diagnostics, RestirFile& file) {
  ObjectReader object(document, node, fmt::format("scene {}", file.scenes.size()), diagnostics);
  SceneRequest request;
  if (const auto name = object.name("scene")) request.scene = *name;
  if (const auto path = object.string("file")) request.file = shipped(std::string(*path));
  request.camera = read_camera(document, object, diagnostics);
  if (const auto flag = object.boolean("model", Need::optional)) request.model = *flag;
  if (object.finish()) file.scenes.push_back(std::move(request));
}

void read_reference(const Document& document, NodeId node, Diagnostics& diagnostics, RestirFile& file) {
  ObjectReader object(document, node, "'reference'", diagnostics);
  if (const auto n = object.integer("samples", 1, max_samples)) file.reference.samples = uint32_t(*n);
  if (const auto n = object.integer("frames", 2, max_frames)) file.reference.frames = uint32_t(*n);
  object.finish();
}

} // namespace

std::optional<RestirFile> read_restir(const std::string& path, Diagnostics& diagnostics) {
  const auto document = read_document(path, diagnostics);
  if (!document || !check_version(*document, "dermis_benchmark", 1, diagnostics)) return std::nullopt;
  RestirFile file;
  ObjectReader object(*document, document->root(), "the bench file", diagnostics);
  object.integer("dermis_benchmark", 1, 1);
  if (const auto name = object.string("graph")) file.graph = shipped(std::string(*name));
  if (const auto n = object.integer("settle", 1, max_frames)) file.settle = uint32_t(*n);
  if (const auto n = object.integer("frames", 1, max_frames)) file.frames = uint32_t(*n);
  if (const auto n = object.integer("repetitions", 1, max_frames)) file.repetitions = uint32_t(*n);
  if (const auto mm = object.number("thin_mm", 0, max_thin_mm)) file.thin_mm = *mm;
  const NodeId samples = object.array("samples", 1, max_entries);
  const NodeId reference = object.object("reference");
  const NodeId scenes = object.array("scenes", 1, max_entries);
  const NodeId techniques = object.array("screen_space", 0, max_entries);
  object.finish();
  if (samples.valid())
    for (const NodeId node : children(*document, samples))
      if (const auto n = read_number(*document, node, "'samples'", 1, double(max_samples), diagnostics))
        file.samples.push_back(uint32_t(*n));
  if (reference.valid()) read_reference(*document, reference, diagnostics, file);
  if (scenes.valid())
    for (const NodeId node : children(*document, scenes))
      read_scene(*document, node, diagnostics, file);
  if (techniques.valid())
    for (const NodeId node : children(*document, techniques)) {
      ObjectReader entry(*document, node, fmt::format("technique {}", file.screen_space.size()), diagnostics);
      TechniqueRequest request = read_technique(*document, entry, diagnostics);
      if (entry.finish()) file.screen_space.push_back(std::move(request));
    }
  if (diagnostics.has_errors()) return std::nullopt;
  return file;
}

} // namespace dermis::tools
