// Applies the edits of an overlay in order, each to the result of the edits before.

#include "framegraph/compose/composer.hpp"
#include "framegraph/compose/format_version.hpp"
#include "framegraph/compose/path.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/suggest.hpp"
#include "framegraph/text/utf8.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace dermis {

namespace {

constexpr std::string_view verbs[] = {"insert_before", "insert_after", "replace", "remove", "set"};
enum class Verb : uint8_t { insert_before, insert_after, replace, remove, set, none };

std::string shown(std::string_view text) {
  std::string out;
  append_printable(out, text, limits::key_bytes);
  return out;
}

struct Edit {
  Composer& composer;
  uint32_t overlay; // index of its document
  NodeId target_node;
  std::string what;        // for messages: "'set' of edit 3"
  NodeId edits, self = {}; // the list of edits, and this edit

  EditTree& tree() const { return composer.tree; }
  SourceLocation target_place() const { return tree().documents[overlay].where(target_node); }

  void reject(std::string text, std::string suggestion, std::string_view path) const {
    Diagnostic& one = composer.error(DiagnosticId::edit_target, target_place(), std::move(text));
    one.suggestion = std::move(suggestion);
    for (const Change& change : composer.changes) {
      const bool took = change.what == Change::What::remove || change.what == Change::What::replace;
      const bool covers = path.starts_with(change.at) &&
                          (path.size() == change.at.size() || path[change.at.size()] == '/');
      if (took && covers)
        one.related.emplace_back(change.where,
                                 fmt::format("'{}' is removed here", shown(change.at)));
    }
  }

  void log(Change::What did, std::string at, std::vector<std::string> unwritten = {},
           std::vector<std::string> removed = {}) const {
    composer.changes.push_back(
        {did, std::move(at), target_place(), false, std::move(removed), std::move(unwritten)});
  }

  // Completes Change::affected for a value that was set.
  void name_affected(const std::vector<std::string>& steps, ItemId value, Change& change) const {
    if (steps.size() < 2 || steps[0] != "passes") return;
    if (steps.size() > 3 && steps[2] == "set") {
      change.affected = {steps[3]};
      change.affected_pass = steps[1];
      return;
    }
    if (steps.size() > 2 && steps[2] == "type") change.affected.emplace_back(tree().text(value));
    const ItemId passes = tree().find({0}, "passes");
    const int at = find_pass(tree(), passes, steps[1]);
    if (at < 0) return;
    for (std::string& resource :
         written_by(tree(), tree()[passes].children[static_cast<size_t>(at)]))
      change.affected.push_back(std::move(resource)); // which `when` may leave unwritten
  }

  // Returns Change::removed for an item that is removed.
  std::vector<std::string> names_of(const std::vector<std::string>& steps, ItemId item) const {
    std::vector<std::string> names{steps[steps.size() > 1 ? 1 : 0]};
    if (steps.size() == 1 && tree().kind(item) == NodeKind::object)
      for (const ItemId member : tree()[item].children)
        names.push_back(tree()[member].key);
    return names;
  }

  // Returns the graph's list of passes and the position of the named pass; -1 after an error.
  std::pair<ItemId, int> named_pass(std::string_view name) const {
    const ItemId passes = tree().find({0}, "passes");
    const bool list = passes.valid() && tree().kind(passes) == NodeKind::array;
    const int at = list ? find_pass(tree(), passes, name) : -1;
    if (at < 0)
      reject(fmt::format("{} names the pass '{}', which does not exist when this edit is applied",
                         what, shown(name)),
             list ? did_you_mean(name, steps_into(tree(), passes)) : std::string(),
             fmt::format("/passes/{}", name));
    return {passes, at};
  }

  void place_passes(Verb verb, std::string_view name, NodeId list) const {
    const auto [passes, at] = named_pass(name);
    if (at < 0) return;
    std::vector<ItemId> fresh;
    const uint64_t errors_before = composer.diagnostics.errors();
    const size_t included_before = composer.included.size();
    if (verb == Verb::replace)
      log(Change::What::replace, fmt::format("/passes/{}", name),
          written_by(tree(), tree()[passes].children[static_cast<size_t>(at)]),
          {std::string(name)});
    for (const NodeId pass : children(tree().documents[overlay], list))
      expand_pass(composer, overlay, pass, Change::What::insert, fresh);
    if (fresh.empty()) {
      if (composer.diagnostics.errors() != errors_before) return;
      if (verb == Verb::replace)
        composer.error(
            DiagnosticId::edit_target, target_place(),
            fmt::format("{} would replace the pass '{}' with no pass: the files that it includes "
                        "have no passes, or were included before; use 'remove' to remove "
                        "the pass",
                        what, shown(name)));
      else if (composer.included.size() == included_before &&
               !children(tree().documents[overlay], list).empty())
        composer.error(DiagnosticId::edit_target, target_place(),
                       fmt::format("{} adds nothing: what it includes was included before", what));
      return;
    }
    std::vector<ItemId>& all = tree()[passes].children;
    auto place = all.begin() + at;
    if (verb == Verb::replace) place = all.erase(place);
    if (verb == Verb::insert_after) ++place;
    all.insert(place, fresh.begin(), fresh.end());
  }

  // Returns the item that all steps of the path except the last lead to; invalid after an error.
  // `depth` receives that item's depth. With `make`, optional members of a graph or a pass are
  // created if they are absent.
  ItemId parent_of(std::string_view path, const std::vector<std::string>& steps, uint32_t& depth,
                   bool make = false) const {
    if (steps.empty()) {
      reject(fmt::format("{} is '{}'; a path must begin with '/'", what, shown(path)), "", path);
      return {};
    }
    ItemId at{0};
    for (depth = 1; depth < steps.size(); ++depth) {
      int child = find_step(tree(), at, steps[depth - 1]);
      if (child < 0 && make) child = make_member(at, steps, depth);
      if (child < 0) {
        missing(at, path, steps[depth - 1]);
        return {};
      }
      at = tree()[at].children[static_cast<size_t>(child)];
    }
    return at;
  }

  // Adds a new, empty member of `parent` for step `depth` of the path and returns its position; -1
  // if the format has no such member. Its source location is that of the edit.
  int make_member(ItemId parent, const std::vector<std::string>& steps, uint32_t depth) const {
    constexpr std::string_view of_graph[] = {"settings", "imports", "resources"};
    constexpr std::string_view of_pass[] = {"set", "read", "write", "otherwise"};
    const std::string& key = steps[depth - 1];
    const auto is_in = [&](const auto& words) {
      return std::find(std::begin(words), std::end(words), key) != std::end(words);
    };
    const bool list = depth == 1 && key == "exports";
    const bool object =
        (depth == 1 && is_in(of_graph)) || (depth == 3 && steps[0] == "passes" && is_in(of_pass));
    if ((!list && !object) || tree().kind(parent) != NodeKind::object) return -1;
    const ItemId fresh{static_cast<uint32_t>(tree().items.size())};
    tree().items.push_back({overlay, list ? edits : self, target_node, key, {}});
    tree()[parent].children.push_back(fresh);
    return static_cast<int>(tree()[parent].children.size()) - 1;
  }

  void missing(ItemId parent, std::string_view path, std::string_view step) const {
    reject(fmt::format("{} names '{}', but '{}' does not exist when this edit is applied", what,
                       shown(path), shown(step)),
           did_you_mean(step, steps_into(tree(), parent)), path);
  }

  void remove(std::string_view path) const {
    const std::vector<std::string> steps = split_path(path);
    uint32_t depth = 0;
    const ItemId parent = parent_of(path, steps, depth);
    if (!parent.valid()) return;
    const int at = find_step(tree(), parent, steps.back());
    if (at < 0) return missing(parent, path, steps.back());
    std::vector<ItemId>& all = tree()[parent].children;
    const ItemId item = all[static_cast<size_t>(at)];
    log(Change::What::remove, std::string(path), written_at(tree(), steps, item),
        names_of(steps, item));
    all.erase(all.begin() + at);
  }

  void set(std::string_view path, NodeId value) const {
    const std::vector<std::string> steps = split_path(path);
    uint32_t depth = 0;
    const ItemId parent = parent_of(path, steps, depth, true);
    if (!parent.valid()) return;
    const bool array = tree().kind(parent) == NodeKind::array;
    const int at = find_step(tree(), parent, steps.back());
    if (at < 0 && (array ? steps.back() != "-" : tree().kind(parent) != NodeKind::object))
      return missing(parent, path, steps.back());
    const ItemId fresh = tree().insert_copy(overlay, value);
    if (depth + height_of(tree(), fresh) > limits::nesting) {
      composer.error(
          DiagnosticId::limit_exceeded, target_place(),
          fmt::format("{} nests objects and arrays more than {} deep", what, limits::nesting));
      return;
    }
    if (!array && steps.back().size() > limits::key_bytes) {
      composer.error(
          DiagnosticId::limit_exceeded, target_place(),
          fmt::format("{} contains a key of more than {} bytes", what, limits::key_bytes));
      return;
    }
    tree()[fresh].key = array ? std::string() : steps.back();
    tree()[fresh].key_node = target_node;
    std::vector<ItemId>& all = tree()[parent].children;
    std::vector<std::string> unwritten, affected = names_of(steps, fresh);
    if (at < 0) {
      all.push_back(fresh);
    } else {
      for (std::string& name : names_of(steps, all[static_cast<size_t>(at)]))
        affected.push_back(std::move(name));
      unwritten = written_at(tree(), steps, all[static_cast<size_t>(at)]);
      all[static_cast<size_t>(at)] = fresh;
    }
    log(Change::What::set, std::string(path), std::move(unwritten));
    composer.changes.back().affected = std::move(affected);
    name_affected(steps, fresh, composer.changes.back());
  }
};

Verb verb_of(const Document& document, NodeId node) {
  for (size_t i = 0; i < std::size(verbs); ++i)
    if (document.find(node, verbs[i]).valid()) return static_cast<Verb>(i);
  return Verb::none;
}

// Reports an edit without a verb, and suggests the verb that a misspelt key resembles.
void report_no_verb(const Document& document, NodeId node, const std::string& what,
                    Diagnostics& diagnostics) {
  const std::string text =
      fmt::format("{} has no effect: expected one of the keys {}", what, list_words(verbs));
  for (const std::string_view verb : verbs)
    if (const NodeId misspelt = find_misspelt(document, node, verb); misspelt.valid()) {
      diagnostics.add(DiagnosticId::unknown_key, document.where_key(misspelt), text).suggestion =
          fmt::format("did you mean '{}'?", verb);
      return;
    }
  diagnostics.add(DiagnosticId::missing_key, document.where(node), text);
}

struct EditDeclaration {
  Verb verb = Verb::none;
  NodeId target, operand; // operand: passes, or the value to set; invalid for remove
};

std::optional<EditDeclaration> read_edit(const Document& document, NodeId node,
                                         const std::string& what, Diagnostics& diagnostics) {
  ObjectReader reader(document, node, what, diagnostics);
  if (!reader.ok()) return std::nullopt;
  EditDeclaration edit;
  edit.verb = verb_of(document, node);
  if (edit.verb == Verb::none) {
    report_no_verb(document, node, what, diagnostics);
    return std::nullopt;
  }
  const std::string_view key = verbs[static_cast<size_t>(edit.verb)];
  edit.target = document.find(node, key);
  bool ok = reader.string(key).has_value();
  if (edit.verb == Verb::set) edit.operand = reader.any("to");
  if (edit.verb < Verb::remove) {
    edit.operand = reader.array("passes", 1, limits::passes);
    if (edit.operand.valid())
      for (const NodeId pass : children(document, edit.operand))
        ok &= expect_kind(document, pass, fmt::format("a pass of {}", what), NodeKind::object,
                          diagnostics);
  }
  return reader.finish() && ok ? std::optional(edit) : std::nullopt;
}

std::string edit_name(size_t index) {
  return fmt::format("edit {}", index + 1);
}

// Returns the edits in order; edits with errors are nullopt. Empty if the overlay itself has
// errors.
std::vector<std::optional<EditDeclaration>> read_edits(const Document& document,
                                                       Diagnostics& diagnostics) {
  std::vector<std::optional<EditDeclaration>> out;
  if (!check_version(document, "dermis_overlay", graph_format_version, diagnostics)) return out;
  ObjectReader reader(document, document.root(), "the overlay", diagnostics);
  reader.any("dermis_overlay");
  const NodeId edits = reader.array("edits", 1, limits::edits);
  reader.finish();
  if (edits.valid())
    for (const NodeId edit : children(document, edits))
      out.push_back(read_edit(document, edit, edit_name(out.size()), diagnostics));
  return out;
}

} // namespace

bool check_overlay(const Document& document, Diagnostics& diagnostics) {
  const uint64_t before = diagnostics.errors();
  read_edits(document, diagnostics);
  return diagnostics.errors() == before;
}

void apply_overlay(Composer& composer, uint32_t overlay) {
  const Document& document = composer.tree.documents[overlay];
  const auto edits = read_edits(document, composer.diagnostics);
  const NodeId list = document.find(document.root(), "edits");
  std::vector<NodeId> nodes;
  if (list.valid())
    for (const NodeId edit : children(document, list))
      nodes.push_back(edit);
  for (size_t i = 0; i < edits.size() && !composer.diagnostics.full(); ++i) {
    if (!edits[i]) continue;
    const EditDeclaration& declared = *edits[i];
    const std::string_view key = verbs[static_cast<size_t>(declared.verb)];
    const std::string_view target = document.text(declared.target);
    const Edit edit{
        composer, overlay, declared.target, fmt::format("'{}' of {}", key, edit_name(i)),
        list,     nodes[i]};
    if (declared.verb == Verb::set)
      edit.set(target, declared.operand);
    else if (declared.verb == Verb::remove)
      edit.remove(target);
    else
      edit.place_passes(declared.verb, target, declared.operand);
  }
}

} // namespace dermis
