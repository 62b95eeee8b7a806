#include "integration/tools/command/bench/suite/bench_file.hpp"

namespace dermis::tools {

void BenchObject::name(std::string_view key, std::string& value) {
  if (const auto found = reader.name(key)) value = *found;
}

void BenchObject::text(std::string_view key, std::string& value) {
  if (const auto found = reader.string(key)) value = *found;
}

void BenchObject::file(std::string_view key, std::string& value, Need need) {
  if (const auto found = reader.string(key, need)) value = shipped(std::string(*found));
}

void BenchObject::flag(std::string_view key, bool& value) {
  if (const auto found = reader.boolean(key, Need::optional)) value = *found;
}

void BenchObject::count(std::string_view key, uint32_t& value, int64_t minimum, int64_t maximum,
                        Need need) {
  if (const auto found = reader.integer(key, minimum, maximum, need))
    value = static_cast<uint32_t>(*found);
}

void BenchObject::camera(std::optional<demo::CameraPlace>& place) {
  object("camera", Need::optional, [&](BenchObject& camera) {
    place.emplace();
    camera.reader.numbers("position", place->position, -1000, 1000);
    camera.reader.numbers("target", place->target, -1000, 1000);
    if (const auto fov = camera.reader.number("vertical_fov", 1, 150)) place->vertical_fov = *fov;
  });
}

void BenchObject::technique(TechniqueRequest& request) {
  name("technique", request.technique);
  text("setting", request.setting);
  file("graph", request.graph);
  flag("heat_map", request.heat_map);
  const std::string& what = reader.what();
  if (const NodeId list = reader.array("overlays", 1, max_bench_entries, Need::optional);
      list.valid())
    for (const NodeId one : children(document, list))
      if (const auto path =
              read_string(document, one, fmt::format("an overlay of {}", what), diagnostics))
        request.overlays.push_back(shipped(std::string(*path)));
  const NodeId set = reader.object("set", Need::optional);
  if (!set.valid()) return;
  for (const NodeId one : children(document, set)) {
    const std::string setting(document.key(one));
    if (document[one].kind == NodeKind::integer)
      request.set.emplace_back(setting, fmt::format("{}", document[one].integer));
    else if (const auto value =
                 read_string(document, one, fmt::format("'{}' of {}", setting, what), diagnostics))
      request.set.emplace_back(setting, std::string(*value));
  }
}

} // namespace dermis::tools
