#include "integration/tools/command/bench/error_time/error_time_file.hpp"

namespace dermis::tools {
SceneRequest read_scene(BenchObject& entry) {
  SceneRequest request;
  entry.name("scene", request.scene);
  entry.name("framing", request.framing);
  entry.file("file", request.file, Need::optional);
  entry.camera(request.camera);
  entry.flag("model", request.model);
  entry.flag("study", request.study);
  if (entry.reader.has("class")) {
    entry.name("class", request.member.scene_class);
    entry.name("half", request.member.half);
    if (request.member.half != "tuning" && request.member.half != "judging")
      entry.diagnostics.add(DiagnosticId::invalid_value,
                            entry.document.where(entry.document.find(entry.reader.node(), "half")),
                            "'half' is \"tuning\" or \"judging\"");
  }
  const bool generated = request.file.empty();
  const NodeId list = entry.reader.array("d_px", 1, generated ? max_bench_entries : 1,
                                         generated ? Need::required : Need::optional);
  if (list.valid())
    for (const NodeId one : children(entry.document, list))
      if (const auto d = read_number(entry.document, one, "'d_px' of " + entry.reader.what(),
                                     min_d_px, max_d_px, entry.diagnostics))
        request.d_px.push_back(*d);
  if (entry.reader.ok() && generated && !is_generated(request.scene))
    entry.diagnostics.add(
        DiagnosticId::invalid_value,
        entry.document.where(entry.document.find(entry.reader.node(), "scene")),
        fmt::format("'{}' is not a generated scene; another scene needs a 'file'", request.scene));
  return request;
}

namespace {

void read_self(BenchObject& self, ErrorTimeFile& file) {
  self.name("setting", file.self_setting);
  self.count("samples", file.self_samples, 64, 65536);
  self.count("window", file.self_window, 8, 16384, Need::optional);
  const NodeId list = self.reader.array("scenes", 0, max_bench_entries);
  if (!list.valid()) return;
  for (const NodeId one : children(self.document, list))
    if (const auto text = read_string(self.document, one, "a scene of 'self'", self.diagnostics))
      file.self_scenes.emplace_back(*text);
}

void read_error_time_root(BenchObject& root, ErrorTimeFile& file) {
  root.count("repetitions", file.repetitions, 0, 1000);
  root.count("warm_up", file.warm_up, 1, 100);
  root.count("row_milliseconds", file.row_milliseconds, 0, 1'000'000, Need::optional);
  root.count("min_repetitions", file.min_repetitions, 1, 1000, Need::optional);
  root.count("subset", file.subset, 1, 1 << 24);
  root.file("skin", file.skin);
  root.flag("family", file.family);
  root.object("baseline", Need::required, [&](BenchObject& baseline) {
    baseline.name("technique", file.baseline_technique);
    baseline.text("setting", file.baseline_setting);
  });
  root.object("self", Need::required, [&](BenchObject& self) { read_self(self, file); });
  root.entries("scenes", "scene", 1,
               [&](BenchObject& entry) { file.scenes.push_back(read_scene(entry)); });
  root.entries("techniques", "technique", 1,
               [&](BenchObject& entry) { entry.technique(file.techniques.emplace_back()); });
}

} // namespace

std::optional<ErrorTimeFile> read_error_time(const std::string& path, Diagnostics& diagnostics) {
  return read_bench_file<ErrorTimeFile>(path, diagnostics, read_error_time_root);
}

} // namespace dermis::tools
