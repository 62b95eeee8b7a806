#pragma once
// Holds a JSON text as flat arrays; every value has its line and column. Does not interpret values;
// reader.hpp reads objects strictly.

#include "framegraph/text/diagnostic.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {

enum class NodeKind : uint8_t { null, boolean, integer, real, string, array, object };

// Returns the name for messages: "an object", "a string".
std::string_view kind_name(NodeKind kind);

struct Node {
  NodeKind kind = NodeKind::null;
  uint32_t offset = 0;                   // byte offset of the value's first character
  uint32_t line = 1, column = 1;         // position of the value's first character
  uint32_t key_line = 0, key_column = 0; // of the key's opening quote; 0 in arrays and at the root
  NodeId parent, first_child, next;      // invalid: none
  uint32_t child_count = 0;
  uint32_t index = 0;                         // position among its siblings
  uint32_t key_begin = 0, key_size = 0;       // into Document::characters
  uint32_t string_begin = 0, string_size = 0; // into Document::characters
  int64_t integer = 0;                        // integer; boolean as 0 or 1
  double real = 0.0;                          // integer and real, rounded to nearest
};

// Nodes are in text order, [0] is the root. Strings are unescaped UTF-8 without U+0000.
struct Document {
  FileId file; // into Diagnostics::files; the first of `sources` if there are any
  std::vector<Node> nodes;
  std::string characters;

  // For a document composed of several (framegraph/compose): where each node was read.
  struct Origin {
    uint32_t source; // into `sources`
    // key_node: the value that gave the key; invalid: the key belongs to `node`
    NodeId node, key_node;
  };
  std::vector<Document> sources;
  std::vector<Origin> origins; // by node; empty: all were read from this document

  NodeId root() const { return {0}; }
  const Node& operator[](NodeId id) const { return nodes[id.value]; }
  std::string_view text(NodeId id) const;                 // of a string
  std::string_view key(NodeId id) const;                  // "" in arrays and at the root
  NodeId find(NodeId object, std::string_view key) const; // invalid if there is none; linear

  std::string pointer(NodeId id) const;      // RFC 6901, in this document
  SourceLocation where(NodeId id) const;     // of the value, in its source file
  SourceLocation where_key(NodeId id) const; // of the key, or of the value if there is no key
};

// Appends one step to a JSON pointer.
void append_pointer_step(std::string& pointer, std::string_view key);

// Returns the location of byte `decoded` of string `id` in the text, accounting for escapes. `all`
// holds the text.
SourceLocation where_in_string(const Document& document, NodeId id, size_t decoded,
                               const Diagnostics& all);

// Registers `text` under `name` with `diagnostics` and parses strict JSON plus // comments. Returns
// nullopt with an error for: syntax errors, duplicate keys, integers that do not fit in 64 signed
// bits, numbers beyond the range of double, ill-formed UTF-8, U+0000, and anything that exceeds
// limits.hpp. Free-threaded.
std::optional<Document> parse_document(std::string name, std::string text,
                                       Diagnostics& diagnostics);

// Parses a regular file; `path` is used as its name.
std::optional<Document> read_document(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis
