// Tests kernels from text while a graph runs: unchanged kernels stay, changed kernels take effect,
// and broken kernels are reported with their place and change nothing.

#include "integration/abi/shaders/compiler.hpp"
#include "passes/common/kernels.hpp"
#include "tests/integration/abi/dermis_fixture.hpp"

#include <algorithm>
#include <set>

namespace dermis::abi_test {
namespace {

constexpr const char* combine = "common/subsurface_combine.comp"; // A kernel of burley.json.
constexpr const char* store = "settings.result, albedo, color)";

// The files of shaders/, some with another text.
struct Folder {
  std::map<std::string, std::string> changed;
  bool rest = true; // False: only `changed` exists.
  std::set<std::string> requested;
  std::map<std::string, std::string> delivered; // Kept for the duration of the call.

  std::string change(const std::string& name, const std::string& from, const std::string& to) {
    return changed[name] = replaced(read_text("shaders/" + name), from, to);
  }
};

uint32_t DERMIS_CALL open_in(void* user, const char* name, dermis_source* source) {
  auto& folder = *static_cast<Folder*>(user);
  folder.requested.insert(name);
  const auto changed = folder.changed.find(name);
  std::string& text = folder.delivered[name];
  text = changed != folder.changed.end() ? changed->second
         : folder.rest                   ? read_text(std::string("shaders/") + name)
                                         : "";
  if (text.empty()) return 0;
  const auto kept = folder.delivered.find(name);
  *source = source_of(kept->second, kept->first.c_str());
  return 1;
}

// Line, column.
std::pair<uint32_t, uint32_t> place_in(const std::string& text, const std::string& what) {
  const size_t at = text.find(what);
  return {static_cast<uint32_t>(
              std::count(text.begin(), text.begin() + static_cast<ptrdiff_t>(at), '\n') + 1),
          static_cast<uint32_t>(at - text.rfind('\n', at))};
}

struct Shaders : DermisTest {
  Folder folder;

  void SetUp() override {
    if (abi::shader_compiler().empty())
      GTEST_SKIP() << "built without glslang (package glslang-dev)";
    DermisTest::SetUp();
  }
  dermis_graph make() {
    const dermis_graph graph = make_bound_graph();
    return graph;
  }
  // Runs one more frame in the first frame's light.
  std::vector<float> light(dermis_graph graph) {
    fill("lighting", [](uint32_t x, uint32_t) { return x < 32 ? 1.0f : 0.0f; });
    dermis_frame one = bound_frame(graph);
    EXPECT_OK(record(graph, one));
    return texels("lighting");
  }
  dermis_result reload(dermis_graph graph, Said* said = nullptr) {
    dermis_report report = nullptr;
    const dermis_result result = dermis_graph_reload_shaders(graph, open_in, &folder, &report);
    if (said != nullptr)
      *said = take(report);
    else
      dermis_report_destroy(report);
    return result;
  }
  // The samples of a frame depend on its number, so later frames are compared with an unchanged
  // graph.
  void expect_unchanged_picture(dermis_graph graph) {
    const uint64_t before = last_frame;
    const auto now = light(graph);
    last_frame = before;
    const dermis_graph untouched = make_graph();
    EXPECT_EQ(now, light(untouched));
  }
};

TEST(ShaderCompiler, UnchangedText_GivesTheBuildsWords) {
  if (abi::shader_compiler().empty()) GTEST_SKIP() << "built without glslang (package glslang-dev)";
  std::vector<std::string> names;
  for (const Kernel& kernel : embedded_kernels())
    names.emplace_back(kernel.shader);
  const OpenFile open = [](std::string_view name) {
    return FileText{std::string(name), read_text("shaders/" + std::string(name)), ""};
  };
  std::vector<std::vector<uint32_t>> spirv;
  Diagnostics diagnostics;
  ASSERT_TRUE(abi::compile_shaders(names, open, spirv, diagnostics));
  ASSERT_EQ(spirv.size(), names.size());
  EXPECT_GT(names.size(), 25u);
  for (size_t i = 0; i < names.size(); ++i)
    EXPECT_TRUE(std::ranges::equal(spirv[i], find_kernel(names[i]))) << names[i];
}

TEST_F(Shaders, UnchangedText_GivesEqualLight) {
  const dermis_graph graph = make();
  light(graph);
  ASSERT_OK(reload(graph));
  EXPECT_THAT(folder.requested, AllOf(Contains(combine), Contains("common/environment.glsl")));
  EXPECT_THAT(folder.requested, Each(Not(HasSubstr("bindings"))))
      << "the library provides the bindings files";
  expect_unchanged_picture(graph);
}

TEST_F(Shaders, ChangedText_IsUsedUntilReset) {
  const dermis_graph graph = make();
  const auto whole = light(graph);
  folder.change(combine, store, "settings.result, albedo, color * 0.5)");
  ASSERT_OK(reload(graph));
  const uint64_t number = last_frame;
  const auto halved = light(graph);
  ASSERT_OK(dermis_graph_resize(graph, 64, 64, nullptr));
  last_frame = number + 1;
  const auto resized = light(graph);
  ASSERT_OK(dermis_graph_reload_shaders(graph, nullptr, nullptr, nullptr));
  last_frame = number;
  const dermis_graph untouched = make_graph();
  const auto expected = light(untouched);
  double sum = 0, sum_resized = 0, sum_expected = 0;
  for (size_t i = 0; i < expected.size(); ++i) {
    if (i % 4 == 3) continue;
    // Halving is exact above the smallest half floats (2^-24 apart).
    EXPECT_NEAR(halved[i], expected[i] / 2, 6e-8) << i;
    sum += halved[i];
    sum_resized += resized[i];
    sum_expected += expected[i];
  }
  EXPECT_NEAR(sum / sum_expected, 0.5, 1e-4);
  EXPECT_NEAR(sum_resized / sum_expected, 0.5, 0.01) << "also in a plan that was built later";
  last_frame = number + 2;
  expect_unchanged_picture(graph);
}

TEST_F(Shaders, TwoGraphs_HaveSeparateShaders) {
  const dermis_graph one = make(), other = make_graph();
  folder.change(combine, store, "settings.result, albedo, color * 0.5)");
  ASSERT_OK(reload(one));
  folder.change(combine, store, "settings.result, albedo, color * 0.25)");
  ASSERT_OK(reload(other));
  const uint64_t number = last_frame;
  const auto halved = light(one);
  last_frame = number;
  const auto quartered = light(other);
  double sum = 0;
  for (size_t i = 0; i < halved.size(); ++i) {
    if (i % 4 == 3) continue;
    // Exact except for the smallest half floats.
    EXPECT_NEAR(quartered[i], halved[i] / 2, 6e-8) << i;
    sum += halved[i];
  }
  EXPECT_GT(sum, 0);
}

TEST_F(Shaders, BrokenText_IsReportedAndChangesNothing) {
  const dermis_graph graph = make();
  light(graph);
  const std::string text =
      folder.change(combine, "texel, 0).rgb;\n  }", "texel, 0).rgb + colour;\n  }");
  Said said;
  EXPECT_EQ(reload(graph, &said), DERMIS_ERROR_SHADER);
  EXPECT_THAT(said.names, ElementsAre("shader_error")) << said.all;
  EXPECT_THAT(said.places, ElementsAre(place_in(text, "colour")));
  EXPECT_THAT(said.all, HasAll(std::string(combine) + ":", "'colour'", "^"));
  EXPECT_THAT(dermis_last_error(), HasSubstr(combine));
  expect_unchanged_picture(graph);
  folder.changed.clear(); // The next good text is accepted.
  EXPECT_OK(reload(graph));
}

TEST_F(Shaders, ErrorsAreReportedOncePerFile) {
  const dermis_graph graph = make();
  const std::string text = folder.change("common/half.glsl", "\nfloat ", "\nflote ");
  folder.change("common/subsurface_tile_list.comp", "void main() {", "void main() { nothing;");
  Said said;
  EXPECT_EQ(reload(graph, &said), DERMIS_ERROR_SHADER);
  EXPECT_EQ(std::ranges::count(said.names, "shader_error"), 2) << said.all;
  EXPECT_THAT(said.places, Contains(place_in(text, "flote "))) << said.all;
  EXPECT_THAT(said.all, HasAll("common/half.glsl:", "common/subsurface_tile_list.comp:"));
  expect_unchanged_picture(graph);
}

TEST_F(Shaders, OpenOnlyFilesOfTheirFolder) {
  const dermis_graph graph = make();
  for (const char* include :
       {"\"../secret.glsl\"", "\"/etc/passwd\"", "\"a/../../b.glsl\"", "\"C:\\\\b.glsl\"",
        "\"./half.glsl\"", "<half.glsl>", "\"not_there.glsl\""}) {
    folder.requested.clear();
    const std::string text = folder.change(combine, "#include \"common/combined_light.glsl\"",
                                           std::string("#include ") + include);
    Said said;
    EXPECT_EQ(reload(graph, &said), DERMIS_ERROR_SHADER) << include;
    ASSERT_THAT(said.names, ElementsAre("shader_error")) << said.all;
    EXPECT_EQ(said.places[0].first, place_in(text, include).first) << said.all;
    const bool named = std::string(include) == "\"not_there.glsl\"";
    for (const std::string& name : folder.requested)
      EXPECT_TRUE(name.starts_with("common/") || name.starts_with("burley/") ||
                  (named && name == "not_there.glsl"))
          << name;
    EXPECT_EQ(folder.requested.contains("not_there.glsl"), named);
    EXPECT_FALSE(folder.requested.contains("./half.glsl"));
  }
  expect_unchanged_picture(graph);
}

TEST_F(Shaders, RecursiveInclude_IsRejected) {
  const dermis_graph graph = make();
  folder.changed["common/half.glsl"] = "#include \"common/half.glsl\"\n";
  Said said;
  EXPECT_EQ(reload(graph, &said), DERMIS_ERROR_SHADER);
  EXPECT_THAT(said.all, HasSubstr("more than 16 files include each other"));
  folder.changed["common/half.glsl"] = "";
  for (int i = 0; i < 300; ++i)
    folder.changed["common/half.glsl"] += "#include \"empty.glsl\"\n";
  folder.changed["empty.glsl"] = "\n";
  EXPECT_EQ(reload(graph, &said), DERMIS_ERROR_SHADER);
  EXPECT_THAT(said.all, HasSubstr("more than 256 files are included"));
  expect_unchanged_picture(graph);
}

TEST_F(Shaders, SignatureMismatch_IsRejected) {
  const dermis_graph graph = make();
  folder.change(combine, "void main() {",
                "layout(set = 0, binding = 30) buffer stranger { float data[]; } other;\n"
                "void main() { other.data[0] = 1.0;");
  Said said;
  EXPECT_EQ(reload(graph, &said), DERMIS_ERROR_SHADER);
  EXPECT_THAT(said.names, Contains("kernel_mismatch")) << said.all;
  expect_unchanged_picture(graph);
}

TEST_F(Shaders, NoFileFound_IsAnError_OthersStayBuiltIn) {
  const dermis_graph graph = make();
  folder.rest = false;
  Said said;
  EXPECT_EQ(reload(graph, &said), DERMIS_ERROR_SHADER);
  EXPECT_THAT(said.all, HasSubstr("none of the graph's kernels")) << said.all;
  // A kernel without effect that needs no file of the folder.
  folder.changed[combine] = "#version 460\n#extension GL_GOOGLE_include_directive : require\n"
                            "#include \"common/subsurface_combine.bindings.glsl\"\n"
                            "layout(local_size_x = 8, local_size_y = 8) in;\nvoid main() {}\n";
  ASSERT_OK(reload(graph, &said)) << said.all;
  const auto untouched = light(graph);
  for (uint32_t x = 0; x < 64; ++x)
    EXPECT_EQ(untouched[size_t{x} * 4], x < 32 ? 1.0f : 0.0f);
}

} // namespace
} // namespace dermis::abi_test
