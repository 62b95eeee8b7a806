// Reads "requires" of a graph and of the options of a choice: device features and optional imports.

#include "framegraph/model/read/graph_reader.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis {
namespace {

std::vector<std::string_view> feature_words() {
  std::vector<std::string_view> words;
  for (uint32_t f = 0; f < static_cast<uint32_t>(Feature::count); ++f)
    words.push_back(feature_name(static_cast<Feature>(f)));
  return words;
}

// Reads one entry of an option's list: a feature or an optional import.
bool read_need(GraphReader& reader, NodeId node, const std::string& what, OptionNeeds& needs) {
  const auto word = read_string(reader.document, node, what, reader.diagnostics);
  if (!word) return false;
  if (const auto feature = feature_from_name(*word)) {
    needs.features |= bit_of(*feature);
    return true;
  }
  const SourceLocation where = reader.document.where(node);
  const auto found = reader.resource_names.find(*word);
  if (found == reader.resource_names.end()) {
    if (reader.unknown_resources) return false;
    std::vector<std::string_view> words = feature_words();
    for (const std::string_view name : names_of(reader.resource_names))
      words.push_back(name);
    reader
        .error(
            DiagnosticId::bad_option_requires, where,
            fmt::format("{} is '{}', which is neither a device feature nor an import", what, *word))
        .suggestion = did_you_mean(*word, words);
    return false;
  }
  const ResourceDeclaration& resource = reader.graph.resources[found->second.value];
  if (resource.origin == Origin::imported && resource.optional) {
    needs.imports.push_back(found->second);
    return true;
  }
  const NodeId optional =
      reader.document.find(reader.resource_nodes[found->second.value], "optional");
  if (optional.valid() && reader.document[optional].kind != NodeKind::boolean)
    return false; // reported at the import
  reader
      .error(DiagnosticId::bad_option_requires, where,
             fmt::format("{} is '{}', which is not an optional import", what, *word))
      .related.emplace_back(resource.where, fmt::format("'{}' is declared here", resource.name));
  return false;
}

bool read_option_needs(GraphReader& reader, NodeId entry, SettingDeclaration& setting) {
  const std::string_view key = reader.document.key(entry);
  const std::string what =
      fmt::format("a requirement of the option '{}' of setting '{}'", key, setting.name);
  if (!expect_kind(reader.document, entry, fmt::format("'requires' of the option '{}'", key),
                   NodeKind::array, reader.diagnostics))
    return false;
  const auto option = std::find(setting.options.begin(), setting.options.end(), key);
  if (option == setting.options.end()) {
    for (const NodeId node : children(reader.document, entry))
      (void)read_string(reader.document, node, what, reader.diagnostics);
    const std::vector<std::string_view> words(setting.options.begin(), setting.options.end());
    reader
        .error(
            DiagnosticId::bad_option_requires, reader.document.where_key(entry),
            fmt::format("'requires' of setting '{}' names '{}', which is not one of its options {}",
                        setting.name, key, list_words(words)))
        .suggestion = did_you_mean(key, words);
    return false;
  }
  bool ok = true;
  OptionNeeds& needs = setting.needs[static_cast<size_t>(option - setting.options.begin())];
  for (const NodeId node : children(reader.document, entry))
    ok &= read_need(reader, node, what, needs);
  return ok;
}

} // namespace

void read_option_requirements(GraphReader& reader) {
  for (const auto& [id, node] : reader.option_requirements) {
    if (reader.broken_settings[id.value]) continue;
    SettingDeclaration& setting = reader.graph.settings[id.value];
    setting.needs.resize(setting.options.size());
    bool ok = true;
    for (const NodeId entry : children(reader.document, node))
      ok &= read_option_needs(reader, entry, setting);
    const auto free = [](const OptionNeeds& needs) {
      return needs.features == 0 && needs.imports.empty();
    };
    if (!ok || std::any_of(setting.needs.begin(), setting.needs.end(), free)) continue;
    reader.error(DiagnosticId::bad_option_requires, reader.document.where_key(node),
                 fmt::format("every option of setting '{}' has requirements; at least one option "
                             "must require nothing",
                             setting.name));
  }
}

void read_graph_requirements(GraphReader& reader, NodeId list) {
  if (!list.valid()) return;
  reader.graph.requires_where = reader.document.where_key(list);
  const std::vector<std::string_view> words = feature_words();
  for (const NodeId node : children(reader.document, list))
    if (const auto word =
            read_word(reader.document, node, "an entry of 'requires'", words, reader.diagnostics))
      reader.graph.features |= bit_of(static_cast<Feature>(*word));
}

} // namespace dermis
