#pragma once
// Composes one graph of several files: fragments that its passes include, then overlays in the
// given order. Every value of the result records the file that set it. Formats: docs/overlays.md.

#include "framegraph/text/document.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {

// Contents of a file that an "include" names. Names are relative, with '/' between folders and
// without ".."; the function that opens files chooses the base folder.
struct FileText {
  std::string name;    // for messages
  std::string text;    // of the file
  std::string problem; // why the file cannot be read; "" on success
};
using OpenFile = std::function<FileText(std::string_view name)>;

// Returns whether the name may be opened; else reports an error at `where`.
bool check_file_name(std::string_view name, std::string_view what, const SourceLocation& where,
                     Diagnostics&);

// Records a change that a file other than the graph's made, in order.
struct Change {
  enum class What : uint8_t { include, insert, replace, remove, set } what;
  std::string at; // path in the graph as an overlay writes it: "/passes/scatter/set/samples"
  SourceLocation where;
  bool gone = false; // no later change restored what `at` names
  // Names that errors contain if `gone`: the pass, setting or resource that `at` belongs to, or a
  // section and all its members.
  std::vector<std::string> removed = {};
  // Resources that a pass wrote before this change, and that no pass of the result writes.
  std::vector<std::string> unwritten = {};
  // Names one of which an error contains if a `set` edit may have caused it: the pass, setting or
  // resource that `at` belongs to. Empty if a later edit replaced the value.
  std::vector<std::string> affected = {};
  std::string affected_pass = {}; // for settings of a pass: an error contains this name as well
};

std::string_view change_name(Change::What what);

// Records which file set what, to explain a graph: changes and the files that their locations refer
// to.
struct Provenance {
  std::span<const Change> changes = {};
  std::span<const SourceFile> files = {};

  std::string place(const Change& change) const; // "file:line:column"
};

// Relates errors of the composed graph, those from index `first` of diagnostics.list on, to the
// changes that removed or set what they name.
void relate_to_removals(std::span<const Change> changes, size_t first, Diagnostics& diagnostics);

struct Composition {
  Document document;
  std::vector<Change> changes;
};

// Returns `graph` with its includes and `overlays` applied; unchanged if there are none. Returns
// nullopt with errors in `diagnostics`. An empty `open` opens nothing. Free-threaded if `open` is.
std::optional<Composition> compose(Document graph, std::vector<Document> overlays,
                                   const OpenFile& open, Diagnostics& diagnostics);

// Checks an overlay without a graph. Returns false with errors in `diagnostics`.
bool check_overlay(const Document& document, Diagnostics& diagnostics);

// Returns a graph that consists only of a fragment, so that the fragment can be checked. Returns
// nullopt with errors in `diagnostics`.
std::optional<Composition> compose_fragment(Document fragment, const OpenFile& open,
                                            Diagnostics& diagnostics);

} // namespace dermis
