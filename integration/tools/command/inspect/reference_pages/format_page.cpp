// Tables of keys of the JSON Schemas.
#include "framegraph/text/document.hpp"
#include "integration/tools/command/inspect/reference_pages/pages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace dermis::tools {
namespace {

struct Row {
  std::string path, type, text;
  bool required = false;
};

// Format of one schema.
struct SchemaPage {
  const Document& schema;
  std::string_view name; // of the format
  std::vector<Row> rows = {};

  NodeId at(NodeId object, std::string_view key) const {
    return object.valid() && schema[object].kind == NodeKind::object ? schema.find(object, key)
                                                                     : NodeId{};
  }
  std::string text_at(NodeId object, std::string_view key) const {
    const NodeId found = at(object, key);
    return found.valid() && schema[found].kind == NodeKind::string ? std::string(schema.text(found))
                                                                   : "";
  }
  std::string value(NodeId id) const {
    const Node& node = schema[id];
    switch (node.kind) {
    case NodeKind::null:
      return "null";
    case NodeKind::boolean:
      return node.integer != 0 ? "true" : "false";
    case NodeKind::integer:
      return fmt::format("{}", node.integer);
    case NodeKind::real:
      return fmt::format("{}", node.real);
    case NodeKind::string:
      return fmt::format("`{}`", schema.text(id));
    case NodeKind::array:
    case NodeKind::object:
      break;
    }
    return "";
  }
  template <class Each> void each(NodeId parent, Each&& work) const {
    if (!parent.valid()) return;
    for (NodeId child = schema[parent].first_child; child.valid(); child = schema[child].next)
      work(child);
  }
  std::string joined(NodeId list, std::string_view between, auto&& text) const {
    std::string out;
    each(list, [&](NodeId one) {
      const std::string word = text(one);
      if (!word.empty()) out.append(out.empty() ? "" : between).append(word);
    });
    return out;
  }

  std::string range(NodeId of, std::string_view minimum, std::string_view maximum) const {
    const NodeId low = at(of, minimum), high = at(of, maximum);
    const auto is_single = [&](NodeId id) { // the whole range of a float is not printed
      return !id.valid() || std::abs(schema[id].real) > 3e38;
    };
    if (is_single(low) && is_single(high)) return "";
    if (!low.valid()) return fmt::format(" up to {}", value(high));
    if (!high.valid()) return fmt::format(" from {}", value(low));
    const std::string min_text = value(low), max_text = value(high);
    return min_text == max_text ? fmt::format(" of exactly {}", min_text)
                                : fmt::format(" {} .. {}", min_text, max_text);
  }

  // "integer 1 .. 8", "`a`, `b`", "array of name".
  std::string type_of(NodeId of) const {
    if (const std::string reference = text_at(of, "$ref"); !reference.empty())
      return fmt::format("[{0}](#{0}-{1})", reference.substr(reference.rfind('/') + 1), name);
    if (const NodeId one = at(of, "const"); one.valid()) return value(one);
    if (const NodeId list = at(of, "enum"); list.valid())
      return joined(list, ", ", [&](NodeId id) { return value(id); });
    for (const char* choice : {"anyOf", "oneOf"})
      if (const NodeId list = at(of, choice); list.valid())
        return joined(list, " or ", [&](NodeId id) { return type_of(id); });
    const NodeId type = at(of, "type");
    if (!type.valid()) return "any";
    if (schema[type].kind == NodeKind::array)
      return joined(type, " or ", [&](NodeId id) { return std::string(schema.text(id)); });
    const std::string kind(schema.text(type));
    if (kind == "integer" || kind == "number") return kind + range(of, "minimum", "maximum");
    if (kind == "array") {
      const NodeId items = at(of, "items");
      return "array" + range(of, "minItems", "maxItems") +
             (items.valid() ? ", each " + type_of(items) : "");
    }
    if (kind == "object")
      if (const NodeId more = at(of, "additionalProperties");
          more.valid() && schema[more].kind == NodeKind::object)
        return "object of " + type_of(more);
    return kind;
  }

  void add(Row row) {
    const bool known =
        std::any_of(rows.begin(), rows.end(), [&](const Row& one) { return one.path == row.path; });
    if (!known) rows.push_back(std::move(row));
  }

  // Adds the keys of an object, of all its variants, and of nested unnamed objects.
  void add_keys(NodeId object, const std::string& before) {
    const NodeId required = at(object, "required");
    each(at(object, "properties"), [&](NodeId property) {
      const std::string key(schema.key(property));
      if (key == "$schema") return;
      Row row{before + key, type_of(property), text_at(property, "description")};
      each(required, [&](NodeId one) { row.required = row.required || schema.text(one) == key; });
      add(std::move(row));
      add_keys(property, before + key + ".");
      if (const NodeId items = at(property, "items");
          items.valid() && schema[items].kind == NodeKind::object)
        add_keys(items, before + key + "[].");
    });
    for (const char* form : {"then", "else"})
      if (const NodeId found = at(object, form); found.valid()) add_keys(found, before);
    for (const char* list : {"allOf", "anyOf", "oneOf"})
      each(at(object, list), [&](NodeId form) {
        if (text_at(form, "$ref").empty()) add_keys(form, before);
      });
  }

  std::string table_of(NodeId object) {
    rows.clear();
    add_keys(object, "");
    std::string out;
    if (rows.empty()) return out;
    out = "| key | | value | |\n|---|---|---|---|\n";
    for (const Row& row : rows)
      out += fmt::format("| `{}` | {} | {} | {} |\n", row.path, row.required ? "required" : "",
                         cell(row.type), cell(row.text));
    return out + "\n";
  }

  std::string page() {
    const NodeId root = schema.root();
    std::string out =
        fmt::format("## {}\n\n{}\n\n", name, text_at(root, "description")) + table_of(root);
    each(at(root, "definitions"), [&](NodeId one) {
      const std::string_view key = schema.key(one);
      if (key == "pass_of_a_kind") return; // documented in pass_types.md
      const std::string table = table_of(one);
      const std::string text = text_at(one, "description");
      // the heading includes the format, since formats share names of definitions
      out += fmt::format("### {} ({})\n\n", key, name);
      if (table.empty())
        out += fmt::format("{}{}{}\n\n", cell(type_of(one)), text.empty() ? "" : ": ", text);
      if (!table.empty() && !text.empty()) out += text + "\n\n";
      out += table;
    });
    return out;
  }
};

} // namespace

std::string format_page(std::span<const std::pair<std::string_view, std::string>> schemas) {
  std::string out =
      "# Formats, key by key\n\nGenerated by `dermis docs` from the schemas in `configs/schema/`; "
      "[format.md](format.md), [overlays.md](overlays.md),\n[profiles.md](profiles.md), "
      "[scenes.md](scenes.md), [capture.md](capture.md) and [plans.md](plans.md) explain them. "
      "`a.b` is the key `b` of the object\n`a`, `a[]` an element of the array `a`. Objects with "
      "several forms list the keys of all forms.\n\n";
  for (const auto& [name, text] : schemas) {
    if (name == "fragment") continue; // a graph without settings of its own
    Diagnostics diagnostics;
    const auto document = parse_document(std::string(name), text, diagnostics);
    if (document) out += SchemaPage{*document, name}.page();
  }
  out.pop_back();
  return out;
}

} // namespace dermis::tools
