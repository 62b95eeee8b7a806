#pragma once
// Shared state of compose: the tree composed so far, and how to open further files.

#include "framegraph/compose/compose.hpp"
#include "framegraph/compose/tree.hpp"
#include "framegraph/text/reader.hpp"

#include <string>
#include <vector>

namespace dermis {

struct Composer {
  const OpenFile& open;
  Diagnostics& diagnostics;
  EditTree tree = {};
  std::vector<Change> changes = {};

  struct Included {
    std::string name;
    SourceLocation where; // of the include that named it
  };
  std::vector<Included> included = {}; // each file once
  std::vector<Included> chain = {};    // files that are being included now
  uint64_t bytes = 0, nodes = 0;       // of all documents

  Diagnostic& error(DiagnosticId id, SourceLocation where, std::string text) {
    return diagnostics.add(id, std::move(where), std::move(text));
  }
};

// Adds a document. Returns false with an error at `where` if the graph then exceeds a limit.
bool add_document(Composer& composer, Document document, const SourceLocation& where);

// Returns whether an entry of "passes" includes a file.
bool is_include(const Document& document, NodeId entry);

// Appends to `out` the passes for entry `node` of a list of passes: itself, or the passes of the
// file that it includes. The file's other members join the graph's.
void expand_pass(Composer& composer, uint32_t document, NodeId node, Change::What what,
                 std::vector<ItemId>& out);

// Appends the passes of the fragment to `out`; its other members join the graph's.
void join_fragment(Composer& composer, uint32_t document, std::vector<ItemId>& out);

// Applies the edits of document number `overlay` in order.
void apply_overlay(Composer& composer, uint32_t overlay);

} // namespace dermis
