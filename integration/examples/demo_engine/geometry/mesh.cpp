#include "integration/examples/demo_engine/geometry/mesh.hpp"

#include <cmath>

namespace demo {
namespace {

glm::vec3 any_perpendicular(const glm::vec3& n) {
  const glm::vec3 other = std::abs(n.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  return glm::normalize(glm::cross(other, n));
}

} // namespace

Bounds bounds_of(const Mesh& mesh) {
  if (mesh.vertices.empty()) return {};
  Bounds bounds{mesh.vertices[0].position, mesh.vertices[0].position};
  for (const Vertex& vertex : mesh.vertices) {
    bounds.low = glm::min(bounds.low, vertex.position);
    bounds.high = glm::max(bounds.high, vertex.position);
  }
  return bounds;
}

void compute_normals(Mesh& mesh) {
  for (Vertex& vertex : mesh.vertices)
    vertex.normal = glm::vec3(0.0f);
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    Vertex& a = mesh.vertices[mesh.indices[i]];
    Vertex& b = mesh.vertices[mesh.indices[i + 1]];
    Vertex& c = mesh.vertices[mesh.indices[i + 2]];
    const glm::vec3 normal = glm::cross(b.position - a.position, c.position - a.position);
    a.normal += normal;
    b.normal += normal;
    c.normal += normal;
  }
  for (Vertex& vertex : mesh.vertices) {
    const float length = glm::length(vertex.normal);
    vertex.normal = length > 0.0f ? vertex.normal / length : glm::vec3(0, 1, 0);
  }
}

void compute_tangents(Mesh& mesh) {
  std::vector<glm::vec3> along_u(mesh.vertices.size(), glm::vec3(0.0f)), along_v = along_u;
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const uint32_t at[3] = {mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]};
    const Vertex &a = mesh.vertices[at[0]], &b = mesh.vertices[at[1]], &c = mesh.vertices[at[2]];
    const glm::vec3 e1 = b.position - a.position, e2 = c.position - a.position;
    const glm::vec2 d1 = b.uv - a.uv, d2 = c.uv - a.uv;
    const float area = d1.x * d2.y - d2.x * d1.y;
    if (area == 0.0f || !std::isfinite(area)) continue;
    const glm::vec3 u = (e1 * d2.y - e2 * d1.y) / area, v = (e2 * d1.x - e1 * d2.x) / area;
    for (const uint32_t k : at) {
      along_u[k] += u;
      along_v[k] += v;
    }
  }
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    Vertex& vertex = mesh.vertices[i];
    const glm::vec3 flat = along_u[i] - vertex.normal * glm::dot(vertex.normal, along_u[i]);
    const float length = glm::length(flat);
    const glm::vec3 tangent =
        length > 0.0f && std::isfinite(length) ? flat / length : any_perpendicular(vertex.normal);
    const float sign =
        glm::dot(glm::cross(vertex.normal, tangent), along_v[i]) > 0.0f ? -1.0f : 1.0f;
    vertex.tangent = glm::vec4(tangent, sign);
  }
}

} // namespace demo
