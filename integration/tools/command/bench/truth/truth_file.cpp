#include "integration/tools/command/bench/truth/truth_file.hpp"

#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

Tolerances read_tolerances(BenchObject& object, std::string_view key) {
  const std::vector<std::string_view> properties = plane_property_names();
  Tolerances tolerances;
  const NodeId list = object.reader.object(key, Need::required);
  if (!list.valid()) return tolerances;
  for (const NodeId one : children(object.document, list)) {
    const std::string property(object.document.key(one));
    if (std::find(properties.begin(), properties.end(), property) == properties.end()) {
      object.diagnostics
          .add(DiagnosticId::unknown_key, object.document.where_key(one),
               fmt::format("there is no property '{}'", property))
          .suggestion = did_you_mean(property, properties);
      continue;
    }
    if (const auto value = read_number(object.document, one,
                                       fmt::format("'{}' of {}", property, object.reader.what()), 0,
                                       10, object.diagnostics))
      tolerances.emplace_back(property, *value);
  }
  return tolerances;
}

} // namespace

std::optional<PropertyFile> read_property_file(const std::string& path, Diagnostics& diagnostics) {
  return read_bench_file<PropertyFile>(
      path, diagnostics, [](BenchObject& root, PropertyFile& file) {
        file.reference = read_tolerances(root, "truth");
        root.entries("techniques", "technique", 1, [&](BenchObject& entry) {
          PropertyTechnique& technique = file.techniques.emplace_back();
          entry.technique(technique);
          technique.tolerances = read_tolerances(entry, "tolerances");
        });
      });
}

} // namespace dermis::tools
