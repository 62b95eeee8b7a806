#pragma once
// Triangles as the renderer wants them, whatever they come from.

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace demo {

// Object space, metres; counter-clockwise seen from outside.
struct Vertex {
  glm::vec3 position{0.0f};
  glm::vec3 normal{0.0f, 1.0f, 0.0f};        // unit
  glm::vec2 uv{0.0f};                        // v down, as images are stored
  glm::vec4 tangent{1.0f, 0.0f, 0.0f, 1.0f}; // unit, along u; w * cross(normal, tangent) is against v
  glm::vec3 tint{1.0f};                      // multiplies the albedo (linear)
  float openness = 1.0f;                     // share of the ambient light that arrives, 0..1
  float gloss = 1.0f;                        // multiplies the reflectance
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<uint32_t> indices; // three a triangle
};

struct Bounds {
  glm::vec3 low{0.0f}, high{0.0f};
};

// Of all vertices; zero for an empty mesh.
Bounds bounds_of(const Mesh& mesh);
// Area- and angle-free average of face normals, for meshes that come without. Any thread.
void compute_normals(Mesh& mesh);
// Per-vertex tangents from uv gradients (Lengyel 2001, orthonormalised). Any thread.
void compute_tangents(Mesh& mesh);

} // namespace demo
