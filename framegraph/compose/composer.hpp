#pragma once
// What the parts of compose share: the tree as far as it is put together, and what may still be opened.

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
    SourceLocation where; // of the include that brought it
  };
  std::vector<Included> included = {}; // each file once
  std::vector<Included> chain = {};    // of files that are being included now
  uint64_t bytes = 0, nodes = 0;       // of all documents

  Diagnostic& error(DiagnosticId id, SourceLocation where, std::string text) {
    return diagnostics.add(id, std::move(where), std::move(text));
  }
};

// Takes a document in; false with an error at `where` when that is more than one graph may consist of.
bool add_document(Composer& composer, Document document, const SourceLocation& where);

// Does an entry of "passes" stand for a file?
bool is_include(const Document& document, NodeId entry);

// The passes that entry `node` of a list of passes stands for: itself, or those of the file that it includes,
// whose other members join the graph's. Appended to `out`.
void expand_pass(Composer& composer, uint32_t document, NodeId node, Change::What what,
                 std::vector<ItemId>& out);

// Passes of the fragment, appended to `out`; its other members join the graph's.
void join_fragment(Composer& composer, uint32_t document, std::vector<ItemId>& out);

// Applies the edits of document number `overlay`, in their order.
void apply_overlay(Composer& composer, uint32_t overlay);

} // namespace dermis
