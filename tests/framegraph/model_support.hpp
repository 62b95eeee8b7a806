#pragma once
// A small registry of pass types, and a graph for tests to break.

#include "framegraph/model/read_graph.hpp"
#include "tests/framegraph/text_support.hpp"
#include "tests/support/text_file.hpp"

namespace dermis::testing {

inline constexpr std::string_view modes[] = {"fast", "good", "best"};
inline constexpr Format half4[] = {Format::rgba16f, Format::rgba32f};

inline constexpr Port blur_ports[] = {
    {"source", Usage::sampled_image, false, "texture2D", "what to blur"},
    {"mask", Usage::sampled_image, true, "utexture2D", "where"},
    {"tiles", Usage::storage_buffer_read, true, "uint", "list"},
    {"history", Usage::sampled_image, true, "texture2D", "the last frame's"},
    {"target", Usage::storage_image_write, false, "image2D", "the result", half4},
    {"history", Usage::storage_image_write, true, "image2D", "this frame's"},
};
inline constexpr PassTypeSetting blur_settings[] = {
    {"samples", SettingType::integer, {SettingType::integer, 16, 0.0}, 1, 64, {}, "", "how many"},
    {"radius", SettingType::real, {SettingType::real, 0, 1.0}, 0, 8, {}, "px", "how far"},
    {"mode", SettingType::enumeration, {SettingType::enumeration, 0, 0.0}, 0, 0, modes, "", "how"},
    {"mirror", SettingType::boolean, {SettingType::boolean, 0, 0.0}, 0, 1, {}, "", "whether"},
};
inline constexpr Port list_ports[] = {
    {"mask", Usage::sampled_image, false, "utexture2D", "where"},
    {"tiles", Usage::storage_buffer_write, false, "uint", "list"},
};
inline constexpr Port mix_ports[] = {
    {"source", Usage::sampled_image, false, "texture2D", "what to add", {}, true},
    {"target", Usage::storage_image_update, false, "image2D", "what to add it to"},
};

inline constexpr Port add_ports[] = {
    {"source", Usage::sampled_image, false, "texture2D", "what to add"},
    {"light", Usage::sampled_image, false, "texture2D", "what to add it to"},
    {"target", Usage::storage_image_write, false, "image2D", "the sum"},
};

inline const PassTypeRegistry& pass_types() {
  static const PassTypeRegistry registry = [] {
    PassTypeRegistry out;
    out.add({"test.blur", "", "blurs", blur_ports, blur_settings});
    static constexpr PortNeed list_needs[] = {
        {"tiles", 8, 4, 4}, {"mask", 1}, {"no_port", 1, 1000}};
    PassType list{"test.list", "", "lists tiles", list_ports, {}};
    list.needs = list_needs;
    out.add(list);
    out.add({"test.mix", "", "adds in place", mix_ports, {}});
    out.add({"test.add", "", "adds", add_ports, {}});
    return out;
  }();
  return registry;
}

struct Read {
  Diagnostics diagnostics;
  std::optional<Graph> graph;
};

inline Read read(std::string text) {
  Read out;
  const auto document = parse_document("graph.json", std::move(text), out.diagnostics);
  if (document) out.graph = read_graph(*document, pass_types(), out.diagnostics);
  return out;
}

// Contains every feature once, with one declaration per line.
inline std::string whole_graph() {
  return R"({ "$schema": "x", "dermis": 2, "name": "whole", "note": "all of it",
  "settings": {
    "quality": { "choice": ["fast", "good", "best"], "by": "budget", "default": "good" },
    "samples": { "int": 16, "min": 4, "max": 64, "unit": "samples" },
    "radius": { "real": 1.5, "min": 0, "max": 8, "note": "of the blur" },
    "mirror": { "bool": true },
    "style": { "enum": ["plain", "fancy"], "default": "fancy" } },
  "imports": {
    "light": { "format": ["rgba16f", "rgba32f"], "size": "view" },
    "depth": { "format": "depth", "size": "view", "optional": true },
    "material": { "format": "r8_uint", "size": "view" } },
  "resources": {
    "half": { "format": "rgba16f", "size": "view*3/4", "round": "floor", "align": 8, "border": 1, "mips": "full", "layers": 2 },
    "kept": { "format": "rgba16f", "size": "half/2",
              "history": { "frames": 2, "first": "clear", "on_cut": "keep", "on_resize": "rescale" } },
    "fixed": { "format": "rgba16f", "size": [64, 32], "optional": true },
    "list": { "buffer": { "stride": 4, "count": "view/8", "extra": 4 } } },
  "passes": [
    { "pass": "find", "type": "test.list", "read": { "mask": "material" }, "write": { "tiles": "list" } },
    { "pass": "blur", "type": "test.blur", "when": "quality in ['good', 'best'] and not mirror == false",
      "read": { "source": "light", "mask": "material", "tiles": "list", "history": "kept@-2" },
      "write": { "target": "half", "history": "kept" },
      "set": { "samples": "$samples", "radius": 2, "mode": "$quality", "mirror": true },
      "otherwise": { "half": "light" } },
    { "pass": "copy", "type": "test.blur", "read": { "source": "half" }, "write": { "target": "fixed" },
      "set": { "mode": "best", "radius": "$radius" },
      "after": [{ "pass": "find", "reason": "keeps captures in order" }] },
    { "pass": "mix", "type": "test.mix", "read": { "source": "half" }, "write": { "target": "light" } } ],
  "exports": ["light", "fixed"] })";
}

// Returns `whole_graph` with the only occurrence of `from` replaced.
inline std::string damaged(std::string_view from, std::string_view to) {
  const std::string text = whole_graph();
  EXPECT_EQ(text.find(from), text.rfind(from)) << from << " is ambiguous";
  return test::replaced(text, from, to);
}

} // namespace dermis::testing
