// Reads "imports", "resources" and "exports".

#include "framegraph/model/read/graph_reader.hpp"
#include "framegraph/model/size_expression.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/suggest.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace dermis {

namespace {

// Formats of the class "depth", exact formats first.
constexpr Format depth_class[] = {Format::d32f,  Format::d24,    Format::d16,
                                  Format::d24s8, Format::d32fs8, Format::r32f};

std::vector<std::string_view> format_words() {
  std::vector<std::string_view> out = {"depth"};
  for (size_t i = 1; i < static_cast<size_t>(Format::count); ++i)
    out.push_back(format_info(static_cast<Format>(i)).name);
  return out;
}

bool read_format(GraphReader& reader, NodeId node, const std::string& what, FormatList& out) {
  const std::vector<std::string_view> words = format_words();
  const auto word = read_word(reader.document, node, what, words, reader.diagnostics);
  if (!word) return false;
  const auto add = [&](Format format) {
    if (std::find(out.begin(), out.end(), format) == out.end()) out.push_back(format);
  };
  if (*word == 0) {
    for (Format format : depth_class)
      add(format);
  } else {
    add(static_cast<Format>(*word)); // words follow the enumeration, whose value 0 is not a format
  }
  return true;
}

bool read_formats(GraphReader& reader, ObjectReader& object, FormatList& out) {
  const NodeId node = object.any("format");
  if (!node.valid()) return false;
  const std::string what = fmt::format("'format' of {}", object.what());
  if (reader.document[node].kind == NodeKind::string) return read_format(reader, node, what, out);
  if (!object.array("format", 1, limits::formats).valid()) return false;
  bool ok = true;
  for (NodeId child : children(reader.document, node))
    ok &= read_format(reader, child, what, out);
  return ok;
}

// Reads "round" and "align", which may accompany "size" or "count".
void read_rounding(ObjectReader& object, SizeExpression& size) {
  constexpr std::string_view words[] = {"ceil", "floor"};
  size.rounding = object.word("round", words, Need::optional).value_or(0) == 0 ? Rounding::ceil
                                                                               : Rounding::floor;
  size.align = static_cast<uint32_t>(
      object.integer("align", 1, limits::image_side, Need::optional).value_or(1));
}

// Returns false after an error. A buffer as base is an error.
bool read_size(GraphReader& reader, ObjectReader& object, std::string_view key, ResourceId owner,
               SizeExpression& out) {
  SizeExpression rounding;
  read_rounding(object, rounding);
  const NodeId node = object.any(key);
  if (!node.valid()) return false;
  const std::string what = fmt::format("'{}' of {}", key, object.what());
  const bool count = key == "count";
  if (!count)
    rounding.border = static_cast<uint32_t>(
        object.integer("border", 0, limits::image_border, Need::optional).value_or(0));
  const auto find = [&](std::string_view name) {
    return find_resource(reader, name, what, reader.document.where(node),
                         "which is neither \"view\", \"square_view\" nor declared");
  };
  const auto size = parse_size(reader.document, node, what, owner, count, find, reader.diagnostics);
  if (!size) return false;
  out = *size;
  out.rounding = rounding.rounding;
  out.align = rounding.align;
  out.border = rounding.border;
  if (reader.document[node].kind == NodeKind::integer) { // elements of a buffer, without a height
    out.x.numerator = (out.x.numerator + out.align - 1) / out.align * out.align;
    out.align = 1;
  }
  if (out.base != SizeExpression::Base::resource) return true;
  const ResourceDeclaration& base = reader.graph.resources[out.resource.value];
  if (base.type == ResourceType::image) return true;
  reader
      .error(DiagnosticId::bad_size, reader.document.where(node),
             fmt::format("{}: '{}' is {}", what, base.name, type_phrase(base.type)))
      .related.emplace_back(base.where, fmt::format("'{}' is declared here", base.name));
  return false;
}

bool read_history(GraphReader& reader, ObjectReader& object, ResourceType type,
                  HistoryDeclaration& out) {
  const NodeId node = object.object("history", Need::optional);
  if (!node.valid()) return object.ok();
  ObjectReader history(reader.document, node, fmt::format("the history of {}", object.what()),
                       reader.diagnostics);
  constexpr std::string_view first[] = {"discard", "clear"};
  constexpr std::string_view on_cut[] = {"invalidate", "keep"};
  constexpr std::string_view on_resize[] = {"invalidate", "rescale"};
  out.frames =
      static_cast<uint32_t>(history.integer("frames", 1, limits::history_frames).value_or(1));
  out.first = static_cast<HistoryDeclaration::First>(
      history.word("first", first, Need::optional).value_or(0));
  out.on_cut = static_cast<HistoryDeclaration::OnCut>(
      history.word("on_cut", on_cut, Need::optional).value_or(0));
  out.on_resize = static_cast<HistoryDeclaration::OnResize>(
      history.word("on_resize", on_resize, Need::optional).value_or(0));
  if (!history.finish()) return false;
  if (out.on_resize != HistoryDeclaration::OnResize::rescale || type == ResourceType::image)
    return true;
  reader.error(DiagnosticId::bad_history,
               reader.document.where(reader.document.find(node, "on_resize")),
               fmt::format("{} declares \"rescale\", which only images support", history.what()));
  return false;
}

bool read_buffer(GraphReader& reader, NodeId node, ResourceId id, ResourceDeclaration& out) {
  ObjectReader buffer(reader.document, node, fmt::format("buffer '{}'", out.name),
                      reader.diagnostics);
  if (!buffer.ok()) return false;
  // Storage buffers are arrays of 32-bit words (vkCmdFillBuffer clears in units of 4 bytes).
  constexpr uint32_t word = 4;
  const auto stride = buffer.integer("stride", word, limits::buffer_stride);
  bool ok = stride.has_value();
  if (stride && *stride % word != 0) {
    ok = false;
    reader.error(DiagnosticId::out_of_range,
                 reader.document.where(reader.document.find(node, "stride")),
                 fmt::format("'stride' of {} is {}; it must be a multiple of {}", buffer.what(),
                             *stride, word));
  }
  out.stride = static_cast<uint32_t>(stride.value_or(word));
  // hosts may bind any number
  const bool minimum = out.origin != Origin::imported || buffer.has("count");
  out.extra_elements = static_cast<uint64_t>(
      buffer.integer("extra", 0, limits::buffer_elements, Need::optional).value_or(0));
  if (minimum)
    ok &= read_size(reader, buffer, "count", id, out.size);
  else
    out.size.base = SizeExpression::Base::fixed; // one element
  return buffer.finish() && ok;
}

bool read_image(GraphReader& reader, ObjectReader& object, ResourceId id,
                ResourceDeclaration& out) {
  bool ok = read_formats(reader, object, out.formats);
  ok &= read_size(reader, object, "size", id, out.size);
  if (out.origin == Origin::imported) return ok;
  const NodeId mips = object.any("mips", Need::optional);
  if (mips.valid() && reader.document[mips].kind == NodeKind::string) {
    constexpr std::string_view full[] = {"full"};
    if (object.word("mips", full)) out.mips = 0;
  } else {
    out.mips = static_cast<uint32_t>(
        object.integer("mips", 1, limits::image_mips, Need::optional).value_or(1));
  }
  out.layers = static_cast<uint32_t>(
      object.integer("layers", 1, limits::image_layers, Need::optional).value_or(1));
  return ok;
}

bool read_acceleration_structure(GraphReader& reader, ObjectReader& object,
                                 const ResourceDeclaration& out) {
  constexpr std::string_view levels[] = {"top_level"};
  const bool ok = object.word("acceleration_structure", levels).has_value();
  if (out.origin == Origin::imported) return ok;
  reader.error(
      DiagnosticId::not_imported, out.where,
      fmt::format("'{}' is an acceleration structure, which a graph cannot own", out.name));
  return false;
}

bool read_resource(GraphReader& reader, ResourceId id) {
  ResourceDeclaration& out = reader.graph.resources[id.value];
  const NodeId node = reader.resource_nodes[id.value];
  const bool import = out.origin == Origin::imported;
  ObjectReader object(reader.document, node,
                      fmt::format("{} '{}'", import ? "import" : "resource", out.name),
                      reader.diagnostics);
  if (!object.ok()) return false;
  bool ok = true;
  out.note = note_of(reader.document, node);
  out.optional = object.boolean("optional", Need::optional).value_or(false);
  if (out.type == ResourceType::buffer) {
    const NodeId buffer = object.any("buffer");
    ok &= read_buffer(reader, buffer, id, out);
  } else if (out.type == ResourceType::acceleration_structure) {
    ok &= read_acceleration_structure(reader, object, out);
  } else {
    ok &= read_image(reader, object, id, out);
  }
  if (!import) ok &= read_history(reader, object, out.type, out.history);
  return object.finish() && ok;
}

} // namespace

ResourceId find_resource(GraphReader& reader, std::string_view name, std::string_view what,
                         const SourceLocation& where, std::string_view problem) {
  const auto found = reader.resource_names.find(name);
  if (found != reader.resource_names.end()) return found->second;
  if (reader.unknown_resources) return {};
  Diagnostic& one = reader.error(DiagnosticId::unknown_resource, where,
                                 fmt::format("{} names '{}', {}", what, name, problem));
  if (!reader.diagnostics.full())
    one.suggestion = did_you_mean(name, names_of(reader.resource_names));
  return {};
}

void declare_resources(GraphReader& reader, NodeId list, Origin origin) {
  if (!list.valid()) return;
  const std::vector<NodeId> nodes = children(reader.document, list);
  if (reader.graph.resources.size() + nodes.size() > limits::resources) {
    reader.error(
        DiagnosticId::limit_exceeded, reader.document.where(list),
        fmt::format("the graph has more than {} imports and resources", limits::resources));
    reader.unknown_resources = true;
    return;
  }
  for (NodeId node : nodes) {
    ResourceDeclaration declared;
    declared.name = reader.document.key(node);
    declared.origin = origin;
    declared.where = reader.document.where_key(node);
    if (reader.document.find(node, "buffer").valid())
      declared.type = ResourceType::buffer;
    else if (reader.document.find(node, "acceleration_structure").valid())
      declared.type = ResourceType::acceleration_structure;
    bool ok =
        check_name(declared.name, "the name of a resource", declared.where, reader.diagnostics);
    if (declared.name == "view" || declared.name == "square_view") {
      ok = false;
      reader.error(DiagnosticId::bad_name, declared.where,
                   fmt::format("'{}' is reserved for the size of the view; a resource cannot have "
                               "this name",
                               declared.name));
    }
    const auto [entry, added] = reader.resource_names.emplace(
        declared.name, ResourceId{static_cast<uint32_t>(reader.graph.resources.size())});
    if (!added) {
      reader.broken_resources[entry->second.value] = true; // the reference is ambiguous
      const SourceLocation first = reader.graph.resources[entry->second.value].where;
      reader
          .error(DiagnosticId::duplicate_name, declared.where,
                 fmt::format("'{}' is declared as an import and as a resource", declared.name))
          .related.emplace_back(first, "first declared here");
    }
    reader.graph.resources.push_back(std::move(declared));
    reader.broken_resources.push_back(!ok);
    reader.resource_nodes.push_back(node);
  }
}

void read_resources(GraphReader& reader) {
  for (uint32_t i = 0; i < reader.graph.resources.size(); ++i) {
    if (!read_resource(reader, {i})) reader.broken_resources[i] = true;
  }
}

void read_exports(GraphReader& reader, NodeId exports) {
  std::map<ResourceId, NodeId> seen;
  bool all_known = exports.valid();
  for (NodeId node : exports.valid() ? children(reader.document, exports) : std::vector<NodeId>()) {
    const SourceLocation where = reader.document.where(node);
    const auto name =
        read_string(reader.document, node, "an entry of 'exports'", reader.diagnostics);
    const ResourceId id = name ? find_resource(reader, *name, "'exports'", where) : ResourceId();
    all_known &= id.valid();
    if (!id.valid()) continue;
    ResourceDeclaration& resource = reader.graph.resources[id.value];
    if (const auto [first, added] = seen.emplace(id, node); !added) {
      reader
          .error(DiagnosticId::duplicate_name, where, fmt::format("'{}' is exported twice", *name))
          .related.emplace_back(reader.document.where(first->second), "first exported here");
    } else if (resource.type != ResourceType::image) {
      reader
          .error(DiagnosticId::bad_export, where,
                 fmt::format("'{}' is {}; only images can be exported", *name,
                             type_phrase(resource.type)))
          .related.emplace_back(resource.where, fmt::format("'{}' is declared here", *name));
    } else if (resource.mips != 1 || resource.layers != 1) {
      const char* const key = resource.mips != 1 ? "mips" : "layers";
      const NodeId at = reader.document.find(reader.resource_nodes[id.value], key);
      reader
          .error(DiagnosticId::bad_export, at.valid() ? reader.document.where(at) : resource.where,
                 fmt::format("'{}' is exported and has several {}; images that the host binds have "
                             "one mip and one layer",
                             *name, key))
          .related.emplace_back(where, "exported here");
    }
    resource.exported = true;
  }
  if (!all_known) return; // unknown exports may be among the resources below
  for (uint32_t i = 0; i < reader.graph.resources.size(); ++i) {
    const ResourceDeclaration& resource = reader.graph.resources[i];
    if (!resource.optional || resource.exported || resource.origin == Origin::imported) continue;
    reader.error(
        DiagnosticId::bad_export,
        reader.document.where(reader.document.find(reader.resource_nodes[i], "optional")),
        fmt::format("resource '{}' is optional, but not exported, so the host never binds it",
                    resource.name));
  }
}

} // namespace dermis
