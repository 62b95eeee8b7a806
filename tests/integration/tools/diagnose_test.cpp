// Tests that `dermis validate FRAMES --diagnose` names each error of an engine's first frame that a
// capture can show: the rows of "Common integration mistakes" in docs/integration.md.

#include "tests/integration/tools/capture_builder.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>

namespace dermis::test {
namespace {

constexpr uint32_t side = 64;
// Metres; `tangent` is that of half the view.
constexpr double radius = 0.1, distance = 0.5, near_plane = 0.1, tangent = 0.25;

// A sphere of skin in front of nothing, seen by a perspective camera with infinite depth. The frame
// is correct; each test breaks one property.
struct Mistake {
  std::string projection = fmt::format(
      "[{0}, 0, 0, 0,  0, -{0}, 0, 0,  0, 0, -1, -{1},  0, 0, -1, 0]", 1 / tangent, near_plane);
  std::string view = "[1, 0, 0, 0.5,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1]";
  std::string more; // More members of frame.json.
  // Depth value of a distance in metres; 0: no surface.
  std::function<double(double)> depth = [](double d) { return d; };
  // Light of shade and albedo.
  std::function<double(double, double)> light = [](double shade, double) { return shade; };
  float id = 1;
  bool albedo = true;
};

struct DiagnoseTest : CommandTest {
  Outcome diagnose(const Mistake& mistake) {
    const std::filesystem::path folder = path("frame");
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "frame.json")
        << fmt::format("{{ \"dermis_capture\": 1, \"width\": {0}, \"height\": {0}, \"projection\": "
                       "\"perspective\",\n"
                       "  \"clip_from_view\": {1}, \"view_from_world\": {2}, {3}\n"
                       "  \"profiles\": [{{ \"id\": 1, \"file\": \"skin\" }}] }}\n",
                       side, mistake.projection, mistake.view, mistake.more);
    tools::Image depth = filled(side, side, 1, 0), profile = depth;
    tools::Image light = filled(side, side, 3, 0), albedo = light;
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x) {
        const double u = tangent * (2 * (x + 0.5) / side - 1),
                     v = tangent * (2 * (y + 0.5) / side - 1);
        // |(u, v, 1) d - (0, 0, distance)| = radius
        const double a = 1 + u * u + v * v,
                     under = distance * distance - a * (distance * distance - radius * radius);
        const double metres = under > 0 ? (distance - std::sqrt(under)) / a : 0;
        depth.at(x, y, 0) = static_cast<float>(mistake.depth(metres));
        if (metres <= 0) continue;
        profile.at(x, y, 0) = mistake.id;
        const double texture = (x / 3 + y / 3) % 2 == 0 ? 0.3 : 0.8;
        for (uint32_t c = 0; c < 3; ++c) {
          albedo.at(x, y, c) = static_cast<float>(texture);
          light.at(x, y, c) = static_cast<float>(mistake.light(0.2 + 0.8 * x / side, texture));
        }
      }
    write_channel(folder, "depth", depth);
    write_channel(folder, "profile", profile);
    write_channel(folder, "lighting", light);
    if (mistake.albedo) write_channel(folder, "albedo", albedo);
    return run({"validate", folder.string(), "--diagnose"});
  }

  void expect_finding(const Mistake& mistake, const std::string& code, const std::string& text) {
    EXPECT_THAT(diagnose(mistake), FailsWith(1, code, text));
  }
};

TEST_F(DiagnoseTest, CorrectFrameHasNoFindings) {
  const Outcome outcome = diagnose({});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(outcome.out, HasAll("d 0.", " px (median)", " m (5th"));
}

TEST_F(DiagnoseTest, NothingScatters_NoPixelHasAProfile) {
  Mistake mistake;
  mistake.id = 0;
  expect_finding(mistake, "D0520", "are 0: nothing scatters");
}

TEST_F(DiagnoseTest, NothingScatters_UnknownId) {
  Mistake mistake;
  mistake.id = 7;
  expect_finding(mistake, "D0506", "have profile 7");
}

TEST_F(DiagnoseTest, NothingScatters_BelowAPixel) { // A distant surface: a note.
  Mistake mistake;
  mistake.projection = fmt::format("[{0}, 0, 0, 0,  0, -{0}, 0, 0,  0, 0, -1, -{1},  0, 0, -1, 0]",
                                   1 / tangent, near_plane);
  mistake.depth = [](double d) { return d * 20; };
  const Outcome outcome = diagnose(mistake);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("D0526"));
}

TEST_F(DiagnoseTest, TooNarrow_CentimetresReadAsMetres) {
  Mistake mistake;
  mistake.depth = [](double d) { return d * 100; };
  expect_finding(mistake, "D0522", "centimetres, but are read as metres");
}

TEST_F(DiagnoseTest, TooNarrow_MillimetresReadAsMetres) {
  Mistake mistake;
  mistake.depth = [](double d) { return d * 5000; };
  expect_finding(mistake, "D0522", "millimetres, but are read as metres");
}

TEST_F(DiagnoseTest, TooWide_MetresReadAsMillimetres) {
  Mistake mistake;
  mistake.more = "\"metres_per_unit\": 0.001,";
  mistake.depth = [](double d) { return d * 0.001; };
  expect_finding(mistake, "D0522", "seem larger");
}

TEST_F(DiagnoseTest, WashedOut_LightingContainsAlbedo) {
  Mistake mistake;
  mistake.light = [](double shade, double albedo) { return shade * albedo; };
  expect_finding(mistake, "D0521", "already contains albedo");
}

TEST_F(DiagnoseTest, TooBright_AlbedoIsNotBound) { // A note: hosts may multiply later.
  Mistake mistake;
  mistake.albedo = false;
  const Outcome outcome = diagnose(mistake);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("D0525"));
}

TEST_F(DiagnoseTest, Stretched_ProjectionStoredByColumns) {
  Mistake mistake;
  mistake.projection = fmt::format("[{0}, 0, 0, 0,  0, -{0}, 0, 0,  0, 0, -1, -1,  0, 0, -{1}, 0]",
                                   1 / tangent, near_plane);
  expect_finding(mistake, "D0504", "column by column");
}

TEST_F(DiagnoseTest, Stretched_ViewStoredByColumns) {
  Mistake mistake;
  mistake.view = "[1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0,  0.5, 0, 0, 1]";
  expect_finding(mistake, "D0524", "column by column");
}

// 128 x 64 allocated, 64 x 64 rendered.
TEST_F(DiagnoseTest, Stretched_ProjectionOfTheAllocatedSize) {
  Mistake mistake;
  mistake.projection = fmt::format("[{0}, 0, 0, 0,  0, -{1}, 0, 0,  0, 0, -1, -{2},  0, 0, -1, 0]",
                                   0.5 / tangent, 1 / tangent, near_plane);
  expect_finding(mistake, "D0524", "2.000 times as wide as high");
}

TEST_F(DiagnoseTest, OneDistance_DepthBuffer) {
  Mistake mistake;
  mistake.depth = [](double d) { return d > 0 ? 1 - near_plane / d : 1.0; };
  expect_finding(mistake, "D0523", "looks like a depth buffer");
}

TEST_F(DiagnoseTest, OneDistance_Constant) {
  Mistake mistake;
  mistake.depth = [](double d) { return d > 0 ? 0.5 : 0.0; };
  expect_finding(mistake, "D0523", "all pixels with a profile are at 0.5 m");
}

TEST_F(DiagnoseTest, FlippedDepth_ReversedBuffer) {
  Mistake mistake;
  mistake.depth = [](double d) { return d > 0 ? near_plane / d : 0.0; };
  expect_finding(mistake, "D0523", "near and far exchanged");
}

TEST_F(DiagnoseTest, FlippedDepth_FarMinusDistance) {
  Mistake mistake;
  mistake.depth = [](double d) { return d > 0 ? 2 - d : 0.0; };
  expect_finding(mistake, "D0523", "near and far exchanged");
}

TEST_F(DiagnoseTest, NotANumberInLighting) {
  Mistake mistake;
  mistake.light = [](double shade, double) {
    return shade > 0.6 ? std::numeric_limits<double>::quiet_NaN() : shade;
  };
  expect_finding(mistake, "D0507", "not finite");
}

#ifdef DERMIS_EXAMPLES
// Runs integration/examples/write_capture.c, compiled as C and as C++, with the validation layer.
// The only finding in the capture is that all pixels have one depth: the example's scene is a wall
// parallel to the image.
TEST_F(DiagnoseTest, ReadsWhatTheExampleWrites) {
  std::string variables;
  for (const std::string& one : validation_environment())
    variables += one + " ";
  for (const char* name : {"example_write_capture", "example_write_capture_cpp"}) {
    const std::string folder = path(name), said = path("said");
    std::filesystem::create_directories(folder);
    const std::string line =
        "env " + variables + DERMIS_EXAMPLES "/" + name + " '" + folder + "' >'" + said + "' 2>&1";
    ASSERT_EQ(std::system(line.c_str()), 0) << read("said");
    EXPECT_EQ(read("said"), "");
    const Outcome outcome = run({"validate", folder, "--diagnose"});
    EXPECT_THAT(outcome.err, HasAll("D0525", "all pixels with a profile are at 0.5 m"));
    for (const char* other : {"D0520", "D0521", "D0522", "D0524", "error["})
      EXPECT_THAT(outcome.err, Not(HasSubstr(other)));
    EXPECT_THAT(run({"apply", "--graph", burley, "--frames", folder, "--out", path("out")}),
                Succeeds());
  }
}
#endif

TEST_F(DiagnoseTest, NeedsCapturedFrames) {
  EXPECT_THAT(run({"validate", burley, "--diagnose"}),
              FailsWith(2, "--diagnose needs captured frames"));
}

} // namespace
} // namespace dermis::test
