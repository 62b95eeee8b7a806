#include "integration/tools/command/inspect/upgrade_text.hpp"

#include "framegraph/text/reader.hpp"
#include "integration/tools/command/inspect/upgrade_passes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

namespace dermis::tools {
namespace {

constexpr int64_t new_version = 2;

const Document& renames() {
  static const Document table = [] {
    Diagnostics diagnostics;
    return *parse_document("renames.json", std::string(renames_text()), diagnostics);
  }();
  return table;
}

// Follows `path` through the objects of the table; invalid if a step is missing.
NodeId entry(std::initializer_list<std::string_view> path) {
  NodeId node = renames().root();
  for (const std::string_view key : path)
    if (node = renames().find(node, key); !node.valid()) break;
  return node;
}

std::string_view new_name(std::initializer_list<std::string_view> path) {
  const NodeId node = entry(path);
  return node.valid() ? renames().text(node) : std::string_view();
}

// Finds the new name of a port or setting in a path of an overlay, where the pass type is unknown.
std::string_view new_name_in_any_type(std::string_view group, std::string_view name) {
  for (const NodeId type : children(renames(), entry({"pass_types"})))
    if (const NodeId names = renames().find(type, group); names.valid())
      if (const NodeId found = renames().find(names, name); found.valid())
        return renames().text(found);
  return {};
}

class Upgrade : private TextEdits {
public:
  using TextEdits::result;
  using TextEdits::TextEdits;

  // `key`: of the version in the file.
  void version(std::string_view key) {
    const NodeId node = document.find(document.root(), key);
    size_t end = document[node].offset;
    while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end])) != 0)
      ++end;
    replace(document[node].offset, end, fmt::to_string(new_version));
  }

  void passes(NodeId list) {
    if (!is_array(list)) return;
    std::vector<NodeId> objects = children(document, list);
    std::erase_if(objects, [&](NodeId node) { return document[node].kind != NodeKind::object; });
    for (const NodeId pass : objects)
      upgrade_pass(pass);
    upgrade_separable(*this, objects, added_);
    upgrade_levels(*this, objects, added_);
    upgrade_tile_variance(*this, objects, added_);
    upgrade_level_light(*this, objects);
  }

  // Declares the resources of the ports that passes of the file write in addition.
  void add_resources() {
    const NodeId resources = document.find(document.root(), "resources");
    const bool declared = resources.valid() && document[resources].kind == NodeKind::object;
    std::string members;
    for (const auto& [name, port] : added_)
      members += fmt::format("{}\"{}\": {}", members.empty() ? "" : ", ", name,
                             new_name({"added_ports", "resources", port}));
    if (members.empty()) return;
    if (declared)
      add_member(resources, members);
    else
      add_member(document.root(), fmt::format("\"resources\": {{ {} }}", members));
  }

  void overlay_edits() {
    for (const NodeId edit : objects_of("edits")) {
      if (const NodeId list = document.find(edit, "passes"); list.valid()) passes(list);
      for (const char* key : {"insert_before", "insert_after", "replace"})
        if (const NodeId target = string_at(edit, key); target.valid())
          rename(target, new_name({"shipped_passes", document.text(target), "pass"}));
      for (const char* key : {"set", "remove"})
        if (const NodeId path = string_at(edit, key); path.valid())
          upgrade_path(path, document.find(edit, "to"));
    }
  }

  void error_table() {
    for (const NodeId row : objects_of("techniques")) {
      const NodeId list = document.find(row, "kinds");
      if (!is_array(list)) continue;
      rename_key(list, new_name({"error_tables", "kinds"}));
      for (const NodeId match : children(document, list)) {
        if (document[match].kind != NodeKind::object) continue;
        const NodeId type = string_at(match, "kind");
        if (!type.valid()) continue;
        rename_names(document.find(match, "set"), document.text(type), "settings");
        rename_key(type, new_name({"error_tables", "kind"}));
        rename(type, new_name({"pass_types", document.text(type), "type"}));
      }
    }
  }

  // Upgrades rows such as "subsurface.mend lod_bias=-1.5 share=0.5": a pass type and values of
  // settings.
  void calibration() {
    for (const NodeId row : objects_of("costs")) {
      const NodeId work = string_at(row, "work");
      if (!work.valid()) continue;
      const std::string_view old = document.text(work);
      const std::string_view type = old.substr(0, old.find(' '));
      const std::string_view renamed = new_name({"pass_types", type, "type"});
      std::string text(renamed.empty() ? type : renamed);
      for (size_t at = type.size(); at < old.size();) {
        const size_t next = std::min(old.find(' ', at + 1), old.size());
        const std::string_view word = old.substr(at + 1, next - at - 1);
        const size_t equals = std::min(word.find('='), word.size());
        const std::string_view name =
            new_name({"pass_types", type, "settings", word.substr(0, equals)});
        text +=
            fmt::format(" {}{}", name.empty() ? word.substr(0, equals) : name, word.substr(equals));
        at = next;
      }
      if (text != old) rename(work, text);
    }
  }

  void pass_type_file() {
    for (const char* key : {"dermis_kinds", "kinds"})
      if (const NodeId node = document.find(document.root(), key); node.valid())
        rename_key(node, new_name({"pass_type_files", key}));
  }

private:
  // Returns the objects of the array `key` of the root.
  std::vector<NodeId> objects_of(std::string_view key) const {
    const NodeId list = document.find(document.root(), key);
    std::vector<NodeId> out = is_array(list) ? children(document, list) : std::vector<NodeId>();
    std::erase_if(out, [&](NodeId node) { return document[node].kind != NodeKind::object; });
    return out;
  }

  // Returns the resource at the port `classes` of a pass; "classes" without such a port.
  std::string_view classes_of(NodeId pass) const {
    for (const char* side : {"read", "write"})
      if (const NodeId ports = document.find(pass, side);
          ports.valid() && document[ports].kind == NodeKind::object)
        if (const NodeId classes = string_at(ports, "classes"); classes.valid())
          return document.text(classes);
    return "classes";
  }

  // Adds the port that version 2 of the pass type `type` writes in addition.
  void add_port(NodeId pass, std::string_view type) {
    const std::string_view port = new_name({"added_ports", "pass_types", type});
    const NodeId written = document.find(pass, "write");
    if (port.empty() || !written.valid() || document[written].kind != NodeKind::object) return;
    const std::string_view classes = classes_of(pass);
    const std::string resource =
        classes == "classes" ? std::string(port) : fmt::format("{}_of_{}", port, classes);
    add_member(written, fmt::format("\"{}\": \"{}\"", port, resource));
    added_.emplace(resource, port);
  }

  void rename_names(NodeId object, std::string_view type, std::string_view group) {
    if (!object.valid() || document[object].kind != NodeKind::object) return;
    for (const NodeId value : children(document, object))
      rename_key(value, new_name({"pass_types", type, group, document.key(value)}));
  }

  void upgrade_pass(NodeId pass) {
    const NodeId type = document.find(pass, "kind");
    if (!type.valid()) return;
    rename_key(type, new_name({"pass_keys", "kind"}));
    if (document[type].kind != NodeKind::string) return;
    const std::string_view old = document.text(type);
    rename(type, new_name({"pass_types", old, "type"}));
    for (const char* side : {"read", "write"})
      rename_names(document.find(pass, side), old, "ports");
    rename_names(document.find(pass, "set"), old, "settings");
    add_port(pass, old);
    const NodeId name = string_at(pass, "pass");
    if (name.valid() && new_name({"shipped_passes", document.text(name), "type"}) == old)
      rename(name, new_name({"shipped_passes", document.text(name), "pass"}));
  }

  // Upgrades "/passes/NAME/kind", "/passes/NAME/read/PORT", "/passes/NAME/set/SETTING" and the
  // values set there.
  void upgrade_path(NodeId node, NodeId to) {
    std::vector<std::string> steps;
    for (std::string_view rest = document.text(node); !rest.empty();) {
      const size_t slash = std::min(rest.find('/', 1), rest.size());
      steps.emplace_back(rest.substr(0, slash));
      rest.remove_prefix(slash);
    }
    if (steps.size() < 2 || steps[0] != "/passes") return;
    if (steps.size() == 2 && to.valid() && document[to].kind == NodeKind::object) upgrade_pass(to);
    const auto take = [](std::string& step, std::string_view name) {
      if (!name.empty()) step = fmt::format("/{}", name);
    };
    take(steps[1], new_name({"shipped_passes", std::string_view(steps[1]).substr(1), "pass"}));
    if (steps.size() >= 3) {
      const std::string group = steps[2] == "/set" ? "settings" : "ports";
      if (steps.size() == 3 && steps[2] == "/kind") {
        if (to.valid() && document[to].kind == NodeKind::string)
          rename(to, new_name({"pass_types", document.text(to), "type"}));
        take(steps[2], new_name({"pass_keys", "kind"}));
      } else if (steps.size() >= 4 &&
                 (steps[2] == "/read" || steps[2] == "/write" || steps[2] == "/set")) {
        take(steps[3], new_name_in_any_type(group, std::string_view(steps[3]).substr(1)));
      }
    }
    std::string path;
    for (const std::string& step : steps)
      path += step;
    if (path != document.text(node)) rename(node, path);
  }

  AddedResources added_;
};

} // namespace

std::optional<std::string> upgraded_text(const Document& document, FileKindId kind,
                                         std::string_view text) {
  Upgrade upgrade(document, text);
  switch (kind) {
  case FileKindId::graph:
  case FileKindId::fragment:
    upgrade.passes(document.find(document.root(), "passes"));
    upgrade.add_resources();
    break;
  case FileKindId::overlay:
    upgrade.overlay_edits();
    break;
  case FileKindId::errors:
    upgrade.error_table();
    break;
  case FileKindId::calibration:
    upgrade.calibration();
    break;
  case FileKindId::pass_types:
    upgrade.pass_type_file();
    break;
  default:
    return std::nullopt;
  }
  const bool old_key = document.find(document.root(), "dermis_kinds").valid();
  upgrade.version(old_key ? "dermis_kinds" : file_kinds()[static_cast<size_t>(kind)].version_key);
  return upgrade.result();
}

} // namespace dermis::tools
