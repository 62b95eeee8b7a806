#include "integration/tools/command/inspect/upgrade_text.hpp"

#include "framegraph/text/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
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

class Upgrade {
public:
  Upgrade(const Document& document, std::string_view text) : document_(document), text_(text) {
    line_begins_.push_back(0);
    for (size_t i = 0; i < text.size(); ++i)
      if (text[i] == '\n') line_begins_.push_back(i + 1);
  }

  void version(std::string_view key) {
    const NodeId node = document_.find(document_.root(), key);
    size_t end = document_[node].offset;
    while (end < text_.size() && std::isdigit(static_cast<unsigned char>(text_[end])) != 0)
      ++end;
    replace(document_[node].offset, end, fmt::to_string(new_version));
  }

  void passes(NodeId list) {
    if (!is_array(list)) return;
    std::vector<NodeId> objects = children(document_, list);
    std::erase_if(objects, [&](NodeId node) { return document_[node].kind != NodeKind::object; });
    for (const NodeId pass : objects)
      upgrade_pass(pass);
    upgrade_separable(objects);
  }

  // Declares the resources of the ports that passes of the file write in addition.
  void add_resources() {
    const NodeId resources = document_.find(document_.root(), "resources");
    const bool declared = resources.valid() && document_[resources].kind == NodeKind::object;
    std::string members;
    for (const auto& [name, port] : added_)
      members += fmt::format("{}\"{}\": {}", members.empty() ? "" : ", ", name,
                             new_name({"added_ports", "resources", port}));
    if (members.empty()) return;
    if (declared)
      add_member(resources, members);
    else
      add_member(document_.root(), fmt::format("\"resources\": {{ {} }}", members));
  }

  void overlay_edits() {
    for (const NodeId edit : objects_of("edits")) {
      if (const NodeId list = document_.find(edit, "passes"); list.valid()) passes(list);
      for (const char* key : {"insert_before", "insert_after", "replace"})
        if (const NodeId target = string_at(edit, key); target.valid())
          rename(target, new_name({"shipped_passes", document_.text(target), "pass"}));
      for (const char* key : {"set", "remove"})
        if (const NodeId path = string_at(edit, key); path.valid())
          upgrade_path(path, document_.find(edit, "to"));
    }
  }

  void error_table() {
    for (const NodeId row : objects_of("techniques")) {
      const NodeId list = document_.find(row, "kinds");
      if (!is_array(list)) continue;
      rename_key(list, new_name({"error_tables", "kinds"}));
      for (const NodeId match : children(document_, list)) {
        if (document_[match].kind != NodeKind::object) continue;
        const NodeId type = string_at(match, "kind");
        if (!type.valid()) continue;
        rename_names(document_.find(match, "set"), document_.text(type), "settings");
        rename_key(type, new_name({"error_tables", "kind"}));
        rename(type, new_name({"pass_types", document_.text(type), "type"}));
      }
    }
  }

  // Upgrades rows such as "subsurface.mend lod_bias=-1.5 share=0.5": a pass type and values of
  // settings.
  void calibration() {
    for (const NodeId row : objects_of("costs")) {
      const NodeId work = string_at(row, "work");
      if (!work.valid()) continue;
      const std::string_view old = document_.text(work);
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
      if (const NodeId node = document_.find(document_.root(), key); node.valid())
        rename_key(node, new_name({"pass_type_files", key}));
  }

  std::string result() {
    std::sort(edits_.begin(), edits_.end(),
              [](const Edit& a, const Edit& b) { return a.begin < b.begin; });
    std::string out;
    size_t at = 0;
    for (const Edit& edit : edits_) {
      out.append(text_.substr(at, edit.begin - at)).append(edit.text);
      at = edit.end;
    }
    return out.append(text_.substr(at));
  }

private:
  struct Edit {
    size_t begin, end; // byte range of the old text
    std::string text;
  };

  bool is_array(NodeId node) const {
    return node.valid() && document_[node].kind == NodeKind::array;
  }

  // Returns the objects of the array `key` of the root.
  std::vector<NodeId> objects_of(std::string_view key) const {
    const NodeId list = document_.find(document_.root(), key);
    std::vector<NodeId> out = is_array(list) ? children(document_, list) : std::vector<NodeId>();
    std::erase_if(out, [&](NodeId node) { return document_[node].kind != NodeKind::object; });
    return out;
  }

  NodeId string_at(NodeId object, std::string_view key) const {
    const NodeId node = document_.find(object, key);
    return node.valid() && document_[node].kind == NodeKind::string ? node : NodeId{};
  }

  void replace(size_t begin, size_t end, std::string text) {
    edits_.push_back({begin, end, std::move(text)});
  }

  // Replaces the string that begins with the quote at `begin`.
  void replace_string(size_t begin, std::string_view text) {
    replace(begin, end_of_string(begin), fmt::format("\"{}\"", text));
  }

  void rename(NodeId string, std::string_view text) {
    if (!text.empty()) replace_string(document_[string].offset, text);
  }

  void rename_key(NodeId value, std::string_view text) {
    if (!text.empty()) replace_string(key_begin(value), text);
  }

  void add_member(NodeId object, std::string_view member) {
    const size_t begin = document_[object].offset + 1;
    const bool empty = children(document_, object).empty();
    replace(begin, begin, fmt::format(" {}{}", member, empty ? " " : ","));
  }

  // Returns the resource at the port `classes` of a pass; "classes" without such a port.
  std::string_view classes_of(NodeId pass) const {
    for (const char* side : {"read", "write"})
      if (const NodeId ports = document_.find(pass, side);
          ports.valid() && document_[ports].kind == NodeKind::object)
        if (const NodeId classes = string_at(ports, "classes"); classes.valid())
          return document_.text(classes);
    return "classes";
  }

  // Adds the port that version 2 of the pass type `type` writes in addition.
  void add_port(NodeId pass, std::string_view type) {
    const std::string_view port = new_name({"added_ports", "pass_types", type});
    const NodeId written = document_.find(pass, "write");
    if (port.empty() || !written.valid() || document_[written].kind != NodeKind::object) return;
    const std::string_view classes = classes_of(pass);
    const std::string resource =
        classes == "classes" ? std::string(port) : fmt::format("{}_of_{}", port, classes);
    add_member(written, fmt::format("\"{}\": \"{}\"", port, resource));
    added_.emplace(resource, port);
  }

  void rename_names(NodeId object, std::string_view type, std::string_view group) {
    if (!object.valid() || document_[object].kind != NodeKind::object) return;
    for (const NodeId value : children(document_, object))
      rename_key(value, new_name({"pass_types", type, group, document_.key(value)}));
  }

  void upgrade_pass(NodeId pass) {
    const NodeId type = document_.find(pass, "kind");
    if (!type.valid()) return;
    rename_key(type, new_name({"pass_keys", "kind"}));
    if (document_[type].kind != NodeKind::string) return;
    const std::string_view old = document_.text(type);
    rename(type, new_name({"pass_types", old, "type"}));
    for (const char* side : {"read", "write"})
      rename_names(document_.find(pass, side), old, "ports");
    rename_names(document_.find(pass, "set"), old, "settings");
    add_port(pass, old);
    const NodeId name = string_at(pass, "pass");
    if (name.valid() && new_name({"shipped_passes", document_.text(name), "type"}) == old)
      rename(name, new_name({"shipped_passes", document_.text(name), "pass"}));
  }

  std::string_view type_of(NodeId pass) const {
    const NodeId type = string_at(pass, "kind");
    return type.valid() ? document_.text(type) : std::string_view();
  }

  // Returns the resource at a port of a pass; "" without the port.
  std::string_view at_port(NodeId pass, std::string_view side, std::string_view port) const {
    const NodeId ports = document_.find(pass, side);
    if (!ports.valid() || document_[ports].kind != NodeKind::object) return {};
    const NodeId value = string_at(ports, port);
    return value.valid() ? document_.text(value) : std::string_view();
  }

  size_t key_begin(NodeId value) const {
    return line_begins_[document_[value].key_line - 1] + document_[value].key_column - 1;
  }

  // Returns the place after the string whose opening quote is at `begin`.
  size_t end_of_string(size_t begin) const {
    size_t end = begin + 1;
    while (text_[end] != '"')
      end += text_[end] == '\\' ? 2 : 1;
    return end + 1;
  }

  void replace_member(NodeId pass, std::string_view port, std::string member) {
    const NodeId value = string_at(document_.find(pass, "read"), port);
    replace(key_begin(value), end_of_string(document_[value].offset), std::move(member));
  }

  // Removes a port under "read" with one of the commas around it.
  void remove_member(NodeId pass, std::string_view port) {
    const NodeId value = string_at(document_.find(pass, "read"), port);
    size_t begin = key_begin(value), end = end_of_string(document_[value].offset);
    const size_t after = text_.find_first_not_of(" \n\r\t", end);
    if (text_[after] == ',')
      end = text_.find_first_not_of(" \n\r\t", after + 1);
    else if (const size_t before = text_.find_last_not_of(" \n\r\t", begin - 1);
             text_[before] == ',')
      begin = before;
    const auto lines = static_cast<size_t>(std::count(text_.begin() + std::ptrdiff_t(begin),
                                                      text_.begin() + std::ptrdiff_t(end), '\n'));
    replace(begin, end, std::string(lines, '\n'));
  }

  // Version 2 of subsurface.separable reads the light and the view depth that
  // subsurface.separable_setup writes, in place of light, material and depth.
  void upgrade_separable(const std::vector<NodeId>& passes) {
    std::map<std::string_view, std::string> lights; // by old light: the light of version 2
    for (const NodeId pass : passes) {
      const std::string_view light = at_port(pass, "read", "light");
      if (type_of(pass) != "subsurface.separable" || light.empty() ||
          at_port(pass, "read", "material").empty() || at_port(pass, "read", "depth").empty())
        continue;
      const std::string view_depth = name_for("view_depth", light);
      auto known = lights.find(light);
      if (known == lights.end()) {
        added_.emplace(view_depth, "view_depth");
        known = lights.emplace(light, set_up_separable(passes, pass, view_depth)).first;
      }
      if (known->second != light)
        replace_member(pass, "light", fmt::format("\"light\": \"{}\"", known->second));
      replace_member(pass, "material", fmt::format("\"view_depth\": \"{}\"", view_depth));
      remove_member(pass, "depth");
    }
  }

  static std::string name_for(std::string_view what, std::string_view light) {
    return light == "light" ? std::string(what) : fmt::format("{}_of_{}", what, light);
  }

  // Converts the setup pass of a separable pass, or inserts a new one if other passes read what it
  // writes. Returns the resource with the light.
  std::string set_up_separable(const std::vector<NodeId>& passes, NodeId separable,
                               const std::string& view_depth) {
    const std::string_view light = at_port(separable, "read", "light");
    NodeId setup;
    bool shared = false;
    std::string_view classes = "classes";
    for (const NodeId pass : passes) {
      if (type_of(pass) == "subsurface.setup" && at_port(pass, "write", "light") == light)
        setup = pass;
      if (type_of(pass) == "subsurface.classify" &&
          at_port(pass, "read", "material") == at_port(separable, "read", "material"))
        classes = at_port(pass, "write", "classes");
      if (const NodeId read = document_.find(pass, "read");
          read.valid() && type_of(pass) != "subsurface.separable")
        for (const NodeId value : children(document_, read))
          shared = shared ||
                   (document_[value].kind == NodeKind::string && document_.text(value) == light);
    }
    if (setup.valid() && !shared &&
        children(document_, document_.find(setup, "write")).size() == 1 &&
        !at_port(setup, "read", "tiles").empty() && !at_port(setup, "read", "arguments").empty()) {
      rename(string_at(setup, "kind"), "subsurface.separable_setup");
      replace_member(setup, "tiles", fmt::format("\"classes\": \"{}\"", classes));
      remove_member(setup, "arguments");
      add_member(document_.find(setup, "write"), fmt::format("\"view_depth\": \"{}\"", view_depth));
      return std::string(light);
    }
    const std::string own_light = name_for("separable_light", light);
    added_.emplace(own_light, "separable_light");
    const std::string_view lighting = setup.valid() ? at_port(setup, "read", "lighting") : light;
    const std::string_view albedo =
        setup.valid() ? at_port(setup, "read", "albedo") : std::string_view();
    const NodeId set = setup.valid() ? document_.find(setup, "set") : NodeId{};
    const NodeId texturing = set.valid() ? string_at(set, "texturing") : NodeId{};
    const size_t begin = document_[separable].offset;
    replace(begin, begin,
            fmt::format(
                R"({{ "pass": "{}", "type": "subsurface.separable_setup", "read": )"
                R"({{ "lighting": "{}", "material": "{}", "depth": "{}"{}, "classes": "{}" }}, )"
                R"("write": {{ "light": "{}", "view_depth": "{}" }}{} }}, )",
                name_for("separable_setup", light), lighting,
                at_port(separable, "read", "material"), at_port(separable, "read", "depth"),
                albedo.empty() ? "" : fmt::format(R"(, "albedo": "{}")", albedo), classes,
                own_light, view_depth,
                texturing.valid()
                    ? fmt::format(R"(, "set": {{ "texturing": "{}" }})", document_.text(texturing))
                    : ""));
    return own_light;
  }

  // Upgrades "/passes/NAME/kind", "/passes/NAME/read/PORT", "/passes/NAME/set/SETTING" and the
  // values set there.
  void upgrade_path(NodeId node, NodeId to) {
    std::vector<std::string> steps;
    for (std::string_view rest = document_.text(node); !rest.empty();) {
      const size_t slash = std::min(rest.find('/', 1), rest.size());
      steps.emplace_back(rest.substr(0, slash));
      rest.remove_prefix(slash);
    }
    if (steps.size() < 2 || steps[0] != "/passes") return;
    if (steps.size() == 2 && to.valid() && document_[to].kind == NodeKind::object) upgrade_pass(to);
    const auto take = [](std::string& step, std::string_view name) {
      if (!name.empty()) step = fmt::format("/{}", name);
    };
    take(steps[1], new_name({"shipped_passes", std::string_view(steps[1]).substr(1), "pass"}));
    if (steps.size() >= 3) {
      const std::string group = steps[2] == "/set" ? "settings" : "ports";
      if (steps.size() == 3 && steps[2] == "/kind") {
        if (to.valid() && document_[to].kind == NodeKind::string)
          rename(to, new_name({"pass_types", document_.text(to), "type"}));
        take(steps[2], new_name({"pass_keys", "kind"}));
      } else if (steps.size() >= 4 &&
                 (steps[2] == "/read" || steps[2] == "/write" || steps[2] == "/set")) {
        take(steps[3], new_name_in_any_type(group, std::string_view(steps[3]).substr(1)));
      }
    }
    std::string path;
    for (const std::string& step : steps)
      path += step;
    if (path != document_.text(node)) rename(node, path);
  }

  const Document& document_;
  std::string_view text_;
  std::vector<size_t> line_begins_;
  std::vector<Edit> edits_;
  std::map<std::string, std::string_view> added_; // by resource: the added port
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
  const std::string_view key = kind == FileKindId::pass_types
                                   ? "dermis_kinds"
                                   : file_kinds()[static_cast<size_t>(kind)].version_key;
  upgrade.version(key);
  return upgrade.result();
}

} // namespace dermis::tools
