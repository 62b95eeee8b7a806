#include "integration/examples/demo_engine/geometry/bust.hpp"
#include "integration/examples/demo_engine/geometry/ear.hpp"
#include "integration/examples/demo_engine/geometry/shapes.hpp"
#include "integration/examples/demo_engine/geometry/surface_nets.hpp"

#include <gtest/gtest.h>

#include <map>

namespace demo {
namespace {

// Returns the fraction of triangles whose winding agrees with their vertices' normals.
double agreeing_triangles(const Mesh& mesh) {
  size_t agreeing = 0;
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    const Vertex& a = mesh.vertices[mesh.indices[i]];
    const Vertex& b = mesh.vertices[mesh.indices[i + 1]];
    const Vertex& c = mesh.vertices[mesh.indices[i + 2]];
    const glm::vec3 face = glm::cross(b.position - a.position, c.position - a.position);
    // Triangles at a pole have no area except the rounding of sin(pi) in fp32, about 1e-7 of the
    // radius.
    constexpr float rounding = 1e-8f;
    if (glm::dot(face, a.normal + b.normal + c.normal) >= -rounding) ++agreeing;
  }
  return static_cast<double>(agreeing) / static_cast<double>(mesh.indices.size() / 3);
}

// Counts the edges that do not have exactly one partner in the other direction.
size_t open_edges(const Mesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> balance;
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t from = mesh.indices[i + k], to = mesh.indices[i + (k + 1) % 3];
      balance[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  size_t open = 0;
  for (const auto& [edge, sum] : balance)
    if (sum != 0) ++open;
  return open;
}

TEST(SurfaceNets, MeshedBallIsClosedAndOnTheSurface) {
  const auto ball = [](const glm::vec3& p) {
    return sphere(p, glm::vec3(0.1f, -0.2f, 0.05f), 1.0f);
  };
  GridPlanes planes;
  planes.x = place_planes(-1.5f, 1.5f, [](float) { return 0.11f; });
  planes.y = place_planes(-1.6f, 1.4f, [](float at) { return 0.05f + 0.05f * std::abs(at); });
  planes.z = planes.x;
  const Mesh mesh = mesh_field(ball, planes, 0.5f);
  ASSERT_GT(mesh.indices.size(), 3000u);
  EXPECT_EQ(open_edges(mesh), 0u);
  EXPECT_EQ(agreeing_triangles(mesh), 1.0);
  for (const Vertex& vertex : mesh.vertices) {
    // A distance field's Newton step is exact; the remaining error is the gradient's difference
    // quotient in fp32.
    EXPECT_NEAR(ball(vertex.position), 0.0f, 1e-4f);
    EXPECT_GT(vertex.openness, 0.99f); // Nothing is near a convex body.
  }
}

TEST(Bust, IsClosedFacesOutwardAndHasHumanSize) {
  const Mesh mesh = make_bust(2.0f);
  EXPECT_EQ(open_edges(mesh), 0u);
  // At slits thinner than a cell, vertices of one cell belong to both lips; few triangles are
  // affected.
  EXPECT_GT(agreeing_triangles(mesh), 0.99);
  const Bounds bounds = bounds_of(mesh);
  EXPECT_NEAR(bounds.high.y, 0.115, 0.01);               // Crown above the eyes.
  EXPECT_NEAR(bounds.high.x - bounds.low.x, 0.36, 0.03); // Shoulders, in metres.
  EXPECT_LT(bust_distance(glm::vec3(0, 0, 0)), 0.0f);
  EXPECT_GT(bust_distance(glm::vec3(0, 0, 14)), 0.0f);
}

TEST(Bust, HasAProtrudingNoseAndThinEars) {
  // Along the middle of the face the nose extends at least 15 mm before the upper lip and the brow.
  const auto front_at = [](float y) {
    float z = 15.0f;
    while (z > 0.0f && bust_distance(glm::vec3(0.0f, y, z)) > 0.0f)
      z -= 0.01f;
    return z;
  };
  EXPECT_GT(front_at(-4.0f), front_at(-6.0f) + 1.5f);
  EXPECT_GT(front_at(-4.0f), front_at(2.0f) + 1.5f);
  // The thinnest sideways chord through the ear's upper rim is a few millimetres.
  float thinnest = 100.0f;
  for (float z = -4.0f; z < 0.0f; z += 0.1f) {
    float thickness = 0.0f;
    for (float x = 6.8f; x < 10.0f; x += 0.01f)
      if (bust_distance(glm::vec3(x, 0.6f, z)) < 0.0f) thickness += 0.01f;
    if (thickness > 0.0f) thinnest = std::min(thinnest, thickness);
  }
  EXPECT_LT(thinnest, 0.8f);
}

TEST(Ear, IsClosedFacesOutwardAndIsThin) {
  const Mesh mesh = make_ear();
  EXPECT_EQ(open_edges(mesh), 0u);
  EXPECT_GT(agreeing_triangles(mesh), 0.995);
  const Bounds bounds = bounds_of(mesh);
  EXPECT_NEAR(bounds.high.y - bounds.low.y, 0.064, 0.004); // Metres.
  // Along the view of its scenes the sheet is 2 to 5 mm thick, except at rim and lobe.
  size_t inside = 0, thin = 0;
  for (float x = -1.6f; x < 1.6f; x += 0.1f)
    for (float y = -2.9f; y < 2.9f; y += 0.1f) {
      float thickness = 0.0f;
      for (float z = -1.4f; z < 1.6f; z += 0.01f)
        if (ear_distance(glm::vec3(x, y, z)) < 0.0f) thickness += 0.01f;
      if (thickness == 0.0f) continue;
      ++inside;
      if (thickness > 0.2f && thickness < 0.5f) ++thin;
    }
  EXPECT_GT(static_cast<double>(thin) / static_cast<double>(inside), 0.6);
}

TEST(Shapes, FaceOutwardAndStartAtTheirBase) {
  for (const Mesh& mesh : {make_sphere(), make_plane(), make_box(), make_knot(), make_candle()}) {
    ASSERT_FALSE(mesh.indices.empty());
    EXPECT_GT(agreeing_triangles(mesh), 0.995);
    for (const Vertex& vertex : mesh.vertices)
      EXPECT_NEAR(glm::length(vertex.normal), 1.0f, 1e-3f);
  }
  EXPECT_NEAR(bounds_of(make_knot()).low.y, 0.0f, 1e-5f);
  EXPECT_NEAR(bounds_of(make_knot()).high.y, 0.12f, 1e-4f);
  EXPECT_NEAR(bounds_of(make_candle()).low.y, 0.0f, 1e-3f);
}

TEST(Mesh, TangentsFollowTheTexture) {
  Mesh mesh = make_plane();
  compute_tangents(mesh);
  for (const Vertex& vertex : mesh.vertices) {
    EXPECT_NEAR(vertex.tangent.x, 1.0f, 1e-6f); // u runs along x.
    const glm::vec3 across =
        glm::cross(vertex.normal, glm::vec3(vertex.tangent)) * vertex.tangent.w;
    EXPECT_LT(across.z, 0.0f); // v runs along z; the bitangent points against v, as in glTF.
  }
}

} // namespace
} // namespace demo
