#include "integration/tools/command/bench/truth/truth_file.hpp"

#include "framegraph/text/reader.hpp"
#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

constexpr size_t max_techniques = 256;

Tolerances read_tolerances(const Document& document, NodeId list, const std::string& what,
                           Diagnostics& diagnostics) {
  const std::vector<std::string_view> properties = plane_property_names();
  Tolerances tolerances;
  for (const NodeId one : children(document, list)) {
    const std::string property(document.key(one));
    if (std::find(properties.begin(), properties.end(), property) == properties.end()) {
      diagnostics
          .add(DiagnosticId::unknown_key, document.where_key(one),
               fmt::format("there is no property '{}'", property))
          .suggestion = did_you_mean(property, properties);
      continue;
    }
    if (const auto value =
            read_number(document, one, fmt::format("'{}' of {}", property, what), 0, 10, diagnostics))
      tolerances.emplace_back(property, *value);
  }
  return tolerances;
}

} // namespace

std::optional<PropertyFile> read_property_file(const std::string& path, Diagnostics& diagnostics) {
  const auto document = read_document(path, diagnostics);
  if (!document || !check_version(*document, "dermis_benchmark", 1, diagnostics)) return std::nullopt;
  PropertyFile file;
  ObjectReader root(*document, document->root(), "the bench file", diagnostics);
  root.integer("dermis_benchmark", 1, 1);
  if (const NodeId node = root.object("truth"); node.valid())
    file.reference = read_tolerances(*document, node, "the reference", diagnostics);
  if (const NodeId list = root.array("techniques", 1, max_techniques); list.valid())
    for (const NodeId node : children(*document, list)) {
      ObjectReader object(*document, node, fmt::format("technique {}", file.techniques.size()), diagnostics);
      PropertyTechnique technique;
      technique.request = read_technique(*document, object, diagnostics);
      if (const NodeId tolerances = object.object("tolerances"); tolerances.valid())
        technique.tolerances = read_tolerances(*document, tolerances, object.what(), diagnostics);
      object.finish();
      file.techniques.push_back(std::move(technique));
    }
  root.finish();
  if (diagnostics.has_errors()) return std::nullopt;
  return file;
}

} // namespace dermis::tools
