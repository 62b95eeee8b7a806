#pragma once
// Shared state of read_graph: the graph read so far and the names declared in it.

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

  // All names are declared before any reference is read.
  std::map<std::string, SettingId, std::less<>> setting_names;
  std::map<std::string, ResourceId, std::less<>> resource_names;
  std::map<std::string, PassId, std::less<>> pass_names;
  // Declared with errors; anything that depends on them is not checked.
  std::vector<bool> broken_settings, broken_resources;
  // Some names could not be read, so an unknown name may be among them and is not an error.
  bool unknown_settings = false, unknown_resources = false;
  bool unknown_writes = false; // some pass writes something that could not be read
  // By resource: index into Diagnostics::list of its format error, to which further ports are
  // added.
  std::map<ResourceId, size_t> format_mismatches;
  // "requires" of choices; read once all imports are known.
  std::vector<std::pair<SettingId, NodeId>> option_requirements;
  std::set<std::string, std::less<>> unknown_pass_types; // reported, each with all its passes
  // Document node of each resource and pass, by id.
  std::vector<NodeId> resource_nodes, pass_nodes;

  Diagnostic& error(DiagnosticId id, SourceLocation where, std::string text) {
    return diagnostics.add(id, std::move(where), std::move(text));
  }
};

// Value of PortBinding::port if the pass type or its port is unknown. Never occurs in a finished
// graph.
inline constexpr uint32_t unknown_port = 0xffffffffu;

// Steps of read_graph, in call order. Invalid nodes (absent or mistyped keys) read as empty.
void read_settings(GraphReader& reader, NodeId settings);
void declare_resources(GraphReader& reader, NodeId list, Origin origin);
void read_resources(GraphReader& reader);
void read_option_requirements(GraphReader& reader);
void read_graph_requirements(GraphReader& reader, NodeId list);
void read_exports(GraphReader& reader, NodeId exports);
void declare_passes(GraphReader& reader, NodeId passes);
void read_passes(GraphReader& reader);
void check_producers(GraphReader& reader);
void check_reads(GraphReader& reader);       // checks that reads are allowed for all setting values
void check_needs(const GraphReader& reader); // requires a graph without errors

// Read parts of passes. `pass` is the object at /passes/N. read_bindings returns false if some
// write is not known.
bool read_bindings(GraphReader& reader, ObjectReader& pass, PassDeclaration& out);
void read_pass_settings(GraphReader& reader, ObjectReader& pass, PassDeclaration& out);

// Returns a resource by name; invalid after an error at `where`, or silently if some names are
// unknown.
ResourceId find_resource(GraphReader& reader, std::string_view name, std::string_view what,
                         const SourceLocation& where,
                         std::string_view problem = "which is not declared");

// Returns the names of a map in order, for suggestions.
template <class Id>
std::vector<std::string_view> names_of(const std::map<std::string, Id, std::less<>>& map) {
  std::vector<std::string_view> out;
  for (const auto& [name, id] : map)
    out.push_back(name);
  return out;
}

// Returns whether two ranges of one image have a mip of a layer in common.
bool overlap(const ImageRange& a, const ImageRange& b);
// Imports and exports: the host may bind an image of any declared format.
inline bool may_be_host_owned(const ResourceDeclaration& resource) {
  return resource.origin == Origin::imported || resource.exported;
}
// Returns whether the port supports the resource. For host-owned resources all declared formats
// must fit; for others at least one, because the compiler chooses.
bool formats_fit(const Port& port, const ResourceDeclaration& resource);
// Returns whether the kernel's image type, of one layer or an array, fits this number of layers.
// Host passes see what the graph binds.
bool layers_fit(const PassType& type, const Port& port, uint32_t layers);
// Returns all formats that the port supports: "'r16f' or 'r32f'".
std::string formats_taken(const Port& port);
// Reports unsupported formats, with one message per resource for all ports. `port` describes the
// port bound at `where`.
void report_formats(GraphReader& reader, ResourceId id, const SourceLocation& where,
                    const std::string& port);

// Returns "note" of an object; "" if there is none or it is no string (which the object's reader
// reports).
std::string note_of(const Document& document, NodeId object);

} // namespace dermis
