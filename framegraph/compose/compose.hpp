#pragma once
// One graph out of several files: fragments that its passes include, then overlays in the order in which they
// are given. Every value of the result knows the file that set it. Formats: docs/overlays.md.

#include "framegraph/text/document.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {

// A file by the name that an "include" gives. Names are relative, with '/' between folders and without "..":
// whoever opens them decides where that is.
struct FileText {
  std::string name;    // for messages
  std::string text;    // of the file
  std::string problem; // why there is none; "" for success
};
using OpenFile = std::function<FileText(std::string_view name)>;

// Is it a name that may be opened? Else an error at `where`.
bool check_file_name(std::string_view name, std::string_view what, const SourceLocation& where, Diagnostics&);

// What a file other than the graph's did, in the order in which it happened.
struct Change {
  enum class What : uint8_t { include, insert, replace, remove, set } what;
  std::string at; // path in the graph as an overlay writes it: "/passes/scatter/set/samples"
  SourceLocation where;
};

std::string_view change_name(Change::What what);

// Who set what, for whoever explains a graph: changes and the files that their places name.
struct Provenance {
  std::span<const Change> changes = {};
  std::span<const SourceFile> files = {};

  std::string place(const Change& change) const; // "file:line:column"
};

struct Composition {
  Document document;
  std::vector<Change> changes;
};

// `graph` with its includes and `overlays` applied; as it is where there are none. nullopt with errors in
// `diagnostics`. An empty `open` opens nothing. Free-threaded if `open` is.
std::optional<Composition> compose(Document graph, std::vector<Document> overlays, const OpenFile& open,
                                   Diagnostics& diagnostics);

// An overlay by itself, without a graph to apply it to. False with errors in `diagnostics`.
bool check_overlay(const Document& document, Diagnostics& diagnostics);

// A graph that consists of a fragment alone, so that the fragment can be checked. nullopt with errors.
std::optional<Composition> compose_fragment(Document fragment, const OpenFile& open,
                                            Diagnostics& diagnostics);

} // namespace dermis
