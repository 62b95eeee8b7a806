#include "integration/examples/demo_engine/geometry/ear.hpp"

#include "integration/examples/demo_engine/geometry/surface_nets.hpp"

namespace demo {
namespace {

using glm::vec2;
using glm::vec3;

// All numbers below are in centimetres, chosen by eye.

float bump(const vec2& p, const vec2& center, const vec2& radii) {
  const vec2 q = (p - center) / radii;
  return std::exp(-glm::dot(q, q));
}

// Returns the height of the sheet's middle: bent as a whole, hollow at the ear canal, with the fold
// along the inside of the rim.
float bend(const vec2& p) {
  const float whole = 0.07f * p.x * p.x + 0.02f * p.y * p.y - 0.10f * p.x;
  const float hollow = 0.60f * bump(p, vec2(0.45f, -0.35f), vec2(0.80f, 1.05f));
  const float around = glm::length((p - vec2(0.35f, 0.15f)) / vec2(1.0f, 1.45f)) - 1.05f;
  const float fold = 0.26f * std::exp(-around * around / 0.045f) * smooth_step(1.1f, 0.2f, p.x) *
                     smooth_step(-1.9f, -1.0f, p.y);
  return whole - hollow + fold;
}

// Returns the distance to the egg-shaped outline, which is wider above; negative inside.
float outline(const vec2& p) {
  return 1.8f * (glm::length(p / vec2(1.75f + 0.10f * p.y, 3.05f)) - 1.0f);
}

} // namespace

float ear_distance(const vec3& q) {
  const vec2 p(q.x, q.y);
  // 0.75: the sheet is steep in places
  const float edge = outline(p), above = 0.75f * (q.z - bend(p));
  const float half = 0.13f + 0.11f * smooth_step(-1.7f, -2.5f, q.y); // the lobe is thicker
  float d = soft_intersection(std::abs(above) - half, edge, 0.12f);
  // The rim rolls outwards. It ends in the hollow in front and at the lobe below.
  const float rim = glm::length(vec2(edge + 0.16f, above - 0.14f)) - 0.24f;
  const float open =
      smooth_step(0.5f, 1.2f, q.x) * smooth_step(1.2f, 0.2f, q.y) + smooth_step(-1.6f, -2.2f, q.y);
  d = soft_union(d, rim + 0.5f * std::min(open, 1.0f), 0.12f);
  // tragus
  return soft_union(d, ellipsoid(q, vec3(1.35f, -0.55f, 0.25f), vec3(0.32f, 0.52f, 0.20f)), 0.25f);
}

Mesh make_ear(float spacing) {
  constexpr float occlusion_reach = 0.6f;
  const auto even = [&](float distance) { return [=](float) { return spacing * distance; }; };
  GridPlanes planes;
  planes.x = place_planes(-2.5f, 2.5f, even(0.055f));
  planes.y = place_planes(-3.6f, 3.6f, even(0.055f));
  planes.z = place_planes(-1.4f, 1.6f, even(0.055f));
  Mesh mesh = mesh_field(ear_distance, planes, occlusion_reach);
  for (Vertex& vertex : mesh.vertices)
    vertex.position *= 0.01f;
  return mesh;
}

} // namespace demo
