// Expands { "include": "file" } among passes: the passes of a fragment, whose settings, imports and
// resources join the graph's.

#include "framegraph/compose/composer.hpp"
#include "framegraph/compose/format_version.hpp"
#include "framegraph/text/limits.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <unordered_map>
#include <unordered_set>

namespace dermis {

namespace {

constexpr std::string_view sections[] = {"settings", "imports", "resources"};

// Returns "'a' includes 'b' includes 'a'".
std::string chain_text(const Composer& composer, std::string_view name) {
  std::string text;
  for (const Composer::Included& one : composer.chain)
    if (!text.empty() || one.name == name) text += fmt::format("'{}' includes ", one.name);
  return text + fmt::format("'{}'", name);
}

// Opens and parses a file. Returns the document's index, or nullopt after an error at `where`.
std::optional<uint32_t> open_fragment(Composer& composer, const std::string& name,
                                      const SourceLocation& where) {
  if (!composer.open) {
    composer.error(
        DiagnosticId::file_unreadable, where,
        fmt::format("'{}' cannot be included: the caller provides no function that opens files",
                    name));
    return std::nullopt;
  }
  FileText file = composer.open(name);
  if (!file.problem.empty()) {
    composer.error(DiagnosticId::file_unreadable, where,
                   fmt::format("'{}' cannot be included: {}", name, file.problem));
    return std::nullopt;
  }
  auto document = parse_document(file.name.empty() ? name : std::move(file.name),
                                 std::move(file.text), composer.diagnostics);
  if (!document) return std::nullopt;
  if (!add_document(composer, std::move(*document), where)) return std::nullopt;
  return static_cast<uint32_t>(composer.tree.documents.size() - 1);
}

// Relates diagnostics from index `first` on, which reading a fragment reported in other files, to
// the include.
void relate_to_include(Composer& composer, size_t first, const std::string& name,
                       const SourceLocation& where) {
  for (size_t i = first; i < composer.diagnostics.list.size(); ++i) {
    Diagnostic& one = composer.diagnostics.list[i];
    if (one.where.file != where.file)
      one.related.emplace_back(where, fmt::format("'{}' is included here", name));
  }
}

// Adds the members of a fragment's section to the graph's section with that name.
void join_section(Composer& composer, std::string_view section, uint32_t document, NodeId list) {
  EditTree& tree = composer.tree;
  ItemId into = tree.find({0}, section);
  if (!into.valid()) { // first members; the key is that of the fragment's section
    into = tree.insert_copy(document, list);
    tree[into].children.clear();
    tree[{0}].children.push_back(into);
  }
  if (tree.kind(into) != NodeKind::object) return; // the graph's reader reports it
  std::unordered_map<std::string, ItemId> known;
  for (const ItemId member : tree[into].children)
    known.emplace(tree[member].key, member);
  for (const NodeId node : children(tree.documents[document], list)) {
    const ItemId fresh = tree.insert_copy(document, node);
    const std::string key = tree[fresh].key;
    const auto [first, added] = known.emplace(key, fresh);
    if (added) {
      tree[into].children.push_back(fresh);
      composer.changes.push_back(
          {Change::What::include, fmt::format("/{}/{}", section, key), tree.where_key(fresh)});
    } else if (!same_value(tree, first->second, fresh)) {
      composer
          .error(DiagnosticId::duplicate_name, tree.where_key(fresh),
                 fmt::format("'{}' of \"{}\" is declared differently in two files", key, section))
          .related.emplace_back(tree.where_key(first->second), "first declared here");
    }
  }
}

void join_exports(Composer& composer, uint32_t document, NodeId list) {
  EditTree& tree = composer.tree;
  const ItemId into = tree.find({0}, "exports");
  if (!into.valid() || tree.kind(into) != NodeKind::array) return; // the graph's reader reports it
  std::unordered_set<std::string> known;
  for (const ItemId one : tree[into].children)
    if (tree.kind(one) == NodeKind::string) known.emplace(tree.text(one));
  for (const NodeId node : children(tree.documents[document], list)) {
    const ItemId fresh = tree.insert_copy(document, node);
    if (tree.kind(fresh) == NodeKind::string && !known.emplace(tree.text(fresh)).second) continue;
    composer.changes.push_back(
        {Change::What::include, fmt::format("/exports/{}", tree.text(fresh)), tree.where(fresh)});
    tree[into].children.push_back(fresh);
  }
}

void include(Composer& composer, uint32_t document, NodeId entry, std::vector<ItemId>& out) {
  const Document& from = composer.tree.documents[document];
  ObjectReader reader(from, entry, "an include", composer.diagnostics);
  const auto text = reader.string("include");
  const SourceLocation where = from.where(from.find(entry, "include"));
  if (!reader.finish() || !text ||
      !check_file_name(*text, fmt::format("'{}'", *text), where, composer.diagnostics))
    return;
  const std::string name(*text);
  const auto named = [&](const Composer::Included& one) { return one.name == name; };
  if (const auto open = std::find_if(composer.chain.begin(), composer.chain.end(), named);
      open != composer.chain.end()) {
    composer
        .error(DiagnosticId::include_cycle, where,
               fmt::format("the includes form a cycle: {}", chain_text(composer, name)))
        .related.emplace_back(open->where, fmt::format("'{}' is included here", name));
    return;
  }
  // A fragment that several others include is expanded only at its first include.
  if (std::any_of(composer.included.begin(), composer.included.end(), named)) return;
  if (composer.chain.size() >= limits::include_nesting) {
    composer.error(DiagnosticId::limit_exceeded, where,
                   fmt::format("includes are nested more than {} deep", limits::include_nesting));
    return;
  }
  composer.included.push_back({name, where});
  const size_t reported = composer.diagnostics.list.size();
  if (const std::optional<uint32_t> fragment = open_fragment(composer, name, where)) {
    composer.chain.push_back({name, where});
    join_fragment(composer, *fragment, out);
    composer.chain.pop_back();
  }
  relate_to_include(composer, reported, name, where);
}

} // namespace

void join_fragment(Composer& composer, uint32_t document, std::vector<ItemId>& out) {
  const Document& fragment = composer.tree.documents[document];
  if (!check_version(fragment, "dermis_fragment", graph_format_version, composer.diagnostics))
    return;
  ObjectReader reader(fragment, fragment.root(), "the fragment", composer.diagnostics);
  reader.any("dermis_fragment");
  for (const std::string_view section : sections)
    if (const NodeId list = reader.object(section, Need::optional); list.valid())
      join_section(composer, section, document, list);
  if (const NodeId list = reader.array("exports", 0, limits::resources, Need::optional);
      list.valid())
    join_exports(composer, document, list);
  const NodeId passes = reader.array("passes", 0, limits::passes, Need::optional);
  if (reader.finish() && passes.valid())
    for (const NodeId pass : children(fragment, passes))
      expand_pass(composer, document, pass, Change::What::include, out);
}

bool is_include(const Document& document, NodeId entry) {
  return document.find(entry, "include").valid() && !document.find(entry, "pass").valid();
}

void expand_pass(Composer& composer, uint32_t document, NodeId node, Change::What what,
                 std::vector<ItemId>& out) {
  if (is_include(composer.tree.documents[document], node))
    return include(composer, document, node, out);
  const ItemId pass = composer.tree.insert_copy(document, node);
  const ItemId name = composer.tree.find(pass, "pass");
  composer.changes.push_back(
      {what,
       fmt::format("/passes/{}", name.valid() ? composer.tree.text(name) : std::string_view()),
       composer.tree.where(pass)});
  out.push_back(pass);
}

} // namespace dermis
