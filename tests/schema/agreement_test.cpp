// Schema and parser agree on the structure of a file: types, keys, ranges, words. Only the parser
// checks what needs several places of the file (names that refer to each other, expressions, sizes
// in strings).

#include "framegraph/compose/compose.hpp"
#include "framegraph/model/host_pass_type.hpp"
#include "framegraph/model/read_graph.hpp"
#include "framegraph/schema/graph_schema.hpp"
#include "integration/examples/demo_engine/scene/read_scene.hpp"
#include "integration/tools/command/expect/expectation.hpp"
#include "integration/tools/files/capture.hpp"
#include "passes/choice/calibration.hpp"
#include "passes/choice/error_model.hpp"
#include "passes/common/pass_types.hpp"
#include "passes/common/profiles/profile.hpp"
#include "tests/framegraph/test_scale.hpp"
#include "tests/schema/validator.hpp"
#include "tests/support/text_file.hpp"

#include <algorithm>
#include <filesystem>
#include <gtest/gtest.h>
#include <random>

namespace dermis::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr DiagnosticId structural[] = {
    DiagnosticId::unknown_key,         DiagnosticId::wrong_type,
    DiagnosticId::missing_key,         DiagnosticId::out_of_range,
    DiagnosticId::limit_exceeded,      DiagnosticId::integer_precision,
    DiagnosticId::unsupported_version, DiagnosticId::invalid_value,
    DiagnosticId::unknown_pass_type,   DiagnosticId::unknown_port,
    DiagnosticId::missing_port,        DiagnosticId::unknown_pass_setting,
    DiagnosticId::port_direction,      DiagnosticId::profile_keys,
    DiagnosticId::other_kind_of_file,
};

using Reader = void (*)(const std::string& text, Diagnostics& diagnostics);

// Every included file exists and is empty.
FileText open_nothing(std::string_view name) {
  return {std::string(name), R"({ "dermis_fragment": 2 })", ""};
}
void read_composition(const std::optional<Composition>& composition, Diagnostics& diagnostics) {
  static const PassTypeRegistry pass_types = subsurface::make_pass_types();
  if (composition) read_graph(composition->document, pass_types, diagnostics);
}
void read_graph_text(const std::string& text, Diagnostics& diagnostics) {
  if (auto document = parse_document("graph.json", text, diagnostics))
    read_composition(compose(std::move(*document), {}, open_nothing, diagnostics), diagnostics);
}
void read_fragment_text(const std::string& text, Diagnostics& diagnostics) {
  if (auto document = parse_document("fragment.json", text, diagnostics))
    read_composition(compose_fragment(std::move(*document), open_nothing, diagnostics),
                     diagnostics);
}
void read_overlay_text(const std::string& text, Diagnostics& diagnostics) {
  if (const auto document = parse_document("overlay.json", text, diagnostics))
    check_overlay(*document, diagnostics);
}
void read_expectation_text(const std::string& text, Diagnostics& diagnostics) {
  if (const auto document = parse_document("graph.expect.json", text, diagnostics))
    tools::read_expectations(*document, diagnostics);
}
void read_profile_text(const std::string& text, Diagnostics& diagnostics) {
  if (const auto document = parse_document("profile.json", text, diagnostics))
    subsurface::read_profile(*document, diagnostics);
}
void read_errors_text(const std::string& text, Diagnostics& diagnostics) {
  if (const auto document = parse_document("errors.json", text, diagnostics))
    choice::read_error_model(*document, diagnostics);
}
void read_calibration_text(const std::string& text, Diagnostics& diagnostics) {
  if (const auto document = parse_document("calibration.json", text, diagnostics))
    choice::read_calibration(*document, diagnostics);
}
void read_pass_types_text(const std::string& text, Diagnostics& diagnostics) {
  if (const auto document = parse_document("pass_types.json", text, diagnostics))
    read_host_pass_types(*document, diagnostics);
}
void read_scene_text(const std::string& text, Diagnostics& diagnostics) {
  demo::parse_scene("scenes/scene.json", text, diagnostics);
}
void read_capture_text(const std::string& text, Diagnostics& diagnostics) {
  if (const auto document = parse_document("frame.json", text, diagnostics))
    tools::read_description(*document, ".", std::string(DERMIS_SOURCE_DIR) + "/configs/profiles",
                            diagnostics);
}

std::string structural_errors(Reader reader, const std::string& text) {
  Diagnostics diagnostics;
  reader(text, diagnostics);
  std::string out;
  for (const Diagnostic& one : diagnostics.list)
    if (std::find(std::begin(structural), std::end(structural), one.id) != std::end(structural))
      out += format_for_people(diagnostics, one, false) + "\n";
  return out;
}

json parse(const std::string& text) {
  return json::parse(text, nullptr, true, true);
}

std::vector<fs::path> files_in(const char* folder, bool expectations = false) {
  std::vector<fs::path> out;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(DERMIS_SOURCE_DIR) / folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".json" &&
        (name.find(".expect.") != std::string::npos) == expectations)
      out.push_back(entry.path());
  }
  std::sort(out.begin(), out.end(),
            [](const fs::path& a, const fs::path& b) { return a.filename() < b.filename(); });
  return out;
}

void collect(json& value, std::vector<json*>& out) {
  out.push_back(&value);
  if (!value.is_structured()) return;
  for (json& child : value)
    collect(child, out);
}

// Makes one random change; deterministic for every seed and library (no distributions of <random>).
json mutate(json document, uint32_t seed) {
  std::mt19937 random(seed);
  const auto below = [&](size_t count) { return static_cast<size_t>(random() % count); };
  static const json values =
      json::parse(R"([null, true, 0, 1, 3, -1, 7.5, 65, 20000, 1e20, -1e300, "", "view",
      "none", [], {}, [1, 2], [0.5, 0.5, 0.5], { "note": 1 }, { "keys": [[0, 1]] }, 5000000000])");
  std::vector<json*> all;
  collect(document, all);
  json& at = *all[below(all.size())];
  const auto some_key = [&](const json& object) {
    auto it = object.begin();
    std::advance(it, static_cast<std::ptrdiff_t>(below(object.size())));
    return it.key();
  };
  switch (below(6)) {
  case 0:
    if (at.is_object() && !at.empty()) {
      at.erase(some_key(at));
      break;
    }
    [[fallthrough]];
  case 1:
    if (at.is_object() && !at.empty()) {
      const std::string key = some_key(at);
      json value = at[key];
      at.erase(key);
      at[key + "x"] = std::move(value);
      break;
    }
    [[fallthrough]];
  case 2:
    if (at.is_object()) {
      const char* keys[] = {"note", "buffer", "bool", "sine", "file", "when", "colour"};
      at[keys[below(std::size(keys))]] = values[below(values.size())];
      break;
    }
    [[fallthrough]];
  case 3:
    if (at.is_array() && !at.empty()) {
      at.push_back(at[below(at.size())]);
      break;
    }
    [[fallthrough]];
  case 4:
    if (at.is_array() && !at.empty()) {
      at.erase(below(at.size()));
      break;
    }
    [[fallthrough]];
  default:
    at = values[below(values.size())];
  }
  return document;
}

void expect_agreement(const SchemaFile& schema, Reader reader, const std::vector<json>& files,
                      uint32_t mutations) {
  for (const json& file : files) {
    EXPECT_EQ(schema.first_problem(file), "");
    EXPECT_EQ(structural_errors(reader, file.dump()), "");
  }
  uint32_t rejected = 0, wrong = 0;
  for (uint32_t i = 0; i < mutations && wrong < 5; ++i) {
    const json damaged = mutate(files[i % files.size()], i);
    const std::string errors = structural_errors(reader, damaged.dump());
    const bool accepted = schema.accepts(damaged);
    rejected += accepted ? 0 : 1;
    if (accepted == errors.empty()) continue;
    ++wrong;
    ADD_FAILURE() << "mutation " << i << ": the schema " << (accepted ? "accepts" : "rejects")
                  << "\n"
                  << schema.first_problem(damaged) << "the parser says:\n"
                  << errors << damaged.dump().substr(0, 3000);
  }
  EXPECT_GT(rejected, mutations / 4) << "hardly any mutation damages anything";
}

std::vector<json> read_all(const char* folder, bool expectations = false) {
  std::vector<json> out;
  for (const fs::path& path : files_in(folder, expectations))
    out.push_back(parse(test::read_text(path)));
  return out;
}

// Every feature of the language once, with the shipped pass types.
constexpr const char* every_feature =
    R"({ "$schema": "x", "dermis": 2, "name": "whole", "note": "all of it",
  "settings": {
    "quality": { "choice": ["low", "high"], "by": "budget", "default": "high" },
    "samples": { "int": 16, "min": 4, "max": 64, "unit": "samples" },
    "radius": { "real": 1.5, "min": 0, "max": 8, "note": "of the blur" },
    "mirror": { "bool": true },
    "texturing": { "enum": ["post", "pre_post", "pre"], "default": "pre" } },
  "imports": {
    "material": { "format": "r8_uint", "size": "view" },
    "depth": { "format": ["depth", "r32f"], "size": "view", "optional": true } },
  "resources": {
    "half": { "format": "rgba16f", "size": "view*3/4", "round": "floor", "align": 8, "border": 4, "mips": "full", "layers": 2 },
    "kept": { "format": "rgba16f", "size": "half/2", "mips": 2,
              "history": { "frames": 2, "first": "clear", "on_cut": "keep", "on_resize": "rescale", "note": "n" } },
    "fixed": { "format": "rgba16f", "size": [64, 32], "optional": true },
    "list": { "buffer": { "stride": 4, "count": 64, "extra": 4, "round": "ceil", "align": 2, "note": "n" },
              "history": { "frames": 1 } },
    "classes": { "buffer": { "stride": 4, "count": "view/8" } } },
  "passes": [
    { "pass": "classify", "type": "subsurface.classify", "when": "mirror and samples > 8",
      "read": { "material": "material", "depth": "depth" }, "write": { "classes": "classes" }, "set": {},
      "otherwise": { "classes": "list" }, "after": [{ "pass": "classify", "reason": "r", "note": "n" }] },
    { "include": "parts/more.json", "note": "n" } ],
  "exports": ["fixed"] })";

TEST(Schema, GraphSchema_AgreesWithParserOnMutatedFiles) {
  std::vector<json> files = read_all("configs/graphs");
  files.push_back(parse(every_feature));
  expect_agreement(SchemaFile(parse(graph_schema(subsurface::make_pass_types()))), read_graph_text,
                   files, static_cast<int>(dermis::testing::seeds_to_try(4000, 10000)));
}

TEST(Schema, FragmentSchema_AgreesWithParserOnMutatedFiles) {
  json fragment = parse(every_feature);
  fragment.erase("dermis");
  fragment.erase("name");
  fragment["dermis_fragment"] = 2;
  const json small = parse(R"({ "dermis_fragment": 2, "passes": [ { "include": "a.json" } ] })");
  expect_agreement(SchemaFile(parse(fragment_schema(subsurface::make_pass_types()))),
                   read_fragment_text, {fragment, small}, 3000);
}

TEST(Schema, OverlaySchema_AgreesWithParserOnMutatedFiles) {
  std::vector<json> files = read_all("configs/overlays");
  files.push_back(parse(R"({ "$schema": "x", "dermis_overlay": 2, "note": "n", "edits": [
    { "insert_before": "combine", "passes": [ { "pass": "a", "type": "k" } ], "note": "n" },
    { "insert_after": "combine", "passes": [ { "include": "a.json" } ] },
    { "replace": "combine", "passes": [ { "pass": "a" }, { "pass": "b" } ] },
    { "remove": "/passes/combine/otherwise" }, { "set": "/exports/-", "to": "x", "note": "n" } ] })"));
  expect_agreement(schema_in("configs/schema/overlay.schema.json"), read_overlay_text, files, 3000);
}

TEST(Schema, ExpectationSchema_AgreesWithParserOnMutatedFiles) {
  std::vector<json> files = read_all("configs/graphs", true);
  files.push_back(parse(
      R"({ "$schema": "x", "dermis_expect": 1, "note": "n", "cases": [ { "case": "all", "note": "n",
    "size": [640, 360], "overlays": ["a.json"], "set": { "a": true, "b": 1.5, "c": "x", "d": 3 }, "unbound": ["u"],
    "host_formats": { "x": "rgba16f" },
    "device": { "unsupported_formats": ["r32f"], "lacks": ["ray_query"], "max_image_dimension": 4096, "note": "n" },
    "expect": { "passes": ["p"], "culled": { "q": "why" }, "barriers": 1, "batches": 2, "transient_bytes": 3,
                "history_bytes": 4, "diagnostics": ["D0301"], "note": "n" } } ] })"));
  expect_agreement(schema_in("configs/schema/expectation.schema.json"), read_expectation_text,
                   files, 6000);
}

TEST(Schema, ProfileSchema_AgreesWithParserOnMutatedFiles) {
  std::vector<json> files = read_all("configs/profiles");
  files.push_back(
      parse(R"({ "dermis_profile": 1, "name": "m", "source": "s", "model": "burley", "note": "n",
    "mfp_mm": [1, 2, 3], "scaling": "diffuse_surface", "albedo": [0, 0.5, 1] })"));
  files.push_back(
      parse(R"({ "dermis_profile": 1, "name": "d", "source": "s", "model": "dipole", "eta": 1.4,
    "sigma_a_per_mm": [0.032, 0.17, 0.48], "sigma_s_prime_per_mm": [0.74, 0.88, 1.01] })"));
  files.push_back(parse(R"({ "dermis_profile": 1, "name": "a", "source": "s", "model": "artist",
    "falloff": [1, 0.37, 0.3], "strength": [0.48, 0.41, 0.28] })"));
  expect_agreement(schema_in("configs/schema/profile.schema.json"), read_profile_text, files, 6000);
}

TEST(Schema, SceneSchema_AgreesWithParserOnMutatedFiles) {
  std::vector<json> files = read_all("configs/scenes");
  files.push_back(
      parse(R"({ "dermis_scene": 1, "name": "s", "profiles": [ { "name": "skin", "file": "a" } ],
    "camera": { "projection": "orthographic", "position": { "keys": [[0, 0, 0, 1], [1, 0, 0, 2]] },
                "target": [0, 0, 0], "height": { "sine": { "mean": 1, "amplitude": 0.5, "hertz": 2, "phase": 0 } } },
    "lights": [ { "type": "point", "position": [0, 1, 0], "intensity": { "keys": [[0, 1]] } },
                { "type": "directional", "position": [0, 1, 0], "target": [0, 0, 0], "intensity": 1, "extent": 2 } ],
    "objects": [ { "shape": "sphere" } ] })"));
  expect_agreement(schema_in("configs/schema/scene.schema.json"), read_scene_text, files, 6000);
}

TEST(Schema, CaptureSchema_AgreesWithParserOnMutatedFiles) {
  const std::vector<json> files = {
      parse(R"({ "dermis_capture": 1, "width": 256, "height": 128, "projection": "orthographic",
        "pixel_pitch_m": 0.0005, "jitter_px": [0.5, 0], "exposure": 2, "frame_index": 7, "cut": true,
        "render_rectangle": [0, 0, 128, 64],
        "profiles": [ { "id": 1, "file": "skin", "note": "n" }, { "id": 2, "dmfp_mm": [1, 2, 3], "albedo": [0, 0.5, 1] },
                      { "id": 3, "model": "dipole", "sigma_a_per_mm": [1, 2, 3], "sigma_s_prime_per_mm": [1, 1, 1] },
                      { "id": 4, "model": "artist", "falloff": [1, 2, 3], "strength": [0, 1, 1] } ] })"),
      parse(
          R"({ "dermis_capture": 1, "width": 16, "height": 16, "projection": "perspective", "metres_per_unit": 0.01,
        "clip_from_view": [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0.1, 0, 0, -1, 0],
        "view_from_world": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
        "previous_clip_from_view": [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0.1, 0, 0, -1, 0],
        "profiles": [] })")};
  expect_agreement(schema_in("configs/schema/capture.schema.json"), read_capture_text, files, 3000);
}

TEST(Schema, ErrorTableSchema_AgreesWithParserOnMutatedFiles) {
  const std::vector<json> files = {
      parse(test::read_text(fs::path(DERMIS_SOURCE_DIR) / "configs/choice/errors.json")),
      parse(
          R"({ "dermis_errors": 2, "scenes": "s", "note": "n", "unscattered": [[1, 0.1]], "techniques": [
        { "name": "t", "note": "n", "rmse": [[1, 2], [2, 3, 1.5]],
          "pass_types": [{ "type": "k", "set": { "a": 1, "b": true, "c": "x", "d": 1.5 }, "note": "n" }] } ] })")};
  expect_agreement(schema_in("configs/schema/errors.schema.json"), read_errors_text, files, 3000);
}

TEST(Schema, CalibrationSchema_AgreesWithParserOnMutatedFiles) {
  const std::vector<json> files = {parse(
      R"({ "$schema": "x", "dermis_calibration": 2, "device": "d", "note": "n", "uncertainty": 2, "costs": [
        { "work": "a", "base_us": 1, "group_us": 0.5, "spread": 0.1, "note": "n" },
        { "work": "b", "base_us": 0, "group_us": 0, "spread": 1 } ] })")};
  expect_agreement(schema_in("configs/schema/calibration.schema.json"), read_calibration_text,
                   files, 3000);
}

TEST(Schema, PassTypeSchema_AgreesWithParserOnMutatedFiles) {
  const std::vector<json> files = {
      parse(R"({ "$schema": "x", "dermis_pass_types": 2, "note": "n", "pass_types": [
        { "name": "studio.bloom", "doc": "d", "side_effects": true, "serves_scattering": true, "note": "n",
          "ports": [ { "name": "light", "usage": "sampled_image", "own_texels": true, "doc": "d", "note": "n" },
                     { "name": "glow", "usage": "storage_image_write", "optional": true,
                       "internally_ordered": true } ],
          "settings": [ { "name": "level", "type": "real", "default": 1, "min": 0, "max": 4.5, "per": "frame", "unit": "px", "doc": "d" },
                        { "name": "taps", "type": "int", "default": 3, "min": 1, "max": 9, "note": "n" },
                        { "name": "wide", "type": "bool", "default": 1 } ] },
        { "name": "studio.count", "ports": [ { "name": "sums", "usage": "storage_buffer_update" } ] } ] })")};
  expect_agreement(schema_in("configs/schema/pass_types.schema.json"), read_pass_types_text, files,
                   3000);
}

TEST(Schema, NoSchemaHasAPattern) {
  std::map<std::string, std::string> schemas = {
      {"graph", graph_schema(subsurface::make_pass_types())},
      {"fragment", fragment_schema(subsurface::make_pass_types())}};
  for (const fs::path& path : files_in("configs/schema"))
    schemas[path.string()] = test::read_text(path);
  for (const auto& [path, schema] : schemas) {
    json text = parse(schema);
    std::vector<json*> all;
    collect(text, all);
    for (const json* one : all) {
      EXPECT_FALSE(one->is_object() && (one->contains("pattern") && !(*one)["pattern"].is_object()))
          << path;
      EXPECT_FALSE(one->is_object() && one->contains("patternProperties")) << path;
    }
  }
}

} // namespace
} // namespace dermis::testing
