#pragma once
// A small scene of triangles in fp64, as restir::Scene asks of one: a sphere and a slab of one medium, a thin
// bent sheet like an ear of another, under a point light behind the sheet and a rectangle above.

#include "tests/passes/restir/cpu/scene.hpp"

#include <vector>

namespace dermis::restir::testing {

// Ids begin above what a float holds exactly, so that an id that goes through one breaks every law.
inline constexpr uint32_t first_instance = (1u << 24) + 1;

struct Triangle {
  Vector3 corner{}, edge_1{}, edge_2{}, normal{};
  double area = 0;
  uint32_t instance = 0, primitive = 0, medium = 0;
};

// A box around triangles [first, first + count), or around the two nodes from `first` on where count is 0.
struct BoxNode {
  Vector3 low{}, high{};
  uint32_t first = 0, count = 0;
};

struct TriangleScene {
  std::vector<Triangle> triangles;         // in the order of the boxes
  std::vector<std::vector<uint32_t>> rows; // of instance and primitive: index into triangles
  std::vector<BoxNode> boxes;
  std::vector<Light> lights;
  std::vector<Vector3> d; // by medium

  Scene access() const;
};

// The next instance: corners in threes, counted against the clock from outside.
void add_instance(TriangleScene& scene, uint32_t medium, const std::vector<Vector3>& corners);
// After the last instance and light.
void finish(TriangleScene& scene);

struct Hit {
  uint32_t triangle = 0; // index
  double distance = 0;
  Barycentrics barycentrics{};
};
// The nearest from `origin` in (0, most); false for none.
bool nearest_hit(const TriangleScene& scene, const Vector3& origin, const Vector3& direction, double maximum,
                 Hit& hit);

TriangleScene ear_scene();

// A camera of width x height pixels over [-4, 4]^2 that looks along -z, `shift` pixels to the right. Medium
// 0: nothing is there.
struct Pixel {
  Domain domain;
  uint32_t instance = 0; // from 0
  bool lit = false;      // faces a light's middle, with nothing between
};
std::vector<Pixel> look_at(const TriangleScene& scene, uint32_t width, uint32_t height, double shift = 0);
double pixel_footprint(uint32_t width);

} // namespace dermis::restir::testing
