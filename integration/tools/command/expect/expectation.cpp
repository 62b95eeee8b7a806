#include "integration/tools/command/expect/expectation.hpp"

#include "framegraph/compose/compose.hpp"
#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/reader.hpp"
#include "integration/tools/command/graph_input.hpp"

#include <fmt/format.h>

#include <limits>

namespace dermis::tools {
namespace {

constexpr size_t max_cases = 1024;
constexpr size_t max_names = 4096; // limit on passes of a graph in limits.hpp
constexpr int64_t max_side = 16384;

struct CaseReader {
  const Document& document;
  Diagnostics& diagnostics;
  bool ok = true;

  void reject(NodeId node, std::string text) {
    diagnostics.add(DiagnosticId::invalid_value, document.where(node), std::move(text));
    ok = false;
  }

  std::vector<std::string> strings(NodeId list, std::string_view what) {
    std::vector<std::string> out;
    if (!list.valid()) return out;
    for (const NodeId node : children(document, list)) {
      const auto text = read_string(document, node, what, diagnostics);
      ok &= text.has_value();
      if (text) out.emplace_back(*text);
    }
    return out;
  }

  std::optional<Format> format(NodeId node, std::string_view what) {
    const auto name = read_string(document, node, what, diagnostics);
    ok &= name.has_value();
    if (!name) return std::nullopt;
    const std::optional<Format> found = format_from_name(*name);
    if (!found) reject(node, fmt::format("{}: there is no format '{}'", what, *name));
    return found;
  }

  void feature(NodeId node, ExpectedCase& out) {
    const auto name = read_string(document, node, "'lacks'", diagnostics);
    ok &= name.has_value();
    if (!name) return;
    if (const std::optional<Feature> found = feature_from_name(*name))
      out.unmet |= bit_of(*found);
    else
      reject(node, fmt::format("'lacks': there is no feature '{}'", *name));
  }

  // Returns values as --set accepts them; the graph determines their types later.
  std::vector<NamedValue> settings(NodeId object) {
    std::vector<NamedValue> out;
    if (!object.valid()) return out;
    for (const NodeId node : children(document, object)) {
      const Node& value = document[node];
      const std::string name(document.key(node));
      if (value.kind == NodeKind::string)
        out.emplace_back(name, document.text(node));
      else if (value.kind == NodeKind::boolean)
        out.emplace_back(name, value.integer != 0 ? "true" : "false");
      else if (value.kind == NodeKind::integer)
        out.emplace_back(name, fmt::format("{}", value.integer));
      else if (value.kind == NodeKind::real)
        out.emplace_back(name, fmt::format("{}", value.real));
      else
        reject(node, fmt::format("setting '{}': expected a bool, a number or a string, found {}",
                                 name, kind_name(value.kind)));
    }
    return out;
  }

  void size(NodeId list, Size& out) {
    if (!list.valid()) return;
    uint32_t* const sides[] = {&out.width, &out.height};
    size_t i = 0;
    for (const NodeId node : children(document, list)) {
      const auto side = read_integer(document, node, "a side of 'size'", 1, max_side, diagnostics);
      ok &= side.has_value();
      if (side) *sides[i] = static_cast<uint32_t>(*side);
      ++i;
    }
  }

  void overlays(NodeId list, ExpectedCase& out) {
    if (!list.valid()) return;
    for (const NodeId node : children(document, list)) {
      const auto name = read_string(document, node, "the name of an overlay", diagnostics);
      ok &= name &&
            check_file_name(*name, fmt::format("'{}'", *name), document.where(node), diagnostics);
      if (name) out.overlays.emplace_back(*name);
    }
  }

  void device(NodeId node, ExpectedCase& out) {
    if (!node.valid()) return;
    ObjectReader object(document, node, fmt::format("'device' of case '{}'", out.name),
                        diagnostics);
    const NodeId formats =
        object.array("unsupported_formats", 0, static_cast<size_t>(Format::count), Need::optional);
    if (formats.valid())
      for (const NodeId one : children(document, formats))
        if (const auto found = format(one, "'unsupported_formats'"))
          out.unsupported_formats.push_back(*found);
    if (const NodeId unmet =
            object.array("lacks", 0, static_cast<size_t>(Feature::count), Need::optional);
        unmet.valid())
      for (const NodeId one : children(document, unmet))
        feature(one, out);
    if (const auto side = object.integer("max_image_dimension", 1, max_side, Need::optional))
      out.max_image_dimension = static_cast<uint32_t>(*side);
    ok &= object.finish();
  }

  MachineInfo info(NodeId node, const std::string& name) {
    MachineInfo out;
    ObjectReader object(document, node, fmt::format("'expect' of case '{}'", name), diagnostics);
    if (const NodeId list = object.array("passes", 0, max_names, Need::optional); list.valid())
      out.passes = strings(list, "a pass");
    if (const NodeId all = object.object("culled", Need::optional); all.valid()) {
      out.culled.emplace();
      for (const NodeId one : children(document, all)) {
        const auto why = read_string(document, one, "why a pass is culled", diagnostics);
        ok &= why.has_value();
        if (why) out.culled->emplace(document.key(one), *why);
      }
    }
    const auto count = [&](std::string_view key, std::optional<uint64_t>& into) {
      const auto value =
          object.integer(key, 0, std::numeric_limits<int64_t>::max(), Need::optional);
      if (value) into = static_cast<uint64_t>(*value);
    };
    count("barriers", out.barriers);
    count("batches", out.batches);
    count("transient_bytes", out.transient_bytes);
    count("history_bytes", out.history_bytes);
    out.diagnostics = strings(object.array("diagnostics", 0, max_names, Need::optional),
                              "the id of a diagnostic");
    ok &= object.finish();
    return out;
  }

  ExpectedCase one_case(NodeId node) {
    ExpectedCase out;
    out.node = node;
    out.size = default_size;
    ObjectReader object(document, node, "a case", diagnostics);
    if (!object.ok()) {
      ok = false;
      return out;
    }
    out.name = object.string("case").value_or("");
    size(object.array("size", 2, 2, Need::optional), out.size);
    out.settings = settings(object.object("set", Need::optional));
    out.unbound = strings(object.array("unbound", 0, max_names, Need::optional), "an unbound slot");
    if (const NodeId formats = object.object("host_formats", Need::optional); formats.valid())
      for (const NodeId one : children(document, formats))
        if (const auto found = format(one, "'host_formats'"))
          out.host_formats.emplace(document.key(one), *found);
    overlays(object.array("overlays", 0, limits::graph_files, Need::optional), out);
    device(object.object("device", Need::optional), out);
    out.info_node = object.object("expect", Need::optional);
    if (out.info_node.valid()) out.info = info(out.info_node, out.name);
    ok &= object.finish();
    return out;
  }
};

// Returns one past the last byte of the value that begins at `begin`. The text must be valid JSON.
size_t end_of_value(const std::string& text, size_t begin) {
  if (text[begin] != '{' && text[begin] != '[' && text[begin] != '"')
    return std::min(text.find_first_of(",]} \t\r\n/", begin), text.size());
  int depth = 0;
  bool quoted = false;
  for (size_t i = begin; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\')
      ++i;
    else if (c == '"')
      quoted = !quoted;
    else if (quoted)
      continue;
    else if (c == '/')
      i = std::min(text.find_first_of("\r\n", i), text.size());
    else if (c == '{' || c == '[')
      ++depth;
    else if (c == '}' || c == ']')
      --depth;
    if (!quoted && depth == 0 && i < text.size()) return i + 1;
  }
  return text.size();
}

// Returns the white space at the start of the line that contains byte `at`.
std::string indentation_at(const std::string& text, size_t at) {
  const size_t newline = text.rfind('\n', at);
  const size_t line = newline == std::string::npos ? 0 : newline + 1;
  return text.substr(line, std::min(text.find_first_not_of(" \t", line), at) - line);
}

std::string indented(const std::string& text, const std::string& indentation) {
  std::string out;
  for (const char c : text) {
    out += c;
    if (c == '\n') out += indentation;
  }
  return out;
}

} // namespace

std::optional<std::vector<ExpectedCase>> read_expectations(const Document& document,
                                                           Diagnostics& diagnostics) {
  if (!check_version(document, "dermis_expect", 1, diagnostics)) return std::nullopt;
  CaseReader reader{document, diagnostics};
  ObjectReader object(document, document.root(), "the expectation", diagnostics);
  object.any("dermis_expect");
  const NodeId list = object.array("cases", 1, max_cases);
  std::vector<ExpectedCase> cases;
  std::map<std::string, NodeId> names;
  if (list.valid())
    for (const NodeId node : children(document, list)) {
      cases.push_back(reader.one_case(node));
      const auto [known, fresh] = names.emplace(cases.back().name, node);
      if (fresh) continue;
      reader.ok = false;
      diagnostics
          .add(DiagnosticId::duplicate_name, document.where(node),
               fmt::format("two cases are called '{}'", cases.back().name))
          .related.emplace_back(document.where(known->second), "the first one");
    }
  if (!object.finish() || !reader.ok) return std::nullopt;
  return cases;
}

MachineInfo narrow(const MachineInfo& observed, const MachineInfo& stated) {
  MachineInfo out;
  if (stated.passes) out.passes = observed.passes;
  if (stated.culled) out.culled = observed.culled;
  if (stated.barriers) out.barriers = observed.barriers;
  if (stated.batches) out.batches = observed.batches;
  if (stated.transient_bytes) out.transient_bytes = observed.transient_bytes;
  if (stated.history_bytes) out.history_bytes = observed.history_bytes;
  out.diagnostics = observed.diagnostics;
  return out;
}

std::string info_json(const MachineInfo& info) {
  JsonWriter out;
  const auto list = [&](std::string_view key, const std::vector<std::string>& all) {
    out.key(key).open_array();
    for (const std::string& one : all)
      out.value(one);
    out.close();
  };
  const auto count = [&](std::string_view key, const std::optional<uint64_t>& value) {
    if (value) out.member(key, *value);
  };
  out.open_object();
  if (info.passes) list("passes", *info.passes);
  if (info.culled) {
    out.key("culled").open_object();
    for (const auto& [pass, why] : *info.culled)
      out.member(pass, why);
    out.close();
  }
  count("barriers", info.barriers);
  count("batches", info.batches);
  count("transient_bytes", info.transient_bytes);
  count("history_bytes", info.history_bytes);
  if (!info.diagnostics.empty()) list("diagnostics", info.diagnostics);
  out.close();
  return std::move(out).finish();
}

std::string rewrite_info(const Document& document, const std::string& text,
                         const std::vector<ExpectedCase>& cases,
                         const std::vector<std::optional<MachineInfo>>& info) {
  std::string out = text;
  for (size_t i = cases.size(); i-- > 0;) { // from the end, so that offsets stay valid
    if (!info[i]) continue;
    std::string fresh = info_json(*info[i]);
    fresh.pop_back(); // removes the final line break
    if (cases[i].info_node.valid()) {
      const size_t begin = document[cases[i].info_node].offset;
      const size_t end = end_of_value(out, begin);
      out.replace(begin, end - begin, indented(fresh, indentation_at(out, begin)));
    } else { // after the last value of the case, which has at least its name
      const size_t begin = document[children(document, cases[i].node).back()].offset;
      const std::string indentation = indentation_at(out, begin);
      out.insert(end_of_value(out, begin),
                 fmt::format(",\n{0}\"expect\": {1}", indentation, indented(fresh, indentation)));
    }
  }
  return out;
}

} // namespace dermis::tools
