#pragma once
// A small scene of triangles in fp64 for restir::Scene: a sphere and a slab of one medium, a thin
// bent sheet like an ear of another medium, a point light behind the sheet and a rectangular light
// above.

#include "tests/passes/restir/cpu/scene.hpp"

#include <vector>

namespace dermis::restir::testing {

// Ids begin above the integers that floats hold exactly, so that an id that passes through a float
// fails the tests.
inline constexpr uint32_t first_instance = (1u << 24) + 1;

struct Triangle {
  Vector3 corner{}, edge_1{}, edge_2{}, normal{};
  double area = 0;
  uint32_t instance = 0, primitive = 0, medium = 0;
};

// A box around triangles [first, first + count), or around the two nodes from `first` on if count
// is 0.
struct BoxNode {
  Vector3 low{}, high{};
  uint32_t first = 0, count = 0;
};

struct TriangleScene {
  std::vector<Triangle> triangles;         // In the order of the boxes.
  std::vector<std::vector<uint32_t>> rows; // By instance and primitive: index into `triangles`.
  std::vector<BoxNode> boxes;
  std::vector<Light> lights;
  std::vector<Vector3> d; // By medium.

  Scene access() const;
};

// Adds an instance; corners come in threes, counterclockwise from outside.
void add_instance(TriangleScene& scene, uint32_t medium, const std::vector<Vector3>& corners);
// Called after the last instance and light.
void finish(TriangleScene& scene);

struct Hit {
  uint32_t triangle = 0; // Index into `triangles`.
  double distance = 0;
  Barycentrics barycentrics{};
};
// Finds the nearest hit from `origin` in (0, maximum); returns false if none exists.
bool nearest_hit(const TriangleScene& scene, const Vector3& origin, const Vector3& direction,
                 double maximum, Hit& hit);

TriangleScene ear_scene();

// Returns the pixels of a camera with width x height pixels over [-4, 4]^2 that looks along -z,
// `shift` pixels to the right. Medium 0 means no surface.
struct Pixel {
  Domain domain;
  uint32_t instance = 0; // Counts from 0.
  bool lit = false;      // Whether the pixel faces the middle of a light without occlusion.
};
std::vector<Pixel> look_at(const TriangleScene& scene, uint32_t width, uint32_t height,
                           double shift = 0);
double pixel_footprint(uint32_t width);

} // namespace dermis::restir::testing
