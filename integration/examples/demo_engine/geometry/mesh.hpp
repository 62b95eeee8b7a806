#pragma once
// Triangle meshes in the renderer's format.

#include <glm/glm.hpp>

#include <cstdint>
#include <vector>

namespace demo {

// A vertex in object space, metres. Triangles are counter-clockwise seen from outside.
struct Vertex {
  glm::vec3 position{0.0f};
  glm::vec3 normal{0.0f, 1.0f, 0.0f}; // unit length
  glm::vec2 uv{0.0f};                 // v down, as images are stored
  // Unit vector along u; w * cross(normal, tangent) points against v.
  glm::vec4 tangent{1.0f, 0.0f, 0.0f, 1.0f};
  glm::vec3 tint{1.0f};  // factor on the albedo (linear)
  float openness = 1.0f; // fraction of the ambient light that reaches the vertex, 0..1
  float gloss = 1.0f;    // factor on the reflectance
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<uint32_t> indices; // three per triangle
};

struct Bounds {
  glm::vec3 low{0.0f}, high{0.0f};
};

// Returns the bounds of all vertices; zero for an empty mesh.
Bounds bounds_of(const Mesh& mesh);
// Sets each vertex normal to the normalised unweighted sum of the normals of its faces. For meshes
// without normals.
void compute_normals(Mesh& mesh);
// Computes per-vertex tangents from uv gradients (Lengyel 2001, orthonormalised). Thread: any.
void compute_tangents(Mesh& mesh);

} // namespace demo
