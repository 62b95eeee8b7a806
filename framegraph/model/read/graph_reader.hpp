#pragma once
// What the parts of read_graph share: the graph as far as it is read, and the names declared in it.

#include "framegraph/model/graph.hpp"
#include "framegraph/text/document.hpp"
#include "framegraph/text/reader.hpp"

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dermis {

struct GraphReader {
  GraphReader(const Document& from, const PassTypeRegistry& registry, Diagnostics& errors)
      : document(from), pass_types(registry), diagnostics(errors) {}

  const Document& document;
  const PassTypeRegistry& pass_types;
  Diagnostics& diagnostics;
  Graph graph;

  // All names are declared before anything that refers to them is read.
  std::map<std::string, SettingId, std::less<>> setting_names;
  std::map<std::string, ResourceId, std::less<>> resource_names;
  std::map<std::string, PassId, std::less<>> pass_names;
  // Declared, but with errors: whatever depends on them is not checked.
  std::vector<bool> broken_settings, broken_resources;
  // Some names could not be read at all: one that is not found may be among them, and is no error.
  bool unknown_settings = false, unknown_resources = false;
  bool unknown_writes = false; // some pass writes something that could not be read
  // The message that a resource's formats do not fit a port: further ports are added to it. Indices into
  // Diagnostics::list.
  std::map<ResourceId, size_t> format_mismatches;
  // "requires" of choices: read when all imports are known.
  std::vector<std::pair<SettingId, NodeId>> option_requirements;
  std::set<std::string, std::less<>> unknown_pass_types; // reported, each with all its passes
  // Where each resource and pass is read from, by id.
  std::vector<NodeId> resource_nodes, pass_nodes;

  Diagnostic& error(DiagnosticId id, SourceLocation where, std::string text) {
    return diagnostics.add(id, std::move(where), std::move(text));
  }
};

// PortBinding::port while reading, where the pass type or its port is unknown. Never in a graph that is
// handed out.
inline constexpr uint32_t unknown_port = 0xffffffffu;

// In the order in which read_graph calls them. Invalid nodes (a key that is absent or mistyped) read as
// empty.
void read_settings(GraphReader& reader, NodeId settings);
void declare_resources(GraphReader& reader, NodeId list, Origin origin);
void read_resources(GraphReader& reader);
void read_option_requirements(GraphReader& reader);
void read_graph_requirements(GraphReader& reader, NodeId list);
void read_exports(GraphReader& reader, NodeId exports);
void declare_passes(GraphReader& reader, NodeId passes);
void read_passes(GraphReader& reader);
void check_producers(GraphReader& reader);
void check_reads(GraphReader& reader);       // what is read may be, in each state of the settings
void check_needs(const GraphReader& reader); // of a graph without errors

// Parts of passes. `pass` is the object at /passes/N; `what` names it in messages.
// read_bindings: false when something that the pass writes is not known.
bool read_bindings(GraphReader& reader, ObjectReader& pass, PassDeclaration& out);
void read_pass_settings(GraphReader& reader, ObjectReader& pass, PassDeclaration& out);

// A resource by name; invalid after an error at `where`, or silently when some names are unknown.
ResourceId find_resource(GraphReader& reader, std::string_view name, std::string_view what,
                         const SourceLocation& where);

// Names of a map in order, for suggestions.
template <class Id>
std::vector<std::string_view> names_of(const std::map<std::string, Id, std::less<>>& map) {
  std::vector<std::string_view> out;
  for (const auto& [name, id] : map)
    out.push_back(name);
  return out;
}

// Whether two parts of one image have a mip of a layer in common.
bool meet(const ImagePart& a, const ImagePart& b);
// Imports and exports: the host may bind an image of any declared format.
inline bool may_be_host_owned(const ResourceDeclaration& resource) {
  return resource.origin == Origin::imported || resource.exported;
}
// Whether the port works with what `resource` can become: with all formats of which the host may bind one, or
// with one of those from which the compiler chooses.
bool formats_fit(const Port& port, const ResourceDeclaration& resource);
std::string formats_taken(const Port& port); // all that it works with: "'r16f' or 'r32f'"
// One message a resource, however many ports its formats do not fit. `port` says what is bound at `where`.
void report_formats(GraphReader& reader, ResourceId id, const SourceLocation& where, const std::string& port);

// "note" of an object, "" where there is none or it is no string (which the object's reader reports).
std::string note_of(const Document& document, NodeId object);

} // namespace dermis
