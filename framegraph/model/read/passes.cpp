// Reads "passes": type, condition, ordering and pass-through of each pass. bindings.cpp reads
// ports, pass_settings.cpp settings.

#include "framegraph/model/expression.hpp"
#include "framegraph/model/read/graph_reader.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis {

namespace {

std::string name_of_pass(const GraphReader& reader, size_t index) {
  const std::string& name = reader.graph.passes[index].name;
  return name.empty() ? fmt::format("pass number {}", index + 1) : fmt::format("pass '{}'", name);
}

// Returns all passes of an unknown type, which share one message.
std::vector<size_t> passes_of_type(const GraphReader& reader, std::string_view name) {
  std::vector<size_t> out;
  for (size_t i = 0; i < reader.pass_nodes.size(); ++i) {
    const NodeId pass = reader.pass_nodes[i];
    if (reader.document[pass].kind != NodeKind::object) continue;
    const NodeId type = reader.document.find(pass, "type");
    if (type.valid() && reader.document[type].kind == NodeKind::string &&
        reader.document.text(type) == name)
      out.push_back(i);
  }
  return out;
}

void read_pass_type(GraphReader& reader, ObjectReader& object, PassDeclaration& pass) {
  const auto name = object.string("type");
  if (!name) return;
  pass.type = reader.pass_types.find(*name);
  if (pass.type.valid() || reader.diagnostics.full() ||
      !reader.unknown_pass_types.emplace(*name).second)
    return;
  constexpr size_t max_related = 16;
  const std::vector<size_t> all = passes_of_type(reader, *name);
  const std::string who = all.size() < 2 ? "is"
                                         : fmt::format("and {} other {} are", all.size() - 1,
                                                       all.size() == 2 ? "pass" : "passes");
  std::vector<std::string_view> names;
  for (uint32_t i = 0; i < reader.pass_types.size(); ++i)
    names.push_back(reader.pass_types[{i}].name);
  Diagnostic& one = reader.error(DiagnosticId::unknown_pass_type,
                                 reader.document.where(reader.document.find(object.node(), "type")),
                                 fmt::format("{} {} of the pass type '{}', which is not registered",
                                             object.what(), who, *name));
  one.suggestion = did_you_mean(*name, names);
  for (size_t i = 1; i < std::min(all.size(), max_related + 1); ++i)
    one.related.emplace_back(
        reader.document.where(reader.document.find(reader.pass_nodes[all[i]], "type")),
        fmt::format("{} also has this type", name_of_pass(reader, all[i])));
}

void read_queue(ObjectReader& object, PassDeclaration& pass) {
  constexpr std::string_view words[] = {"main", "async"};
  pass.async = object.word("queue", words, Need::optional).value_or(0) == 1;
}

void read_when(GraphReader& reader, ObjectReader& object, PassDeclaration& pass) {
  if (!object.string("when", Need::optional)) return;
  if (reader.unknown_settings) return;
  const NodeId node = reader.document.find(object.node(), "when");
  const std::string what = fmt::format("'when' of {}", object.what());
  pass.when = parse_expression(reader.document, node, what, reader.graph, reader.broken_settings,
                               reader.diagnostics);
}

void read_otherwise(GraphReader& reader, ObjectReader& object, PassDeclaration& pass,
                    bool writes_known) {
  const NodeId list = object.object("otherwise", Need::optional);
  if (!list.valid()) return;
  const bool serves = pass.type.valid() && reader.pass_types[pass.type].serves_scattering;
  // pass types that serve scattering are also off without a profile
  if (!object.has("when") && !serves) {
    reader.error(DiagnosticId::bad_otherwise, reader.document.where_key(list),
                 fmt::format("{} has no 'when', so it is never off and 'otherwise' never applies",
                             object.what()));
    return;
  }
  for (NodeId node : children(reader.document, list)) {
    const SourceLocation key = reader.document.where_key(node), value = reader.document.where(node);
    const std::string what = fmt::format("'otherwise' of {}", object.what());
    const auto name = read_string(reader.document, node, fmt::format("the replacement in {}", what),
                                  reader.diagnostics);
    const ResourceId output = find_resource(reader, reader.document.key(node), what, key);
    const ResourceId instead = name ? find_resource(reader, *name, what, value) : ResourceId();
    if (!output.valid() || !instead.valid()) continue;
    const ResourceDeclaration& from = reader.graph.resources[output.value];
    const ResourceDeclaration& to = reader.graph.resources[instead.value];
    const auto writes = reader.graph.writes(pass);
    const bool written = std::any_of(writes.begin(), writes.end(), [&](const PortBinding& one) {
      return one.resource == output;
    });
    if (!written && !writes_known) continue;
    if (!written) {
      reader.error(DiagnosticId::bad_otherwise, key,
                   fmt::format("{} replaces '{}', which it does not write", what, from.name));
    } else if (output == instead) {
      reader.error(DiagnosticId::bad_otherwise, value,
                   fmt::format("{} replaces '{}' with itself", what, from.name));
    } else if (from.type != to.type) {
      reader
          .error(DiagnosticId::bad_otherwise, value,
                 fmt::format("{} replaces '{}' with '{}', but one is {} and the other is {}", what,
                             from.name, to.name, type_phrase(from.type), type_phrase(to.type)))
          .related.emplace_back(to.where, fmt::format("'{}' is declared here", to.name));
    } else {
      pass.otherwise.push_back({output, instead, value});
    }
  }
}

void read_after(GraphReader& reader, ObjectReader& object, PassDeclaration& pass, PassId self) {
  const NodeId list = object.array("after", 0, limits::passes, Need::optional);
  if (!list.valid()) return;
  for (NodeId node : children(reader.document, list)) {
    ObjectReader entry(reader.document, node,
                       fmt::format("an entry of 'after' of {}", object.what()), reader.diagnostics);
    const auto name = entry.string("pass");
    const auto reason = entry.string("reason");
    if (!entry.finish() || !name || !reason) continue;
    const SourceLocation where = reader.document.where(reader.document.find(node, "pass"));
    const auto found = reader.pass_names.find(*name);
    if (reason->empty()) {
      reader.error(DiagnosticId::invalid_value,
                   reader.document.where(reader.document.find(node, "reason")),
                   fmt::format("{} has an empty \"reason\"; an order that no data dependency "
                               "requires needs a reason",
                               entry.what()));
    } else if (found == reader.pass_names.end()) {
      Diagnostic& one = reader.error(
          DiagnosticId::unknown_pass, where,
          fmt::format("{} names the pass '{}', which does not exist", entry.what(), *name));
      if (!reader.diagnostics.full())
        one.suggestion = did_you_mean(*name, names_of(reader.pass_names));
    } else if (found->second == self) {
      reader.error(DiagnosticId::unknown_pass, where,
                   fmt::format("{} names the pass itself", entry.what()));
    } else {
      pass.after.push_back({found->second, std::string(*reason), where});
    }
  }
}

} // namespace

void declare_passes(GraphReader& reader, NodeId passes) {
  if (!passes.valid()) return;
  for (NodeId node : children(reader.document, passes)) {
    PassDeclaration pass;
    pass.where = reader.document.where(node);
    const NodeId name = reader.document.find(node, "pass");
    if (name.valid() && reader.document[name].kind == NodeKind::string) {
      pass.name = reader.document.text(name);
      pass.where = reader.document.where(name);
      const auto [entry, added] = reader.pass_names.emplace(
          pass.name, PassId{static_cast<uint32_t>(reader.graph.passes.size())});
      if (!added) {
        reader
            .error(DiagnosticId::duplicate_name, pass.where,
                   fmt::format("two passes have the name '{}'", pass.name))
            .related.emplace_back(reader.graph.passes[entry->second.value].where,
                                  "first declared here");
      }
    }
    reader.graph.passes.push_back(std::move(pass));
    reader.pass_nodes.push_back(node);
  }
}

void read_passes(GraphReader& reader) {
  for (uint32_t i = 0; i < reader.graph.passes.size(); ++i) {
    PassDeclaration& pass = reader.graph.passes[i];
    const NodeId node = reader.pass_nodes[i];
    const std::string what = name_of_pass(reader, i);
    ObjectReader object(reader.document, node, what, reader.diagnostics);
    if (reader.document[node].kind != NodeKind::object) {
      reader.unknown_writes = true;
      continue;
    }
    object.name("pass");
    pass.note = note_of(reader.document, node);
    read_pass_type(reader, object, pass);
    read_queue(object, pass);
    read_when(reader, object, pass);
    const bool writes_known = read_bindings(reader, object, pass);
    if (!writes_known) reader.unknown_writes = true;
    read_pass_settings(reader, object, pass);
    read_otherwise(reader, object, pass, writes_known);
    read_after(reader, object, pass, {i});
    object.finish();
  }
}

} // namespace dermis
