#include "framegraph/compose/path.hpp"

#include <charconv>

namespace dermis {

namespace {

// Returns the name that identifies an array element; "" if only its index does.
std::string_view element_name(const EditTree& tree, ItemId element) {
  if (tree.kind(element) == NodeKind::string) return tree.text(element);
  const ItemId pass = tree.find(element, "pass");
  return pass.valid() ? tree.text(pass) : std::string_view();
}

// Returns the name in "name#mips[layers]@-N".
std::string resource_name(const EditTree& tree, ItemId reference) {
  const std::string_view text = tree.text(reference);
  return std::string(text.substr(0, text.find_first_of("#[@")));
}

} // namespace

std::vector<std::string> split_path(std::string_view path) {
  std::vector<std::string> steps;
  if (path.empty() || path.front() != '/') return steps;
  for (size_t i = 0; i < path.size(); ++i) {
    if (path[i] == '/') {
      steps.emplace_back();
    } else if (path[i] == '~' && i + 1 < path.size() &&
               (path[i + 1] == '0' || path[i + 1] == '1')) {
      steps.back() += path[++i] == '0' ? '~' : '/';
    } else {
      steps.back() += path[i];
    }
  }
  return steps;
}

int find_step(const EditTree& tree, ItemId parent, std::string_view step) {
  const std::vector<ItemId>& children = tree[parent].children;
  const bool array = tree.kind(parent) == NodeKind::array;
  for (size_t i = 0; i < children.size(); ++i)
    if (!step.empty() && (array ? element_name(tree, children[i]) : tree[children[i]].key) == step)
      return static_cast<int>(i);
  size_t index = 0;
  const auto read = std::from_chars(step.data(), step.data() + step.size(), index);
  const bool number = read.ec == std::errc() && read.ptr == step.data() + step.size();
  return array && number && index < children.size() && element_name(tree, children[index]).empty()
             ? static_cast<int>(index)
             : -1;
}

std::vector<std::string_view> steps_into(const EditTree& tree, ItemId parent) {
  constexpr size_t max_steps = 4096; // a hostile object may have hundreds of thousands of members
  std::vector<std::string_view> out;
  for (const ItemId child : tree[parent].children)
    if (out.size() < max_steps)
      out.push_back(tree.kind(parent) == NodeKind::object ? std::string_view(tree[child].key)
                                                          : element_name(tree, child));
  return out;
}

int find_pass(const EditTree& tree, ItemId passes, std::string_view name) {
  const std::vector<ItemId>& children = tree[passes].children;
  for (size_t i = 0; i < children.size(); ++i) {
    const ItemId key = tree.find(children[i], "pass");
    if (key.valid() && tree.text(key) == name) return static_cast<int>(i);
  }
  return -1;
}

std::vector<std::string> written_by(const EditTree& tree, ItemId pass) {
  std::vector<std::string> names;
  if (const ItemId write = tree.find(pass, "write"); write.valid())
    for (const ItemId port : tree[write].children)
      names.push_back(resource_name(tree, port));
  return names;
}

std::vector<std::string> written_at(const EditTree& tree, const std::vector<std::string>& steps,
                                    ItemId item) {
  if (steps.size() < 2 || steps[0] != "passes") return {};
  if (steps.size() == 2) return written_by(tree, item);
  if (steps[2] != "write" || steps.size() > 4) return {};
  if (steps.size() == 4) return {resource_name(tree, item)};
  std::vector<std::string> names;
  for (const ItemId port : tree[item].children)
    names.push_back(resource_name(tree, port));
  return names;
}

} // namespace dermis
