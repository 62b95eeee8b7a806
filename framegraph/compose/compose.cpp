#include "framegraph/compose/compose.hpp"

#include "framegraph/compose/composer.hpp"
#include "framegraph/compose/format_version.hpp"
#include "framegraph/compose/path.hpp"
#include "framegraph/text/limits.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <unordered_set>

namespace dermis {

namespace {

// Replaces entries of the graph's passes that include files by the passes of those files.
void expand_graph(Composer& composer) {
  const ItemId passes = composer.tree.find({0}, "passes");
  // the graph's reader reports it
  if (!passes.valid() || composer.tree.kind(passes) != NodeKind::array) return;
  std::vector<ItemId> expanded;
  const std::vector<ItemId> entries = composer.tree[passes].children;
  for (const ItemId entry : entries) {
    const NodeId node = composer.tree[entry].node;
    if (is_include(composer.tree.documents.front(), node))
      expand_pass(composer, 0, node, Change::What::include, expanded);
    else
      expanded.push_back(entry);
  }
  composer.tree[passes].children = std::move(expanded);
}

bool has_includes(const Document& graph) {
  const NodeId passes = graph.find(graph.root(), "passes");
  if (!passes.valid()) return false;
  const std::vector<NodeId> entries = children(graph, passes);
  return std::any_of(entries.begin(), entries.end(),
                     [&](NodeId entry) { return is_include(graph, entry); });
}

// Clears `affected` of `set` edits whose value a later edit replaced.
void find_replaced_values(std::vector<Change>& changes) {
  std::unordered_set<std::string_view> later; // paths of later edits
  for (auto change = changes.rbegin(); change != changes.rend(); ++change) {
    if (change->what == Change::What::include || change->what == Change::What::insert) continue;
    const std::string_view path = change->at;
    for (size_t end = path.find('/', 1); true; end = path.find('/', end + 1)) {
      if (later.contains(path.substr(0, end)) && !path.ends_with("/-")) change->affected.clear();
      if (end == std::string_view::npos) break;
    }
    later.insert(path);
  }
}

// Completes `gone`, `unwritten` and `affected` of all changes, which depend on the composed graph.
void find_removals(Composer& composer) {
  const EditTree& tree = composer.tree;
  const auto exists = [&](const Change& change) {
    ItemId at{0};
    for (const std::string& step : split_path(change.at)) {
      const int child = find_step(tree, at, step);
      if (child < 0) return false;
      at = tree[at].children[static_cast<size_t>(child)];
    }
    return true;
  };
  std::unordered_set<std::string> written;
  if (const ItemId passes = tree.find({0}, "passes"); passes.valid())
    for (const ItemId pass : tree[passes].children)
      for (std::string& resource : written_by(tree, pass))
        written.insert(std::move(resource));
  for (Change& change : composer.changes) {
    change.gone = (change.what == Change::What::remove || change.what == Change::What::replace) &&
                  !exists(change);
    std::erase_if(change.unwritten,
                  [&](const std::string& resource) { return written.contains(resource); });
  }
  find_replaced_values(composer.changes);
}

// Returns whether the diagnostic already refers to a place of the edit: "/edits/3/to/format".
bool shows_edit(const Diagnostic& one, const Change& change) {
  const SourceLocation& edit = change.where;
  const std::string_view edit_path =
      std::string_view(edit.pointer).substr(0, edit.pointer.rfind('/') + 1);
  const auto is_in_edit = [&](const SourceLocation& where) {
    return where.file == edit.file && where.pointer.starts_with(edit_path);
  };
  return is_in_edit(one.where) || std::any_of(one.related.begin(), one.related.end(),
                                              [&](const auto& at) { return is_in_edit(at.first); });
}

} // namespace

std::string_view change_name(Change::What what) {
  constexpr std::string_view names[] = {"include", "insert", "replace", "remove", "set"};
  return names[static_cast<size_t>(what)];
}

std::string Provenance::place(const Change& change) const {
  const uint32_t file = change.where.file.value;
  return fmt::format("{}:{}:{}", file < files.size() ? files[file].name : std::string(),
                     change.where.line, change.where.column);
}

void relate_to_removals(std::span<const Change> changes, size_t first, Diagnostics& diagnostics) {
  for (size_t i = first; i < diagnostics.list.size(); ++i) {
    Diagnostic& one = diagnostics.list[i];
    if (diagnostic_info(one.id).severity != Severity::error) continue;
    const auto names = [&](std::string_view name) {
      return one.text.find(fmt::format("'{}'", name)) != std::string::npos;
    };
    for (const Change& change : changes) {
      if (change.gone && std::any_of(change.removed.begin(), change.removed.end(), names))
        one.related.emplace_back(change.where, fmt::format("'{}' is removed here", change.at));
      const auto found = std::find_if(change.unwritten.begin(), change.unwritten.end(), names);
      if (found != change.unwritten.end())
        one.related.emplace_back(change.where,
                                 fmt::format("no pass writes '{}' after this edit", *found));
      if (std::any_of(change.affected.begin(), change.affected.end(), names) &&
          (change.affected_pass.empty() || names(change.affected_pass)) && !shows_edit(one, change))
        one.related.emplace_back(change.where, fmt::format("'{}' is set here", change.at));
    }
  }
}

bool check_file_name(std::string_view name, std::string_view what, const SourceLocation& where,
                     Diagnostics& diagnostics) {
  std::string problem;
  if (name.empty() || name.size() > limits::file_name_bytes)
    problem = fmt::format("the path has {} bytes; expected 1 .. {}", name.size(),
                          limits::file_name_bytes);
  else if (name.front() == '/')
    problem = "the path is absolute";
  else if (name.find_first_of("\\:") != std::string_view::npos)
    problem = "the path contains '\\' or ':'";
  for (size_t begin = 0; problem.empty() && begin <= name.size();) {
    const size_t end = std::min(name.find('/', begin), name.size());
    const std::string_view step = name.substr(begin, end - begin);
    if (step.empty() || step == "." || step == "..")
      problem = fmt::format("the path contains the step '{}'", step);
    begin = end + 1;
  }
  if (problem.empty()) return true;
  diagnostics.add(DiagnosticId::bad_file_name, where,
                  fmt::format("{} is not a valid file path: {}", what, problem));
  return false;
}

bool add_document(Composer& composer, Document document, const SourceLocation& where) {
  composer.bytes += composer.diagnostics.files[document.file.value].text.size();
  composer.nodes += document.nodes.size();
  std::string limit;
  if (composer.tree.documents.size() >= limits::graph_files)
    limit = fmt::format("{} files", limits::graph_files);
  else if (composer.bytes > limits::file_bytes)
    limit = fmt::format("{} bytes", limits::file_bytes);
  else if (composer.nodes > limits::nodes)
    limit = fmt::format("{} values", limits::nodes);
  if (!limit.empty()) {
    composer.error(
        DiagnosticId::limit_exceeded, where,
        fmt::format("the graph, with its includes and overlays, has more than {}", limit));
    return false;
  }
  composer.tree.documents.push_back(std::move(document));
  return true;
}

std::optional<Composition> compose(Document graph, std::vector<Document> overlays,
                                   const OpenFile& open, Diagnostics& diagnostics) {
  if (overlays.empty() && !has_includes(graph)) return Composition{std::move(graph), {}};
  if (!check_version(graph, "dermis", graph_format_version, diagnostics)) return std::nullopt;
  const uint64_t errors_before = diagnostics.errors();
  Composer composer{open, diagnostics};
  const SourceLocation root = graph.where(graph.root());
  if (!add_document(composer, std::move(graph), root)) return std::nullopt;
  composer.tree.insert_copy(0, composer.tree.documents.front().root());
  expand_graph(composer);
  // Errors of the graph are its own: edits of what is missing would hide them.
  if (diagnostics.errors() != errors_before) return std::nullopt;
  if (!composer.tree.find({0}, "passes").valid())
    return Composition{flatten(std::move(composer.tree)), {}}; // the graph's reader reports it
  for (Document& overlay : overlays) {
    const SourceLocation where = overlay.where(overlay.root());
    if (!add_document(composer, std::move(overlay), where)) break;
    apply_overlay(composer, static_cast<uint32_t>(composer.tree.documents.size() - 1));
  }
  if (diagnostics.errors() != errors_before) return std::nullopt;
  find_removals(composer);
  return Composition{flatten(std::move(composer.tree)), std::move(composer.changes)};
}

std::optional<Composition> compose_fragment(Document fragment, const OpenFile& open,
                                            Diagnostics& diagnostics) {
  const uint64_t errors_before = diagnostics.errors();
  const SourceLocation where = fragment.where(fragment.root());
  auto graph = parse_document("<graph of only the fragment>",
                              R"({ "dermis": 2, "name": "fragment", "passes": [], "exports": [] })",
                              diagnostics);
  Composer composer{open, diagnostics};
  if (!graph || !add_document(composer, std::move(*graph), where) ||
      !add_document(composer, std::move(fragment), where))
    return std::nullopt;
  composer.tree.insert_copy(0, composer.tree.documents.front().root());
  std::vector<ItemId> passes;
  join_fragment(composer, 1, passes);
  if (diagnostics.errors() != errors_before) return std::nullopt;
  composer.tree[composer.tree.find({0}, "passes")].children = std::move(passes);
  return Composition{flatten(std::move(composer.tree)), std::move(composer.changes)};
}

} // namespace dermis
