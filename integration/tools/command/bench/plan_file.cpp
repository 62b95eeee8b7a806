#include "integration/tools/command/bench/plan_file.hpp"

#include "framegraph/text/reader.hpp"
#include "integration/tools/command/shipped.hpp"

#include <fmt/format.h>

#include <array>

namespace dermis::tools {
namespace {

constexpr size_t max_entries = 256;
constexpr double min_d_px = 0.05, max_d_px = 64;

struct FileReader {
  const Document& document;
  Diagnostics& diagnostics;
  ErrorTimeFile& file;

  void scene(NodeId node, size_t number) {
    ObjectReader object(document, node, fmt::format("scene {}", number), diagnostics);
    SceneRequest request;
    if (const auto name = object.name("scene")) request.scene = *name;
    if (const auto name = object.name("framing")) request.framing = *name;
    if (const auto path = object.string("file", Need::optional)) request.file = shipped(std::string(*path));
    request.camera = read_camera(document, object, diagnostics);
    if (const auto flag = object.boolean("model", Need::optional)) request.model = *flag;
    if (const auto flag = object.boolean("study", Need::optional)) request.study = *flag;
    const bool generated = request.file.empty();
    const NodeId list =
        object.array("d_px", 1, generated ? max_entries : 1, generated ? Need::required : Need::optional);
    if (list.valid())
      for (const NodeId one : children(document, list))
        if (const auto d =
                read_number(document, one, "'d_px' of " + object.what(), min_d_px, max_d_px, diagnostics))
          request.d_px.push_back(*d);
    if (!object.finish()) return;
    if (generated && !is_generated(request.scene))
      diagnostics.add(DiagnosticId::invalid_value, document.where(document.find(node, "scene")),
                      fmt::format("'{}' is no generated scene; another scene needs a 'file'", request.scene));
    else
      file.scenes.push_back(std::move(request));
  }

  void technique(NodeId node, size_t number) {
    ObjectReader object(document, node, fmt::format("technique {}", number), diagnostics);
    TechniqueRequest request = read_technique(document, object, diagnostics);
    if (object.finish()) file.techniques.push_back(std::move(request));
  }

  void baseline(ObjectReader& root) {
    const NodeId node = root.object("baseline");
    if (!node.valid()) return;
    ObjectReader object(document, node, "the baseline", diagnostics);
    if (const auto name = object.name("technique")) file.baseline_technique = *name;
    if (const auto text = object.string("setting")) file.baseline_setting = *text;
    object.finish();
  }

  void self(ObjectReader& root) {
    const NodeId node = root.object("self");
    if (!node.valid()) return;
    ObjectReader object(document, node, "'self'", diagnostics);
    if (const auto name = object.name("setting")) file.self_setting = *name;
    if (const auto count = object.integer("samples", 64, 65536))
      file.self_samples = static_cast<uint32_t>(*count);
    if (const auto side = object.integer("window", 8, 16384, Need::optional))
      file.self_window = static_cast<uint32_t>(*side);
    const NodeId list = object.array("scenes", 0, max_entries);
    if (list.valid())
      for (const NodeId one : children(document, list))
        if (const auto text = read_string(document, one, "a scene of 'self'", diagnostics))
          file.self_scenes.emplace_back(*text);
    object.finish();
  }

  void root() {
    ObjectReader object(document, document.root(), "the bench file", diagnostics);
    object.integer("dermis_benchmark", 1, 1);
    if (const auto n = object.integer("repetitions", 1, 1000)) file.repetitions = static_cast<uint32_t>(*n);
    if (const auto n = object.integer("warm_up", 1, 100)) file.warm_up = static_cast<uint32_t>(*n);
    if (const auto n = object.integer("row_milliseconds", 0, 1'000'000, Need::optional))
      file.row_milliseconds = static_cast<uint32_t>(*n);
    if (const auto n = object.integer("least_repetitions", 1, 1000, Need::optional))
      file.min_repetitions = static_cast<uint32_t>(*n);
    if (const auto n = object.integer("subset", 1, 1 << 24)) file.subset = static_cast<uint32_t>(*n);
    if (const auto path = object.string("skin")) file.skin = shipped(std::string(*path));
    baseline(object);
    self(object);
    const NodeId scenes = object.array("scenes", 1, max_entries);
    const NodeId techniques = object.array("techniques", 1, max_entries);
    size_t number = 0;
    if (scenes.valid())
      for (const NodeId node : children(document, scenes))
        scene(node, number++);
    number = 0;
    if (techniques.valid())
      for (const NodeId node : children(document, techniques))
        technique(node, number++);
    object.finish();
  }
};

} // namespace

std::optional<demo::CameraPlace> read_camera(const Document& document, ObjectReader& entry,
                                             Diagnostics& diagnostics) {
  const NodeId node = entry.object("camera", Need::optional);
  if (!node.valid()) return std::nullopt;
  demo::CameraPlace place;
  ObjectReader object(document, node, "the camera of " + entry.what(), diagnostics);
  object.numbers("position", place.position, -1000, 1000);
  object.numbers("target", place.target, -1000, 1000);
  if (const auto fov = object.number("vertical_fov", 1, 150)) place.vertical_fov = *fov;
  object.finish();
  return place;
}

TechniqueRequest read_technique(const Document& document, ObjectReader& object, Diagnostics& diagnostics) {
  TechniqueRequest request;
  if (const auto name = object.name("technique")) request.technique = *name;
  if (const auto text = object.string("setting")) request.setting = *text;
  if (const auto path = object.string("graph")) request.graph = shipped(std::string(*path));
  if (const auto flag = object.boolean("heat_map", Need::optional)) request.heat_map = *flag;
  if (const NodeId list = object.array("overlays", 1, max_entries, Need::optional); list.valid())
    for (const NodeId one : children(document, list))
      if (const auto path =
              read_string(document, one, fmt::format("an overlay of {}", object.what()), diagnostics))
        request.overlays.push_back(shipped(std::string(*path)));
  const NodeId set = object.object("set", Need::optional);
  if (!set.valid()) return request;
  for (const NodeId one : children(document, set)) {
    const Node& value = document[one];
    const std::string name(document.key(one));
    if (value.kind == NodeKind::integer)
      request.set.emplace_back(name, fmt::format("{}", value.integer));
    else if (const auto text =
                 read_string(document, one, fmt::format("'{}' of {}", name, object.what()), diagnostics))
      request.set.emplace_back(name, std::string(*text));
  }
  return request;
}

std::optional<ErrorTimeFile> read_error_time(const std::string& path, Diagnostics& diagnostics) {
  const auto document = read_document(path, diagnostics);
  if (!document || !check_version(*document, "dermis_benchmark", 1, diagnostics)) return std::nullopt;
  ErrorTimeFile file;
  FileReader{*document, diagnostics, file}.root();
  if (diagnostics.has_errors()) return std::nullopt;
  return file;
}

} // namespace dermis::tools
