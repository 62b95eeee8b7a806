#include "framegraph/model/read_graph.hpp"

#include "framegraph/compose/format_version.hpp"
#include "framegraph/model/read/graph_reader.hpp"
#include "framegraph/text/limits.hpp"

namespace dermis {

std::string note_of(const Document& document, NodeId object) {
  const NodeId note = document.find(object, "note");
  return note.valid() && document[note].kind == NodeKind::string ? std::string(document.text(note))
                                                                 : std::string();
}

std::optional<Graph> read_graph(const Document& document, const PassTypeRegistry& pass_types,
                                Diagnostics& diagnostics) {
  if (!check_version(document, "dermis", graph_format_version, diagnostics)) return std::nullopt;
  const uint64_t errors_before = diagnostics.errors();

  GraphReader reader(document, pass_types, diagnostics);
  ObjectReader root(document, document.root(), "the graph", diagnostics);
  root.any("dermis");
  if (const auto name = root.name("name")) reader.graph.name = *name;
  const NodeId requirements = root.array("requires", 0, limits::options, Need::optional);
  const NodeId settings = root.object("settings", Need::optional);
  const NodeId imports = root.object("imports", Need::optional);
  const NodeId resources = root.object("resources", Need::optional);
  const NodeId passes = root.array("passes", 0, limits::passes);
  const NodeId exports = root.array("exports", 0, limits::resources);
  const uint64_t errors_so_far = diagnostics.errors();
  root.finish();
  // A section is unread if it has the wrong type, or possibly if it is absent while there is an
  // unknown key.
  const bool misspelt = diagnostics.errors() != errors_so_far;
  const auto unread = [&](std::string_view key, NodeId section) {
    return !section.valid() && (misspelt || root.has(key));
  };
  reader.unknown_settings = unread("settings", settings);
  reader.unknown_resources = unread("imports", imports) || unread("resources", resources);
  reader.unknown_writes = !passes.valid();

  read_settings(reader, settings);
  declare_resources(reader, imports, Origin::imported);
  declare_resources(reader, resources, Origin::transient);
  read_resources(reader);
  read_option_requirements(reader);
  read_graph_requirements(reader, requirements);
  read_exports(reader, exports);
  declare_passes(reader, passes);
  read_passes(reader);
  check_producers(reader);
  check_reads(reader);
  if (diagnostics.errors() == errors_before) check_needs(reader);
  if (diagnostics.errors() != errors_before) return std::nullopt;
  return std::move(reader.graph);
}

} // namespace dermis
