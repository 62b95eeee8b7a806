#include "framegraph/compose/tree.hpp"

#include <algorithm>
#include <iterator>

namespace dermis {

namespace {

// Recursion is as deep as the tree, which limits::nesting bounds.
ItemId copy(EditTree& tree, uint32_t document, NodeId node) {
  const ItemId id{static_cast<uint32_t>(tree.items.size())};
  tree.items.emplace_back();
  tree[id].document = document;
  tree[id].node = node;
  tree[id].key = tree.documents[document].key(node);
  NodeId child = tree.documents[document][node].first_child;
  for (; child.valid(); child = tree.documents[document][child].next) {
    const ItemId made = copy(tree, document, child);
    tree[id].children.push_back(made);
  }
  return id;
}

// Returns the members of an object except "note", sorted by key.
std::vector<ItemId> sorted_members(const EditTree& tree, ItemId object) {
  std::vector<ItemId> members = tree[object].children;
  std::erase_if(members, [&](ItemId member) { return tree[member].key == "note"; });
  std::sort(members.begin(), members.end(),
            [&](ItemId a, ItemId b) { return tree[a].key < tree[b].key; });
  return members;
}

struct Flattener {
  const EditTree& tree;
  Document out;

  NodeId add(ItemId id, NodeId parent, uint32_t index) {
    const Item& item = tree[id];
    const Document& from = tree.documents[item.document];
    const NodeId made{static_cast<uint32_t>(out.nodes.size())};
    Node node = from[item.node]; // kind, number and location
    node.parent = parent;
    node.first_child = node.next = {};
    node.child_count = static_cast<uint32_t>(item.children.size());
    node.index = index;
    node.key_begin = keep(item.key);
    node.key_size = static_cast<uint32_t>(item.key.size());
    node.string_begin = node.kind == NodeKind::string ? keep(from.text(item.node)) : 0;
    out.nodes.push_back(node);
    out.origins.push_back({item.document, item.node, item.key_node});
    NodeId last;
    for (uint32_t i = 0; i < item.children.size(); ++i) {
      const NodeId child = add(item.children[i], made, i);
      (last.valid() ? out.nodes[last.value].next : out.nodes[made.value].first_child) = child;
      last = child;
    }
    return made;
  }

  uint32_t keep(std::string_view characters) {
    const auto begin = static_cast<uint32_t>(out.characters.size());
    out.characters += characters;
    return begin;
  }
};

} // namespace

NodeKind EditTree::kind(ItemId id) const {
  const Item& item = items[id.value];
  return documents[item.document][item.node].kind;
}

std::string_view EditTree::text(ItemId id) const {
  const Item& item = items[id.value];
  return kind(id) == NodeKind::string ? documents[item.document].text(item.node)
                                      : std::string_view();
}

ItemId EditTree::find(ItemId object, std::string_view key) const {
  if (kind(object) != NodeKind::object) return {};
  for (const ItemId child : items[object.value].children)
    if (items[child.value].key == key) return child;
  return {};
}

SourceLocation EditTree::where(ItemId id) const {
  const Item& item = items[id.value];
  return documents[item.document].where(item.node);
}

SourceLocation EditTree::where_key(ItemId id) const {
  const Item& item = items[id.value];
  const Document& from = documents[item.document];
  return item.key_node.valid() ? from.where(item.key_node) : from.where_key(item.node);
}

ItemId EditTree::insert_copy(uint32_t document, NodeId node) {
  return copy(*this, document, node);
}

bool same_value(const EditTree& tree, ItemId a, ItemId b) {
  const NodeKind kind = tree.kind(a);
  if (kind != tree.kind(b)) return false;
  const Node& left = tree.documents[tree[a].document][tree[a].node];
  const Node& right = tree.documents[tree[b].document][tree[b].node];
  if (kind == NodeKind::string) return tree.text(a) == tree.text(b);
  if (kind == NodeKind::array)
    return std::equal(tree[a].children.begin(), tree[a].children.end(), tree[b].children.begin(),
                      tree[b].children.end(),
                      [&](ItemId x, ItemId y) { return same_value(tree, x, y); });
  if (kind != NodeKind::object) return left.integer == right.integer && left.real == right.real;
  const std::vector<ItemId> of_a = sorted_members(tree, a);
  const std::vector<ItemId> of_b = sorted_members(tree, b);
  return std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), [&](ItemId x, ItemId y) {
    return tree[x].key == tree[y].key && same_value(tree, x, y);
  });
}

uint32_t height_of(const EditTree& tree, ItemId id) {
  if (tree.kind(id) != NodeKind::object && tree.kind(id) != NodeKind::array) return 0;
  uint32_t maximum = 0;
  for (const ItemId child : tree[id].children)
    maximum = std::max(maximum, height_of(tree, child));
  return maximum + 1;
}

Document flatten(EditTree&& tree) {
  Flattener flattener{tree, {}};
  flattener.out.file = tree.documents.front().file;
  flattener.add({0}, {}, 0);
  flattener.out.sources.assign(std::make_move_iterator(tree.documents.begin()),
                               std::make_move_iterator(tree.documents.end()));
  return std::move(flattener.out);
}

} // namespace dermis
