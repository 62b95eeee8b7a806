#pragma once
// Documents being put together: a tree that can be edited, whose every value knows the document it came from.

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
  NodeId key_node;       // the value that gave it its key; invalid: the key stands at `node`
  std::string key;       // "" in arrays and at the root
  std::vector<ItemId> children;
};

struct EditTree {
  std::deque<Document> documents; // references to them last while others are added
  std::vector<Item> items;        // [0] the root; those that were removed stay, unreachable

  const Item& operator[](ItemId id) const { return items[id.value]; }
  Item& operator[](ItemId id) { return items[id.value]; }
  NodeKind kind(ItemId id) const;
  std::string_view text(ItemId id) const;                 // of a string, else ""
  ItemId find(ItemId object, std::string_view key) const; // invalid when there is none
  SourceLocation where(ItemId id) const;                  // the value
  SourceLocation where_key(ItemId id) const;              // its key, or the value where there is none

  // Copies the value `node` of a document with all that is in it; a child of nothing yet.
  ItemId graft(uint32_t document, NodeId node);
};

// Do both mean the same, whatever their "note"s say? Members may stand in any order; objects of more than 256
// of them count as different.
bool same_value(const EditTree& tree, ItemId a, ItemId b);

// Objects and arrays inside each other, this one included; 0 for anything else.
uint32_t height_of(const EditTree& tree, ItemId id);

// The tree as one document that keeps where each of its values was read.
Document flatten(EditTree&& tree);

} // namespace dermis
