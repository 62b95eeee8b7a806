#pragma once
// An editable tree of values from several documents. Every value knows the document that it came
// from.

#include "framegraph/text/document.hpp"

#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {

using ItemId = Index<struct ItemTag>; // into EditTree::items

struct Item {
  uint32_t document = 0; // into EditTree::documents
  NodeId node;           // where its value was read
  NodeId key_node;       // the value that gave its key; invalid: the key belongs to `node`
  std::string key;       // "" in arrays and at the root
  std::vector<ItemId> children;
};

struct EditTree {
  // a deque, so that references stay valid while documents are added
  std::deque<Document> documents;
  std::vector<Item> items; // [0] is the root; removed items stay, but are unreachable

  const Item& operator[](ItemId id) const { return items[id.value]; }
  Item& operator[](ItemId id) { return items[id.value]; }
  NodeKind kind(ItemId id) const;
  std::string_view text(ItemId id) const;                 // of a string, else ""
  ItemId find(ItemId object, std::string_view key) const; // invalid if there is none
  SourceLocation where(ItemId id) const;                  // of the value
  // of the key, or of the value if there is no key
  SourceLocation where_key(ItemId id) const;

  // Copies the value `node` of a document with all its contents. The copy has no parent yet.
  ItemId insert_copy(uint32_t document, NodeId node);
};

// Returns whether both values are equal, ignoring "note"s and the order of members.
bool same_value(const EditTree& tree, ItemId a, ItemId b);

// Returns how many objects and arrays are nested, including this one; 0 for other values.
uint32_t height_of(const EditTree& tree, ItemId id);

// Returns the tree as one document that records where each value was read.
Document flatten(EditTree&& tree);

} // namespace dermis
