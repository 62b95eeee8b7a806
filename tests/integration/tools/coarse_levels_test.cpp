// Tests that the pass over several coarse levels gives the same pictures as one pass per level.

#include "tests/integration/tools/command_fixture.hpp"

#include <fmt/format.h>

namespace dermis::test {
namespace {

struct CoarseCase {
  const char* name;
  const char* graph; // file below configs/graphs
  const char* scene; // file below configs/scenes, without ".json"
  const char* size;
  std::vector<std::string> more = {};
  bool full = false; // storage
};

void PrintTo(const CoarseCase& one, std::ostream* out) {
  *out << one.name;
}

// Replaces the text from `begin` up to the next `end`.
void replace(std::string& text, const std::string& begin, const std::string& end,
             const std::string& by) {
  const size_t from = text.find(begin);
  ASSERT_NE(from, std::string::npos) << begin;
  const size_t to = text.find(end, from);
  ASSERT_NE(to, std::string::npos) << end;
  text.replace(from, to - from, by);
}
std::string value_after(const std::string& text, const std::string& key) {
  const size_t from = text.find(key) + key.size();
  return text.substr(from, text.find_first_of(",}", from) - from);
}

constexpr int first = 5, last = 8;
constexpr const char* lists =
    R"("level_tiles": "level_tiles", "level_arguments": "level_arguments")";

std::string images_of_levels(bool with_light) {
  std::string text;
  for (int level = first; level <= last; ++level)
    for (const char* layer : {"", "second_"})
      for (const char* image : {"light", "surface", "scattered"}) {
        if (with_light && level == first && image == std::string("light") && !*layer) continue;
        text += fmt::format(
            R"("{}{}_{}": {{ "format": "{}", "size": "view/{}", "align": 4, "border": 1 }},
)",
            layer, image, level, image == std::string("light") ? "rgba32f" : "rgba32_uint",
            1 << level);
      }
  return text;
}
std::string steps_down(const std::string& storage) {
  std::string text;
  for (int level = first; level <= last; ++level)
    text += fmt::format(R"({{ "pass": "down_{0}", "type": "subsurface.sap_down",
"read": {{ "light": "light_{1}", "surface": "surface_{1}", "second_light": "second_light_{1}",
          "second_surface": "second_surface_{1}", {2} }},
"write": {{ "coarse_light": "light_{0}", "coarse_surface": "surface_{0}",
           "second_coarse_light": "second_light_{0}",
           "second_coarse_surface": "second_surface_{0}" }},
"set": {{ "level": {0}, "storage": {3} }} }},
)",
                        level, level - 1, lists, storage);
  return text;
}
std::string steps_up(const std::string& storage, const std::string& variant) {
  std::string text;
  for (int level = last; level >= first - 1; --level) {
    const std::string coarser = level == last ? ""
                                              : fmt::format(R"("coarse_surface": "surface_{0}",
"coarse_scattered": "scattered_{0}", "second_coarse_surface": "second_surface_{0}",
"second_coarse_scattered": "second_scattered_{0}", )",
                                                            level + 1);
    text += fmt::format(R"({{ "pass": "up_{0}", "type": "subsurface.sap_up",
"read": {{ "light": "light_{0}", "surface": "surface_{0}", "second_light": "second_light_{0}",
          "second_surface": "second_surface_{0}", {1}{2} }},
"write": {{ "scattered": "scattered_{0}", "second_scattered": "second_scattered_{0}" }},
"set": {{ "level": {0}, "variant": {3}, "storage": {4} }} }},
)",
                        level, coarser, lists, variant, storage);
  }
  return text;
}

// Returns the text of a graph with a pass for each of levels 5 to 8 down and 8 to 4 up.
std::string separated(std::string text, const std::string& storage) {
  const std::string next_pass = "{ \"pass\"";
  const size_t up = text.find("\"coarse_up\"");
  const std::string variant = value_after(text.substr(up), "\"variant\": ");
  const bool with_light = text.find("\"light_5\"") != std::string::npos;
  replace(text, "\"coarse_levels\": {", "\"computed_children\"", images_of_levels(with_light));
  replace(text, "\"computed_children\": {", "\"scattered\":", "");
  replace(text, "{ \"pass\": \"clear_children\"", next_pass + ": \"coarse_down\"", "");
  replace(text, "{ \"pass\": \"coarse_down\"", next_pass + ": \"coarse_up\"", steps_down(storage));
  replace(text, "{ \"pass\": \"coarse_up\"", next_pass + ": \"up_3\"", steps_up(storage, variant));
  if (with_light) replace(text, "\"coarse_levels[0]\"", ",", "\"surface_5\"");
  return text;
}

class CoarseLevels : public CommandTest, public ::testing::WithParamInterface<CoarseCase> {
protected:
  // Writes a scene whose light scatters so far that coarse levels matter, and returns its path.
  std::string wide_scene(const std::string& name) const {
    std::string text = read_text("configs/scenes/" + name + ".json");
    const std::string folder = "../profiles/";
    for (size_t at = text.find(folder); at != std::string::npos; at = text.find(folder))
      text.erase(at, folder.size());
    for (const char* profile : {"skin", "jade", "wax"})
      write(std::string(profile) + ".json",
            R"({ "dermis_profile": 1, "name": "wide", "dmfp_mm": [30, 15, 6],
                  "albedo": [0.44, 0.22, 0.13], "source": "test" })");
    return write(name + ".json", text);
  }
  void render(const CoarseCase& one, const std::string& graph, const std::string& shape,
              const std::string& out, const std::vector<std::string>& overlay = {}) const {
    const std::string scene = wide_scene(one.scene);
    std::vector<std::string> words{
        "render",   scene, "--size",   one.size, "-g",        graph, "--out",   path(out),
        "--frames", "2",   "--subset", "0",      "--kernels", shape, "--quiet", "--deterministic"};
    words.insert(words.end(), one.more.begin(), one.more.end());
    words.insert(words.end(), overlay.begin(), overlay.end());
    RunOptions options;
    options.environment = validation_environment();
    const Outcome outcome = run(words, options);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "") << "a message of the validation layer";
  }
};

TEST_P(CoarseLevels, EqualOnePassPerLevel) {
  const std::string graph = std::string("configs/graphs/") + GetParam().graph;
  const std::string overlay = "configs/overlays/sap_full_precision.json";
  const bool full = GetParam().full;
  write("separate.json", separated(read_text(graph), full ? "\"full\"" : "\"half\""));
  std::string edits = read_text(overlay);
  replace(edits, "{ \"set\": \"/passes/coarse_down", "{ \"set\": \"/passes/up_3", "");
  write("separate_full.json", edits);
  if (HasFatalFailure()) return;
  const auto overlays = [&](const std::string& file) {
    return full ? std::vector<std::string>{"--overlay", file} : std::vector<std::string>{};
  };
  render(GetParam(), path("separate.json"), "cpu", "separate",
         overlays(path("separate_full.json")));
  for (const char* shape : {"cpu", "gpu"}) {
    render(GetParam(), graph, shape, shape, overlays(overlay));
    expect_equal_pictures("separate", shape);
  }
}

const CoarseCase coarse_cases[] = {
    {"two_layers", "sap.json", "dynamic", "333x187"},
    {"base", "sap.json", "dolly", "96x64", {"--set", "variant=base"}},
    {"full_storage", "sap.json", "bust", "96x64", {}, true},
    {"samples_read_level_5", "papers/sap_residual.json", "bust", "161x97"},
    {"one_texel_per_level", "sap.json", "bust", "1x1"},
    {"smaller_than_two_tiles", "sap.json", "bust", "9x7"},
    {"narrow", "sap.json", "bust", "2x259"},
    {"wide", "sap.json", "bust", "513x3"},
};
INSTANTIATE_TEST_SUITE_P(Graphs, CoarseLevels, ::testing::ValuesIn(coarse_cases),
                         [](const auto& one) { return std::string(one.param.name); });

using BrokenCoarseLevels = CoarseLevels;

// Without this test, equal pictures could be pictures that do not depend on coarse levels.
TEST_F(BrokenCoarseLevels, ChangePictures) {
  if (!has_shader_compiler()) GTEST_SKIP() << "built without glslang (package glslang-dev)";
  const std::string graph = "configs/graphs/sap.json";
  const CoarseCase one{"", "sap.json", "bust", "96x64"};
  render(one, graph, "gpu", "whole");
  const std::string copy = copy_shaders();
  for (const char* kernel : {"coarse_down", "coarse_up"}) {
    const std::string file = std::string("shaders/sap/subsurface_sap_") + kernel + ".comp";
    write(file, replaced(read_text(file), "void main() {", "void main() {\n  return;\n"));
    for (const char* shape : {"cpu", "gpu"}) {
      render(one, graph, shape, "broken", {"--shaders", copy});
      EXPECT_FALSE(read("whole/scattered_0001.exr") == read("broken/scattered_0001.exr"))
          << kernel << " for " << shape;
    }
    write(file, read_text(file));
  }
}

} // namespace
} // namespace dermis::test
