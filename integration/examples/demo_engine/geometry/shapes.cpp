#include "integration/examples/demo_engine/geometry/shapes.hpp"

#include <cmath>
#include <functional>

namespace demo {
namespace {

constexpr float tau = 6.28318530717958648f;

// Returns a grid of (columns + 1) x (rows + 1) points place(u, v), u and v in [0, 1], with normals
// from neighbouring points.
Mesh sweep(uint32_t columns, uint32_t rows, const std::function<glm::vec3(float, float)>& place) {
  Mesh mesh;
  constexpr float step = 1e-3f;
  for (uint32_t r = 0; r <= rows; ++r) {
    for (uint32_t c = 0; c <= columns; ++c) {
      const float u = static_cast<float>(c) / static_cast<float>(columns);
      const float v = static_cast<float>(r) / static_cast<float>(rows);
      Vertex vertex;
      vertex.position = place(u, v);
      vertex.uv = {u, v};
      // At a row that shrinks to a point, the normal is taken slightly further inside.
      const float w = std::clamp(v, 2.0f * step, 1.0f - 2.0f * step);
      const glm::vec3 du = place(u + step, w) - place(u - step, w);
      const glm::vec3 normal = glm::cross(du, place(u, w + step) - place(u, w - step));
      const float length = glm::length(normal);
      if (length > 0.0f) vertex.normal = normal / length;
      const float along = glm::length(du);
      if (along > 0.0f) vertex.tangent = glm::vec4(du / along, 1.0f);
      mesh.vertices.push_back(vertex);
    }
  }
  for (uint32_t r = 0; r < rows; ++r) {
    for (uint32_t c = 0; c < columns; ++c) {
      const uint32_t a = r * (columns + 1) + c, b = a + 1, d = a + columns + 1, e = d + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, e, a, e, d});
    }
  }
  return mesh;
}

glm::vec3 trefoil(float u) {
  const float t = tau * u;
  return {std::sin(t) + 2.0f * std::sin(2.0f * t), std::cos(t) - 2.0f * std::cos(2.0f * t),
          -std::sin(3.0f * t) * 0.9f};
}

} // namespace

Mesh make_sphere() {
  Mesh mesh = sweep(96, 48, [](float u, float v) {
    const float polar = (1.0f - v) * tau * 0.5f, around = -tau * u;
    return glm::vec3(std::sin(polar) * std::cos(around), std::cos(polar),
                     std::sin(polar) * std::sin(around));
  });
  for (Vertex& vertex : mesh.vertices)
    vertex.normal = glm::normalize(vertex.position);
  return mesh;
}

Mesh make_plane() {
  Mesh mesh;
  for (const glm::vec2 corner :
       {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
    Vertex vertex;
    vertex.position = {corner.x, 0.0f, corner.y};
    vertex.uv = corner * 0.5f + 0.5f;
    mesh.vertices.push_back(vertex);
  }
  mesh.indices = {0, 2, 1, 0, 3, 2};
  return mesh;
}

Mesh make_box() {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      glm::vec3 normal(0.0f), u(0.0f);
      normal[axis] = side;
      u[(axis + 1) % 3] = 1.0f;
      const glm::vec3 v = glm::cross(normal, u);
      const auto first = static_cast<uint32_t>(mesh.vertices.size());
      for (const glm::vec2 corner :
           {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
        Vertex vertex;
        vertex.position = normal + u * corner.x + v * corner.y;
        vertex.normal = normal;
        vertex.tangent = glm::vec4(u, 1.0f);
        vertex.uv = corner * 0.5f + 0.5f;
        mesh.vertices.push_back(vertex);
      }
      mesh.indices.insert(mesh.indices.end(),
                          {first, first + 1, first + 2, first, first + 2, first + 3});
    }
  }
  return mesh;
}

Mesh make_knot() {
  // Radii in units of the knot, whose curve reaches 3 from its middle; scaled to 0.12 m at the end.
  constexpr float tube = 0.62f, flute = 0.075f, flutes = 5.0f, turns = 3.0f;
  Mesh mesh = sweep(420, 40, [](float u, float v) {
    const glm::vec3 at = trefoil(u);
    const glm::vec3 along = glm::normalize(trefoil(u + 1e-3f) - trefoil(u - 1e-3f));
    const glm::vec3 side = glm::normalize(glm::cross(along, glm::vec3(0, 0, 1)));
    const glm::vec3 front = glm::cross(side, along);
    const float angle = tau * v;
    const float radius = tube + flute * std::cos(flutes * angle + turns * flutes * tau * u);
    return at + (side * std::cos(angle) + front * std::sin(angle)) * radius;
  });
  const Bounds bounds = bounds_of(mesh);
  const float scale = 0.12f / (bounds.high.y - bounds.low.y);
  for (Vertex& vertex : mesh.vertices) {
    vertex.position = (vertex.position - glm::vec3(0.0f, bounds.low.y, 0.0f)) * scale;
    // Parts at the back see less of the sky.
    const float depth = vertex.position.z / (scale * 1.5f);
    vertex.openness = 0.8f + 0.2f * std::tanh(depth);
  }
  return mesh;
}

Mesh make_candle() {
  // Outline from the foot up the outside, over the rim, down into the hollow: radius and height in
  // metres.
  constexpr glm::vec2 outline[] = {{0.0f, 0.0f},       {0.030f, 0.0f},     {0.032f, 0.002f},
                                   {0.032f, 0.03f},    {0.0315f, 0.07f},   {0.0312f, 0.105f},
                                   {0.0308f, 0.124f},  {0.0298f, 0.1295f}, {0.0282f, 0.1300f},
                                   {0.0268f, 0.127f},  {0.0250f, 0.117f},  {0.0215f, 0.107f},
                                   {0.0150f, 0.1020f}, {0.0070f, 0.1005f}, {0.0f, 0.1000f}};
  constexpr uint32_t count = sizeof(outline) / sizeof(outline[0]);
  Mesh mesh = sweep(128, (count - 1) * 8, [&](float u, float v) {
    // Catmull-Rom spline through the outline.
    const float s = v * static_cast<float>(count - 1);
    const auto k = std::min(static_cast<uint32_t>(s), count - 2);
    const float t = s - static_cast<float>(k);
    const glm::vec2 a = outline[k == 0 ? 0 : k - 1], b = outline[k], c = outline[k + 1];
    const glm::vec2 d = outline[std::min(k + 2, count - 1)];
    glm::vec2 point =
        0.5f * (2.0f * b + (c - a) * t + (2.0f * a - 5.0f * b + 4.0f * c - d) * t * t +
                (3.0f * b - a - 3.0f * c + d) * t * t * t);
    point.x = std::max(point.x, 0.0f);
    const float angle = -tau * u;
    // Wax that has run down on two sides, and an uneven rim.
    const bool outside = v < 8.0f / static_cast<float>(count - 1);
    const auto run = [&](float where, float width, float low) {
      const float across = std::remainder(angle - where, tau) / width;
      const float height =
          outside ? std::exp(-std::pow(std::max(0.0f, (low - point.y) / 0.008f), 2.0f)) : 0.0f;
      return std::exp(-across * across) * height * (point.y > 0.001f ? 1.0f : 0.0f);
    };
    const float bulge = 0.0030f * run(-1.25f, 0.16f, 0.055f) + 0.0024f * run(-2.2f, 0.12f, 0.085f) +
                        0.0027f * run(2.4f, 0.17f, 0.04f);
    const float tilt = 0.004f * std::cos(angle + 0.9f) * std::max(0.0f, point.y - 0.1f) / 0.03f;
    const float radius = point.x + bulge;
    return glm::vec3(radius * std::cos(angle), point.y + tilt, radius * std::sin(angle));
  });
  for (Vertex& vertex : mesh.vertices) {
    const float inside = glm::length(glm::vec2(vertex.position.x, vertex.position.z)) / 0.028f;
    if (vertex.position.y > 0.098f && inside < 1.0f)
      vertex.openness = 0.35f + 0.65f * std::min(1.0f, (vertex.position.y - 0.098f) / 0.032f);
  }
  return mesh;
}

} // namespace demo
