// Tests that both shapes of kernels give equal pictures, and that each shape really runs.

#include "tests/integration/tools/command_fixture.hpp"

namespace dermis::test {
namespace {

struct ShapeCase {
  const char* name;
  const char* scene;
  const char* size;
  std::vector<std::string> graph;
  bool small_groups = false; // Also renders with small groups, which change only coarse_down.
};

void PrintTo(const ShapeCase& one, std::ostream* out) {
  *out << one.name;
}

class KernelShape : public CommandTest, public ::testing::WithParamInterface<ShapeCase> {
protected:
  // Renders with kernels of the shape into the folder `out`.
  Outcome render(const ShapeCase& one, const std::string& shape, const std::string& out,
                 const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"render",    one.scene,  "--size",  one.size,         "--out",
                                   path(out),   "--frames", "2",       "--subset",       "0",
                                   "--kernels", shape,      "--quiet", "--deterministic"};
    words.insert(words.end(), one.graph.begin(), one.graph.end());
    words.insert(words.end(), more.begin(), more.end());
    RunOptions options;
    options.environment = validation_environment();
    return run(words, options);
  }
  // Returns the text of a kernel that writes nothing if the constant is true.
  static std::string broken(const std::string& file, const std::string& constant) {
    return replaced(read_text(file), "void main() {",
                    "void main() {\n  if (" + constant + ")\n    return;\n");
  }
};

TEST_P(KernelShape, GivesEqualPictures) {
  std::vector<std::string> shapes = {"cpu", "gpu"};
  if (GetParam().small_groups) shapes.push_back("gpu_small");
  for (const std::string& shape : shapes) {
    const Outcome outcome = render(GetParam(), shape, shape);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "") << "a message of the validation layer";
    if (shape != "cpu") expect_equal_pictures("cpu", shape);
  }
}

const ShapeCase shape_cases[] = {
    {"smooth", "configs/scenes/bust.json", "161x97", {"-g", "configs/graphs/sap.json"}, true},
    {"base",
     "configs/scenes/dolly.json",
     "96x64",
     {"-g", "configs/graphs/sap.json", "--set", "variant=base"}},
    {"half",
     "configs/scenes/bust.json",
     "161x97",
     {"-g", "configs/graphs/skin.json", "--set", "technique=sap", "--set", "variant=half"},
     true},
    {"half_with_high_pixels",
     "configs/scenes/bust.json",
     "96x64",
     {"-g", "configs/graphs/skin.json", "--set", "technique=sap", "--set", "variant=half",
      "--pixel-aspect", "0.25"}},
    {"wide_pixels",
     "configs/scenes/bust.json",
     "96x64",
     {"-g", "configs/graphs/sap.json", "--pixel-aspect", "2.2"}},
    {"full_precision",
     "configs/scenes/bust.json",
     "96x64",
     {"-g", "configs/graphs/sap.json", "--overlay", "configs/overlays/sap_full_precision.json"},
     true},
    {"hybrid", "configs/scenes/dynamic.json", "96x64", {"-g", "configs/graphs/papers/hybrid.json"}},
    {"residual",
     "configs/scenes/bust.json",
     "96x64",
     {"-g", "configs/graphs/papers/sap_residual.json"}},
    {"smaller_than_two_tiles",
     "configs/scenes/bust.json",
     "9x7",
     {"-g", "configs/graphs/sap.json"},
     true},
};
INSTANTIATE_TEST_SUITE_P(Graphs, KernelShape, ::testing::ValuesIn(shape_cases),
                         [](const auto& one) { return std::string(one.param.name); });

using KernelShapes = KernelShape;

// Without this test, two equal pictures could be two pictures of one shape.
TEST_F(KernelShapes, BrokenTexelShape_ChangesOnlyPicturesForGpus) {
  if (!has_shader_compiler()) GTEST_SKIP() << "built without glslang (package glslang-dev)";
  const ShapeCase smooth{
      "", "configs/scenes/bust.json", "96x64", {"-g", "configs/graphs/sap.json"}};
  const ShapeCase half{
      "",
      "configs/scenes/bust.json",
      "96x64",
      {"-g", "configs/graphs/skin.json", "--set", "technique=sap", "--set", "variant=half"}};
  ASSERT_EQ(render(smooth, "cpu", "smooth").exit_code, 0);
  ASSERT_EQ(render(half, "cpu", "half").exit_code, 0);
  const std::string copy = copy_shaders();
  const char* kernels[] = {"setup", "down", "up", "gather", "setup_half_res", "gather_half"};
  for (const char* kernel : kernels) {
    SCOPED_TRACE(kernel);
    const std::string file = std::string("shaders/sap/subsurface_sap_") + kernel + ".comp";
    write(file, broken(file, "texel_shape"));
    const std::string reference =
        std::string(kernel).find("half") != std::string::npos ? "half" : "smooth";
    ASSERT_EQ(
        render(reference == "half" ? half : smooth, "gpu", "gpu", {"--shaders", copy}).exit_code,
        0);
    EXPECT_FALSE(read(reference + "/scattered_0001.exr") == read("gpu/scattered_0001.exr"));
    write(file, read_text(file));
  }
  for (const char* kernel : kernels) {
    const std::string file = std::string("shaders/sap/subsurface_sap_") + kernel + ".comp";
    write(file, broken(file, "texel_shape"));
  }
  ASSERT_EQ(render(smooth, "cpu", "cpu", {"--shaders", copy}).exit_code, 0);
  expect_equal_pictures("smooth", "cpu");
  ASSERT_EQ(render(half, "cpu", "cpu", {"--shaders", copy}).exit_code, 0);
  expect_equal_pictures("half", "cpu");
}

// The camera is so close that light reaches as far as the coarse levels, which wide groups compute.
TEST_F(KernelShapes, WideGroups_GiveEqualPictures) {
  if (!has_shader_compiler()) GTEST_SKIP() << "built without glslang (package glslang-dev)";
  std::string scene = read_text("configs/scenes/bust.json");
  const auto replace = [&](const std::string& old, const std::string& by) {
    for (size_t at = 0; (at = scene.find(old, at)) != std::string::npos; at += by.size())
      scene.replace(at, old.size(), by);
  };
  replace("../profiles", DERMIS_SOURCE_DIR "/configs/profiles");
  replace("\"vertical_fov\": 16", "\"vertical_fov\": 1.2");
  const std::string near = write("near.json", scene);
  const ShapeCase one{
      "", near.c_str(), "96x64", {"-g", "configs/graphs/sap.json", "--root", DERMIS_SOURCE_DIR}};
  for (const char* shape : {"cpu", "gpu", "gpu_small"})
    ASSERT_EQ(render(one, shape, shape).exit_code, 0);
  expect_equal_pictures("cpu", "gpu");
  expect_equal_pictures("cpu", "gpu_small");

  const std::string copy = copy_shaders();
  const std::string file = "shaders/sap/subsurface_sap_coarse_down.comp";
  write(file, broken(file, "wide_group"));
  for (const char* shape : {"gpu", "gpu_small"})
    ASSERT_EQ(render(one, shape, shape, {"--shaders", copy}).exit_code, 0);
  EXPECT_FALSE(read("cpu/scattered_0001.exr") == read("gpu/scattered_0001.exr"));
  expect_equal_pictures("cpu", "gpu_small");
}

} // namespace
} // namespace dermis::test
