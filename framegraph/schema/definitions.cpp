#include "framegraph/schema/definitions.hpp"

#include "framegraph/model/vocabulary.hpp"
#include "framegraph/text/limits.hpp"

#include <fmt/format.h>

#include <limits>

namespace dermis {
namespace {

// Returns the names of a format as JSON strings with commas. "depth" means any depth format; the
// first enumerator is no format.
std::string format_names() {
  std::string out = "\"depth\"";
  for (size_t i = 1; i < static_cast<size_t>(Format::count); ++i)
    out += fmt::format(", \"{}\"", format_info(static_cast<Format>(i)).name);
  return out;
}

std::string feature_names() {
  std::string out;
  for (uint32_t f = 0; f < static_cast<uint32_t>(Feature::count); ++f)
    out += fmt::format("{}\"{}\"", out.empty() ? "" : ", ", feature_name(static_cast<Feature>(f)));
  return out;
}

// Returns `text` with every <word> replaced: limits by their number, <pass types> and <formats> by
// their names.
std::string filled(std::string_view text, std::string_view pass_types = {}) {
  const std::pair<std::string_view, std::string> values[] = {
      {"<formats>", format_names()},
      {"<features>", feature_names()},
      {"<pass types>", std::string(pass_types)},
      {"<name bytes>", fmt::format("{}", limits::name_bytes)},
      {"<expression bytes>", fmt::format("{}", limits::expression_bytes)},
      {"<passes>", fmt::format("{}", limits::passes)},
      {"<resources>", fmt::format("{}", limits::resources)},
      {"<settings>", fmt::format("{}", limits::settings)},
      {"<options>", fmt::format("{}", limits::options)},
      {"<most formats>", fmt::format("{}", limits::formats)},
      {"<side>", fmt::format("{}", limits::image_side)},
      {"<border>", fmt::format("{}", limits::image_border)},
      {"<mips>", fmt::format("{}", limits::image_mips)},
      {"<layers>", fmt::format("{}", limits::image_layers)},
      {"<stride>", fmt::format("{}", limits::buffer_stride)},
      {"<elements>", fmt::format("{}", limits::buffer_elements)},
      {"<frames>", fmt::format("{}", limits::history_frames)},
      {"<least int>", fmt::format("{}", std::numeric_limits<int32_t>::min())},
      {"<greatest int>", fmt::format("{}", std::numeric_limits<int32_t>::max())},
      {"<greatest real>", fmt::format("{}", double(std::numeric_limits<float>::max()))},
  };
  std::string out(text);
  for (const auto& [word, value] : values) {
    for (size_t at = out.find(word); at != std::string::npos;
         at = out.find(word, at + value.size()))
      out.replace(at, word.size(), value);
  }
  return out;
}

constexpr std::string_view note =
    R"("note": { "type": "string", "description": "for readers; has no effect" })";

// A setting holds its default under the name of its type. If there are several, the first decides.
std::string setting_definition() {
  const std::string common = fmt::format(
      R"("unit": {{ "type": "string", "description": "for readers; has no effect" }}, {})", note);
  const auto form = [&](std::string_view required, std::string_view properties) {
    return fmt::format(R"({{ "required": [{}], "additionalProperties": false,
        "properties": {{ {}, {} }} }})",
                       required, properties, common);
  };
  const std::string options =
      R"("type": "array", "minItems": 1, "maxItems": <options>, "items": { "type": "string", "maxLength": <name bytes> })";
  const std::string boolean =
      form(R"("bool")", R"("bool": { "type": "boolean", "description": "the default" })");
  const std::string integer =
      form(R"("int", "min", "max")",
           R"("int": { "$ref": "#/definitions/int", "description": "the default" },
        "min": { "$ref": "#/definitions/int" }, "max": { "$ref": "#/definitions/int" })");
  const std::string real =
      form(R"("real", "min", "max")",
           R"("real": { "$ref": "#/definitions/real", "description": "the default" },
        "min": { "$ref": "#/definitions/real" }, "max": { "$ref": "#/definitions/real" })");
  const std::string enumeration = form(
      R"("enum", "default")", R"("enum": { )" + options + R"( }, "default": { "type": "string" })");
  const std::string choice =
      form(R"("choice", "default")",
           R"("choice": { )" + options + R"( }, "default": { "type": "string" },
        "by": { "enum": ["host", "budget"], "description": "selects the option; with budget, the library does" },
        "requires": { "type": "object", "description": "requirements of each option; an option whose requirements are not met is not available",
          "additionalProperties": { "type": "array", "items": { "type": "string", "description": "device feature, or optional import that the host binds" } } })");
  const auto branch = [](std::string_view key, const std::string& then,
                         const std::string& otherwise) {
    return fmt::format(R"({{
      "if": {{ "required": ["{}"] }},
      "then": {},
      "else": {} }})",
                       key, then, otherwise);
  };
  const std::string rest =
      branch("bool", boolean,
             branch("int", integer, branch("real", real, branch("enum", enumeration, choice))));
  return R"({ "type": "object", "description": "A value that the host can change at run time.", "allOf": [)" +
         rest + "] }";
}

std::string resource_definition() {
  const std::string history = R"("history": { "$ref": "#/definitions/history" })";
  const std::string optional =
      R"("optional": { "type": "boolean", "description": "the host may leave the resource unbound" })";
  return fmt::format(R"({{ "type": "object",
      "if": {{ "required": ["buffer"] }},
      "then": {{ "additionalProperties": false, "properties": {{
        "buffer": {{ "$ref": "#/definitions/buffer" }}, {0}, {1}, {2} }} }},
      "else": {{ "required": ["format", "size"], "additionalProperties": false, "properties": {{
        "format": {{ "$ref": "#/definitions/formats" }}, "size": {{ "$ref": "#/definitions/size" }}, "border": {{ "$ref": "#/definitions/border" }},
        "round": {{ "$ref": "#/definitions/round" }}, "align": {{ "$ref": "#/definitions/align" }},
        "mips": {{ "anyOf": [{{ "type": "integer", "minimum": 1, "maximum": <mips> }}, {{ "enum": ["full"] }}] }},
        "layers": {{ "type": "integer", "minimum": 1, "maximum": <layers> }}, {0}, {1}, {2} }} }} }})",
                     history, optional, note);
}

constexpr std::string_view size_text =
    R"({ "description": "\"view\", \"view/2\", \"view*3/4\", \"square_view/2\" (pixels that are not square), another image's name with such a factor, or [width, height] in texels",
      "anyOf": [{ "type": "string" },
        { "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "integer", "minimum": 1, "maximum": <side> } }] })";

constexpr std::string_view count_text =
    R"({ "description": "number of elements: width times height of a size, or an integer",
      "anyOf": [{ "$ref": "#/definitions/size" }, { "type": "integer", "minimum": 1, "maximum": <elements> }] })";

constexpr std::string_view buffer_text =
    R"({ "type": "object", "required": ["stride", "count"], "additionalProperties": false, "properties": {
        "stride": { "type": "integer", "minimum": 4, "maximum": <stride>, "multipleOf": 4, "description": "size of an element [bytes]" },
        "count": { "$ref": "#/definitions/count" },
        "extra": { "type": "integer", "minimum": 0, "maximum": <elements>, "description": "elements in addition to count" },
        "round": { "$ref": "#/definitions/round" }, "align": { "$ref": "#/definitions/align" }, <note> } })";

constexpr std::string_view history_text =
    R"({ "type": "object", "required": ["frames"], "additionalProperties": false,
      "description": "keeps the contents of earlier frames, which passes read as name@-1, name@-2 ...", "properties": {
        "frames": { "type": "integer", "minimum": 1, "maximum": <frames>, "description": "number of earlier frames that are kept [frames]" },
        "first": { "enum": ["discard", "clear"], "description": "contents before the first frame" },
        "on_cut": { "enum": ["invalidate", "keep"], "description": "after a camera cut" },
        "on_resize": { "enum": ["invalidate", "rescale"], "description": "after a change of the view's size" }, <note> } })";

constexpr std::string_view host_buffer_text =
    R"({ "type": "object", "required": ["stride"], "additionalProperties": false, "properties": {
        "stride": { "type": "integer", "minimum": 4, "maximum": <stride>, "multipleOf": 4, "description": "size of an element [bytes]" },
        "count": { "$ref": "#/definitions/count" },
        "extra": { "type": "integer", "minimum": 0, "maximum": <elements>, "description": "elements in addition to count" },
        "round": { "$ref": "#/definitions/round" }, "align": { "$ref": "#/definitions/align" }, <note> } })";

constexpr std::string_view import_text =
    R"({ "type": "object",
      "if": { "required": ["buffer"] },
      "then": { "additionalProperties": false, "properties": {
        "buffer": { "$ref": "#/definitions/host_buffer" },
        "optional": { "type": "boolean", "description": "the host may leave the resource unbound" }, <note> } },
      "else": { "if": { "required": ["acceleration_structure"] },
      "then": { "additionalProperties": false, "properties": {
        "acceleration_structure": { "enum": ["top_level"], "description": "traced by ray queries" },
        "optional": { "type": "boolean", "description": "the host may leave the resource unbound" }, <note> } },
      "else": { "required": ["format", "size"], "additionalProperties": false, "properties": {
        "format": { "$ref": "#/definitions/formats" }, "size": { "$ref": "#/definitions/size" }, "border": { "$ref": "#/definitions/border" },
        "round": { "$ref": "#/definitions/round" }, "align": { "$ref": "#/definitions/align" },
        "optional": { "type": "boolean", "description": "the host may leave the resource unbound" }, <note> } } } })";

constexpr std::string_view pass_text =
    R"({ "type": "object", "required": ["pass", "type"], "additionalProperties": false, "properties": {
        "pass": { "$ref": "#/definitions/name" },
        "type": { "enum": [<pass types>] },
        "when": { "type": "string", "maxLength": <expression bytes>, "description": "the pass is off where this is false: quality in ['good', 'best'] and samples > 4" },
        "queue": { "enum": ["main", "async"], "description": "async: may run concurrently with passes of the main queue if the device has two queues" },
        "read": { "type": "object", "description": "port: resource, or resource#1[0] of a mip and a layer, or resource@-N of N frames earlier, or an object that requires this frame to be valid" },
        "write": { "type": "object", "description": "port: resource, or resource#1[0] of a mip and a layer" },
        "set": { "type": "object", "description": "setting of the pass type: value, or \"$name\" of a setting of the graph" },
        "otherwise": { "type": "object", "additionalProperties": { "type": "string" }, "description": "replacement that readers of an output get while the pass is off" },
        "after": { "type": "array", "maxItems": <passes>, "items": { "type": "object", "required": ["pass", "reason"], "additionalProperties": false, "properties": {
          "pass": { "type": "string" }, "reason": { "type": "string", "minLength": 1 }, <note> } } }, <note> },
      "allOf": [{ "$ref": "#/definitions/pass_of_a_kind" }] })";

constexpr std::string_view source_text =
    R"({ "anyOf": [{ "type": "string" }, { "type": "object", "required": ["from", "requires"], "additionalProperties": false, "properties": {
        "from": { "type": "string", "description": "resource@-N" },
        "requires": { "enum": ["valid"], "description": "read only in frames in which N frames have been written since the history began or was cut" },
        "otherwise": { "type": "string", "description": "resource that is read in all other frames; without \"otherwise\" the port is unbound in these frames, or reads zeros if the history has \"first\": \"clear\"" }, <note> } }] })";

constexpr std::string_view include_text =
    R"({ "type": "object", "required": ["include"], "additionalProperties": false, "properties": {
        "include": { "type": "string", "description": "path of a fragment, relative and without ..; its passes are inserted here, its other members are added to the graph" }, <note> } })";

constexpr std::string_view passes_text =
    R"({ "type": "array", "maxItems": <passes>, "items": {
        "if": { "required": ["include"], "not": { "required": ["pass"] } },
        "then": { "$ref": "#/definitions/include" }, "else": { "$ref": "#/definitions/pass" } } })";

std::string with_note(std::string_view text, std::string_view pass_types = {}) {
  std::string out(text);
  constexpr std::string_view word = "<note>";
  for (size_t at = out.find(word); at != std::string::npos; at = out.find(word, at))
    out.replace(at, word.size(), note);
  return filled(out, pass_types);
}

} // namespace

SchemaMembers graph_root_members() {
  return {
      {"type", R"("object")"},
      {"required", R"(["dermis", "name", "passes", "exports"])"},
      {"additionalProperties", "false"},
      {"properties", with_note(R"({
    "$schema": { "type": "string" },
    "dermis": { "type": "integer", "const": 2, "description": "version of the format" },
    "name": { "$ref": "#/definitions/name" },
    "requires": { "type": "array", "maxItems": <options>, "items": { "enum": [<features>] }, "description": "device features that the graph needs to run" },
    "settings": { "type": "object", "maxProperties": <settings>, "additionalProperties": { "$ref": "#/definitions/setting" } },
    "imports": { "type": "object", "maxProperties": <resources>, "additionalProperties": { "$ref": "#/definitions/import" },
      "description": "images, buffers and acceleration structures that the host owns and binds" },
    "resources": { "type": "object", "maxProperties": <resources>, "additionalProperties": { "$ref": "#/definitions/resource" },
      "description": "images and buffers that the graph owns" },
    "passes": { "$ref": "#/definitions/passes" },
    "exports": { "type": "array", "maxItems": <resources>, "items": { "type": "string" }, "description": "images that the graph returns to the host" },
    <note>
  })")},
  };
}

SchemaMembers fragment_root_members() {
  return {
      {"type", R"("object")"},
      {"required", R"(["dermis_fragment"])"},
      {"additionalProperties", "false"},
      {"properties", with_note(R"({
    "$schema": { "type": "string" },
    "dermis_fragment": { "type": "integer", "const": 2, "description": "version of the format" },
    "settings": { "type": "object", "maxProperties": <settings>, "additionalProperties": { "$ref": "#/definitions/setting" } },
    "imports": { "type": "object", "maxProperties": <resources>, "additionalProperties": { "$ref": "#/definitions/import" } },
    "resources": { "type": "object", "maxProperties": <resources>, "additionalProperties": { "$ref": "#/definitions/resource" } },
    "passes": { "$ref": "#/definitions/passes" },
    "exports": { "type": "array", "maxItems": <resources>, "items": { "type": "string" } },
    <note>
  })")},
  };
}

SchemaMembers graph_definitions(std::string_view pass_type_names) {
  return {
      {"name",
       with_note(
           R"({ "type": "string", "maxLength": <name bytes>, "description": "a letter or _, then letters, digits or _" })")},
      {"int",
       with_note(R"({ "type": "integer", "minimum": <least int>, "maximum": <greatest int> })")},
      {"real",
       with_note(
           R"({ "type": "number", "minimum": -<greatest real>, "maximum": <greatest real> })")},
      {"format", with_note(R"({ "enum": [<formats>] })")},
      {"formats",
       with_note(
           R"({ "description": "one format, or several in order of preference", "anyOf": [{ "$ref": "#/definitions/format" },
      { "type": "array", "minItems": 1, "maxItems": <most formats>, "items": { "$ref": "#/definitions/format" } }] })")},
      {"round", R"({ "enum": ["ceil", "floor"], "description": "rounding of fractional sizes" })"},
      {"border",
       with_note(
           R"({ "type": "integer", "minimum": 0, "maximum": <border>, "description": "texels added on every side, after rounding and aligning [texels]" })")},
      {"align",
       with_note(
           R"({ "type": "integer", "minimum": 1, "maximum": <side>, "description": "sizes are rounded up to a multiple of this number" })")},
      {"size", with_note(size_text)},
      {"count", with_note(count_text)},
      {"buffer", with_note(buffer_text)},
      {"host_buffer", with_note(host_buffer_text)},
      {"history", with_note(history_text)},
      {"setting", with_note(setting_definition())},
      {"import", with_note(import_text)},
      {"resource", with_note(resource_definition())},
      {"source", with_note(source_text)},
      {"target", R"({ "type": "string" })"},
      {"pass", with_note(pass_text, pass_type_names)},
      {"include", with_note(include_text)},
      {"passes", with_note(passes_text)},
  };
}

} // namespace dermis
