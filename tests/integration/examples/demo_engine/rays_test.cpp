// Tests scattering by rays. The reference samples points by area over the triangles, so it shares
// no sampler with the graph.
#include "integration/examples/demo_engine/geometry/shapes.hpp"
#include "passes/common/profiles/profile.hpp"
#include "tests/integration/examples/demo_engine/ray_queries.hpp"
#include "tests/passes/restir/area_reference.hpp"

#include "framegraph/text/document.hpp"

#include <glm/gtc/matrix_transform.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <unistd.h>

namespace demo {
namespace {

namespace restir = dermis::restir;

RenderOptions back_lit(const std::string& technique, uint32_t samples, uint32_t frames) {
  return by_rays(source + "/configs/scenes/back_lit.json", 64, frames,
                 {{"technique", "\"" + technique + "\""},
                  {"samples", std::to_string(samples)},
                  {"reuse", "\"none\""}});
}

bool withheld(const Rendering& rendering) {
  return std::any_of(rendering.warnings.begin(), rendering.warnings.end(),
                     [](const std::string& warning) {
                       return warning.find("does not offer 'restir': the device lacks ray_query") !=
                              std::string::npos;
                     });
}

TEST(WithoutRayQueries, FallsBackToThePyramidAndReportsIt) {
  const Rendering rendering = rendered(back_lit("restir", 1, 1));
  ASSERT_EQ(rendering.frames.size(), 1u);
  if (!withheld(rendering)) GTEST_SKIP() << "this device has ray queries";
  EXPECT_TRUE(ran(rendering.frames[0], "gather"));
  EXPECT_FALSE(ran(rendering.frames[0], "sample_paths"));
}

restir::Vector3 vector_of(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

// Returns back_lit.json in millimetres.
restir::testing::TriangleScene triangles_of_scene(const restir::Vector3& d_mm) {
  restir::testing::TriangleScene scene;
  scene.d = {{}, d_mm};
  const Mesh ball = make_sphere();
  const auto add = [&](const glm::dvec3& position, double turn, const glm::dvec3& scale) {
    glm::dmat4 world = glm::translate(glm::dmat4(1.0), 1000.0 * position);
    world = glm::rotate(world, glm::radians(turn), glm::dvec3(0, 1, 0));
    world = glm::scale(world, 1000.0 * scale);
    std::vector<restir::Vector3> corners;
    for (const uint32_t index : ball.indices)
      corners.push_back(
          vector_of(glm::dvec3(world * glm::dvec4(ball.vertices[index].position, 1.0))));
    restir::testing::add_instance(scene, 1, corners);
  };
  add({0.012, 0, 0}, 12, {0.024, 0.034, 0.0014});
  add({-0.036, -0.012, 0}, 0, {0.012, 0.012, 0.012});
  const auto light = [&](const glm::dvec3& position, const glm::dvec3& color, double intensity) {
    restir::Light one;
    one.position = vector_of(1000.0 * position);
    one.emission = vector_of(1e6 * intensity * color);
    scene.lights.push_back(one);
  };
  light({0.02, 0.03, -0.15}, {1.0, 0.95, 0.9}, 0.03);
  light({-0.20, 0.10, 0.15}, {0.75, 0.86, 1.0}, 0.002);
  restir::testing::finish(scene);
  return scene;
}

// Returns the graph's input pixels for the reference.
std::vector<restir::testing::Pixel> pixels_of(const FrameOutputs& frame,
                                              const restir::Vector3& d_mm) {
  std::vector<restir::testing::Pixel> pixels(frame.inputs.depth.texels.size());
  const auto& clip = frame.camera.clip_from_view;
  const auto& view = frame.camera.view_from_world;
  const auto to_world = [&](const glm::dvec3& v) { // The transpose of the rotation.
    return glm::dvec3(view[0] * v.x + view[4] * v.y + view[8] * v.z,
                      view[1] * v.x + view[5] * v.y + view[9] * v.z,
                      view[2] * v.x + view[6] * v.y + view[10] * v.z);
  };
  const uint32_t width = frame.inputs.depth.width, height = frame.inputs.depth.height;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const size_t i = size_t{y} * width + x;
      const double depth = double(frame.inputs.depth.texels[i]);
      if (frame.inputs.profile.texels[i] == 0 || !(depth > 0)) continue;
      const double across = (2.0 * (x + 0.5) / width - 1.0) * depth / double(clip[0]);
      const double up = (2.0 * (y + 0.5) / height - 1.0) * depth / double(clip[5]);
      const glm::dvec3 from_eye =
          glm::dvec3(across, up, -depth) - glm::dvec3(view[3], view[7], view[11]);
      const float* n = frame.inputs.normal.texels.data() + 3 * i;
      restir::testing::Pixel& pixel = pixels[i];
      pixel.domain = {vector_of(1000.0 * to_world(from_eye)),
                      vector_of(glm::normalize(to_world(glm::dvec3(n[0], n[1], n[2])))), d_mm, 1};
    }
  return pixels;
}

restir::Vector3 skin_d() {
  dermis::Diagnostics diagnostics;
  const auto document = dermis::read_document(source + "/configs/profiles/skin.json", diagnostics);
  const auto profile =
      document ? dermis::subsurface::read_profile(*document, diagnostics) : std::nullopt;
  EXPECT_TRUE(profile);
  return profile ? restir::Vector3{profile->d_mm[0], profile->d_mm[1], profile->d_mm[2]}
                 : restir::Vector3{};
}

TEST_F(WithRayQueries, TransmissionMatchesTheReference) {
  constexpr uint32_t frames = 16, samples = 64;
  const Rendering rays = rendered(back_lit("restir", samples, frames));
  ASSERT_EQ(rays.frames.size(), frames);
  ASSERT_FALSE(withheld(rays));
  EXPECT_TRUE(ran(rays.frames[0], "sample_paths"));
  EXPECT_TRUE(ran(rays.frames[0], "resolve"));
  EXPECT_FALSE(ran(rays.frames[0], "gather"));

  const restir::Vector3 d = skin_d();
  const auto scene = triangles_of_scene(d);
  const auto pixels = pixels_of(rays.frames[0], d);
  // Light passes through the sheet; the lobe is lit on its own side.
  restir::testing::Regions regions;
  regions.pixels.resize(2);
  const uint32_t width = rays.frames[0].inputs.depth.width;
  for (uint32_t i = 0; i < pixels.size(); ++i)
    if (pixels[i].domain.medium != 0) regions.pixels[i % width < width / 4 ? 1 : 0].push_back(i);
  constexpr uint32_t batches = 16, points = 20000;
  const auto reference =
      restir::testing::area_reference(scene, pixels, regions, batches, points, 7);

  const Rendering pyramid = rendered(back_lit("sap", 1, 1));
  ASSERT_EQ(pyramid.frames.size(), 1u);
  for (size_t r = 0; r < regions.pixels.size(); ++r) {
    ASSERT_GT(regions.pixels[r].size(), 50u);
    const auto mean_over = [&](const FloatImage& image) {
      double sum = 0;
      for (const uint32_t pixel : regions.pixels[r])
        sum += luminance(image, pixel);
      return sum / double(regions.pixels[r].size());
    };
    std::vector<double> means;
    for (const FrameOutputs& frame : rays.frames)
      means.push_back(mean_over(frame.scattered));
    const restir::testing::Mean measured = restir::testing::mean_of(means);
    const restir::testing::Mean expected = restir::testing::mean_of(reference[r]);
    const double flat = mean_over(pyramid.frames[0].scattered);
    RecordProperty("region_" + std::to_string(r), std::to_string(measured.mean) + " of " +
                                                      std::to_string(expected.mean) + ", sap " +
                                                      std::to_string(flat));
    // Three standard errors of both, and 2 %: the reference's facets are shaded flat, the graph's
    // smoothly.
    const double noise = 3 * std::hypot(measured.sigma, expected.sigma);
    EXPECT_NEAR(measured.mean, expected.mean, noise + 0.02 * expected.mean)
        << "region " << r << ", sap " << flat;
    EXPECT_TRUE(r != 0 || flat < 0.5 * measured.mean)
        << "screen space has no light from behind the sheet";
  }
}

// Only red scatters in this profile; the other channels keep the pixel's own light with any
// technique.
TEST_F(WithRayQueries, ChannelsThatDoNotScatterKeepTheirLight) {
  const std::string profile =
      std::filesystem::temp_directory_path() / ("dermis_red_" + std::to_string(getpid()) + ".json");
  std::ofstream(profile) << R"({ "dermis_profile": 1, "name": "red", "source": "made up",
    "dmfp_mm": [3.673, 0, 0], "albedo": [0.44, 0.22, 0.13] })";
  RenderOptions rays = back_lit("restir", 1, 1), pyramid = back_lit("sap", 1, 1);
  rays.profile = pyramid.profile = profile;
  const Rendering by_rays = rendered(rays), by_pyramid = rendered(pyramid);
  std::filesystem::remove(profile);
  ASSERT_EQ(by_rays.frames.size(), 1u);
  ASSERT_EQ(by_pyramid.frames.size(), 1u);
  EXPECT_TRUE(ran(by_rays.frames[0], "resolve"));
  const FloatImage& found = by_rays.frames[0].color; // The output of combine, times albedo.
  const FloatImage& expected = by_pyramid.frames[0].color;
  size_t lit = 0, red_differs = 0;
  for (size_t i = 0; i < found.texels.size(); i += 3) {
    EXPECT_EQ(found.texels[i + 1], expected.texels[i + 1]) << "pixel " << i / 3;
    EXPECT_EQ(found.texels[i + 2], expected.texels[i + 2]) << "pixel " << i / 3;
    lit += found.texels[i + 1] > 0.01f;
    red_differs += found.texels[i] != expected.texels[i];
  }
  EXPECT_GT(lit, 20u);
  EXPECT_GT(red_differs, 100u);
}

} // namespace
} // namespace demo
