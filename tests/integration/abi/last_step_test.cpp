// Tests that the pyramid's last step writes the same images with and without a pass of its own for
// `combine`, for both shapes of kernels. Pixels are compared bit by bit.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::abi_test {
namespace {

constexpr uint32_t width = 50, height = 41; // not a multiple of a tile

struct Case {
  const char* name;
  const char* graph;
  const char* texturing;
  std::vector<std::string> bound; // optional slots
  bool transmission = false;
  std::string variant = "smooth";
  // Tiles that are copied without scattering.
  enum class Copied { few, by_light, all } copied = Copied::few;
};
constexpr const char* skin = "configs/graphs/skin.json";

const Case cases[] = {
    {"minimal", "configs/graphs/sap.json", "post", {}},
    {"albedo", "configs/graphs/sap.json", "pre_post", {"albedo"}},
    {"exported", "configs/graphs/sap.json", "post", {"albedo", "scattered_light"}},
    {"scaled", "configs/graphs/sap.json", "pre", {"albedo", "scatter_scale", "scattered_light"}},
    {"scaled_only", "configs/graphs/sap.json", "post", {"scatter_scale"}},
    {"transmission",
     "configs/graphs/sap.json",
     "demodulate",
     {"albedo", "scattered_light", "thickness", "back_lighting"},
     true},
    {"skin", skin, "pre_post", {"albedo", "scatter_scale"}},
    {"skin_base", skin, "pre", {"albedo"}, false, "base"},
    {"skin_half", skin, "post", {"albedo", "scattered_light"}, false, "half"},
    {"skin_exported", skin, "demodulate", {"albedo", "scatter_scale", "scattered_light"}},
    {"skin_uniform",
     skin,
     "post",
     {"scatter_scale", "scattered_light"},
     false,
     "smooth",
     Case::Copied::by_light},
    {"skin_copied", skin, "pre", {"albedo"}, false, "smooth", Case::Copied::all},
    {"skin_copied_exported",
     skin,
     "post",
     {"albedo", "scattered_light"},
     false,
     "base",
     Case::Copied::all},
};

float noise(uint32_t x, uint32_t y, uint32_t seed) {
  return float((x * 73 + y * 151 + seed * 997) * 2654435761u % 1009) / 1009.0f;
}

struct LastStep : DermisTest, testing::WithParamInterface<std::tuple<Case, uint32_t>> {
  void SetUp() override {
    DermisTest::SetUp();
    if (IsSkipped()) return;
    share_context(std::get<uint32_t>(GetParam()));
  }

  // Two surfaces with a step in depth, holes, pixels without depth, and tiles that do not scatter.
  void paint() {
    fill("material", [](uint32_t x, uint32_t y) { return (x / 5 + y / 7) % 4 == 0 ? 0.0f : 1.0f; });
    const Case::Copied copied = std::get<Case>(GetParam()).copied;
    fill("depth", [&](uint32_t x, uint32_t y) {
      // a tile with a pixel that does not scatter is not tested for uniform light
      if (copied != Case::Copied::by_light && noise(x, y, 1) < 0.05f) return 0.0f;
      return (x < 24 ? 0.5f : 0.52f) + 0.0003f * float(x % 8 + y % 6);
    });
    fill("lighting", [&](uint32_t x, uint32_t y) {
      return copied == Case::Copied::by_light && x < 32 ? 0.7f : 3.0f * noise(x, y, 2);
    });
    const auto paint_if_bound = [&](const char* slot, auto value) {
      if (images.contains(slot)) fill(slot, value);
    };
    paint_if_bound("albedo", [](uint32_t x, uint32_t y) { return noise(x, y, 3); });
    paint_if_bound("scatter_scale", [&](uint32_t x, uint32_t y) {
      if (copied == Case::Copied::by_light) return 0.1f; // light reaches one tile
      return x >= 32 && y < 24 ? 0.0f : noise(x, y, 4);
    });
    paint_if_bound("thickness", [](uint32_t x, uint32_t y) { return 0.004f * noise(x, y, 5); });
    paint_if_bound("back_lighting", [](uint32_t x, uint32_t y) { return noise(x, y, 6); });
  }

  // Returns the texels of the written images after a frame.
  std::vector<std::vector<float>> run(const char* last_step) {
    const Case& one = std::get<Case>(GetParam());
    GraphOptions options = shipped_options(one.graph);
    options.width = width;
    options.height = height;
    options.unbound = {"albedo", "scatter_scale", "scattered_light", "thickness", "back_lighting"};
    std::erase_if(options.unbound, [&](const std::string& slot) {
      return std::find(one.bound.begin(), one.bound.end(), slot) != one.bound.end() ||
             options.text.find(fmt::format("\"{}\": {{", slot)) == std::string::npos;
    });
    const dermis_graph graph = make_graph(options);
    const auto set = [&](const char* name, const std::string& json) {
      EXPECT_OK(dermis_graph_set_setting(graph, name, json.c_str(), nullptr)) << name;
    };
    set("last_step", fmt::format("\"{}\"", last_step));
    set("texturing", fmt::format("\"{}\"", one.texturing));
    set("variant", fmt::format("\"{}\"", one.variant));
    if (one.transmission) set("transmission", "true");
    make_images(graph);
    paint();
    last_frame = 0;
    dermis_frame frame = bound_frame(graph, width, height);
    if (one.copied == Case::Copied::all) frame.metres_per_unit = 100; // a pixel is 5 cm
    const demo::ReportedFrame report = record_and_read(graph, frame);
    EXPECT_EQ(report.scattering_tiles == 0, one.copied == Case::Copied::all);
    EXPECT_EQ(report.uniform_tiles > 0, one.copied == Case::Copied::by_light);
    std::vector<std::vector<float>> written{texels("lighting")};
    if (images.contains("scattered_light")) written.push_back(texels("scattered_light"));
    return written;
  }
};

TEST_P(LastStep, Fused_WritesWhatSeparatePassesWrite) {
  const auto fused = run("fused"), separate = run("separate");
  ASSERT_EQ(fused.size(), separate.size());
  for (size_t image = 0; image < fused.size(); ++image)
    EXPECT_TRUE(fused[image] == separate[image]) << (image == 0 ? "lighting" : "scattered_light");
}

std::string name_of(const testing::TestParamInfo<LastStep::ParamType>& info) {
  const auto& [one, flag] = info.param;
  return fmt::format("{}_{}", one.name, flag == DERMIS_CONTEXT_CPU_KERNELS ? "cpu" : "gpu");
}

INSTANTIATE_TEST_SUITE_P(Cases, LastStep,
                         testing::Combine(testing::ValuesIn(cases),
                                          testing::Values(DERMIS_CONTEXT_CPU_KERNELS,
                                                          DERMIS_CONTEXT_GPU_KERNELS)),
                         name_of);

} // namespace
} // namespace dermis::abi_test
