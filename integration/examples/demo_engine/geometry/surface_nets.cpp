#include "integration/examples/demo_engine/geometry/surface_nets.hpp"

#include <array>
#include <atomic>
#include <thread>

namespace demo {
namespace {

constexpr uint32_t block = 8; // side in cells of a block that is skipped or sampled as a whole
constexpr uint32_t worker_count = 2;
constexpr float slack = 1.6f; // maximum ratio of the field to the true distance
constexpr uint32_t no_vertex = UINT32_MAX;

struct Grid {
  const GridPlanes& planes;
  uint32_t nx, ny, nz; // number of planes
  std::vector<float> value;

  size_t at(uint32_t x, uint32_t y, uint32_t z) const { return (size_t{z} * ny + y) * nx + x; }
  glm::vec3 position(uint32_t x, uint32_t y, uint32_t z) const {
    return {planes.x[x], planes.y[y], planes.z[z]};
  }
};

// Calls work(i) for all i below count on `worker_count` threads.
void in_parallel(uint32_t count, const std::function<void(uint32_t)>& work) {
  std::atomic<uint32_t> next = 0;
  const auto run = [&] {
    for (uint32_t i = next++; i < count; i = next++)
      work(i);
  };
  std::vector<std::thread> threads;
  for (uint32_t t = 1; t < worker_count; ++t)
    threads.emplace_back(run);
  run();
  for (std::thread& thread : threads)
    thread.join();
}

// Samples the corners of one layer of blocks. Far blocks receive only the sign of their centre.
void sample_layer(Grid& grid, const Field& field, uint32_t layer) {
  const uint32_t z0 = layer * block, z1 = std::min(z0 + block, grid.nz);
  for (uint32_t y0 = 0; y0 < grid.ny; y0 += block) {
    for (uint32_t x0 = 0; x0 < grid.nx; x0 += block) {
      const uint32_t y1 = std::min(y0 + block, grid.ny), x1 = std::min(x0 + block, grid.nx);
      const glm::vec3 low = grid.position(x0, y0, z0);
      const glm::vec3 high = grid.position(std::min(x1, grid.nx - 1), std::min(y1, grid.ny - 1),
                                           std::min(z1, grid.nz - 1));
      const float center = field((low + high) * 0.5f);
      const bool far = std::abs(center) > slack * 0.5f * glm::length(high - low);
      for (uint32_t z = z0; z < z1; ++z)
        for (uint32_t y = y0; y < y1; ++y)
          for (uint32_t x = x0; x < x1; ++x)
            grid.value[grid.at(x, y, z)] = far ? center : field(grid.position(x, y, z));
    }
  }
}

// Returns the mean of the points where the cell's edges cross the surface.
glm::vec3 crossing_mean(const Grid& grid, uint32_t x, uint32_t y, uint32_t z) {
  glm::vec3 sum(0.0f);
  float count = 0.0f;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    for (uint32_t corner = 0; corner < 8; ++corner) {
      if ((corner >> axis) & 1u) continue;
      const uint32_t other = corner | (1u << axis);
      const auto value = [&](uint32_t c) {
        return grid.value[grid.at(x + (c & 1u), y + ((c >> 1) & 1u), z + (c >> 2))];
      };
      const auto place = [&](uint32_t c) {
        return grid.position(x + (c & 1u), y + ((c >> 1) & 1u), z + (c >> 2));
      };
      const float a = value(corner), b = value(other);
      if ((a < 0.0f) == (b < 0.0f)) continue;
      sum += glm::mix(place(corner), place(other), a / (a - b));
      count += 1.0f;
    }
  }
  return sum / count;
}

bool cell_is_crossed(const Grid& grid, uint32_t x, uint32_t y, uint32_t z) {
  const bool inside = grid.value[grid.at(x, y, z)] < 0.0f;
  for (uint32_t c = 1; c < 8; ++c)
    if ((grid.value[grid.at(x + (c & 1u), y + ((c >> 1) & 1u), z + (c >> 2))] < 0.0f) != inside)
      return true;
  return false;
}

void add_quad(Mesh& mesh, const std::array<uint32_t, 4>& corner, bool flip) {
  const auto length2 = [&](uint32_t a, uint32_t b) {
    const glm::vec3 d = mesh.vertices[a].position - mesh.vertices[b].position;
    return glm::dot(d, d);
  };
  std::array<uint32_t, 4> q = corner;
  if (flip) std::swap(q[1], q[3]);
  if (length2(q[0], q[2]) <= length2(q[1], q[3]))
    mesh.indices.insert(mesh.indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
  else
    mesh.indices.insert(mesh.indices.end(), {q[1], q[2], q[3], q[1], q[3], q[0]});
}

glm::vec3 gradient(const Field& field, const glm::vec3& p, float step) {
  const glm::vec3 dx(step, 0, 0), dy(0, step, 0), dz(0, 0, step);
  return glm::vec3(field(p + dx) - field(p - dx), field(p + dy) - field(p - dy),
                   field(p + dz) - field(p - dz)) /
         (2.0f * step);
}

// Returns the ambient openness of a distance field from a few steps along the normal (Evans 2006;
// weights after Quilez).
float openness_at(const Field& field, const glm::vec3& p, const glm::vec3& normal, float reach) {
  float hidden = 0.0f, weight = 1.0f, sum = 0.0f;
  constexpr int steps = 5;
  for (int i = 1; i <= steps; ++i) {
    const float distance = reach * static_cast<float>(i * i) / (steps * steps);
    hidden += weight * std::clamp(1.0f - field(p + normal * distance) / distance, 0.0f, 1.0f);
    sum += weight;
    weight *= 0.8f;
  }
  return 1.0f - hidden / sum;
}

} // namespace

std::vector<float> place_planes(float low, float high, const std::function<float(float)>& spacing) {
  std::vector<float> planes = {low};
  while (planes.back() < high)
    planes.push_back(planes.back() + spacing(planes.back()));
  return planes;
}

Mesh mesh_field(const Field& field, const GridPlanes& planes, float occlusion_reach) {
  Grid grid{planes,
            static_cast<uint32_t>(planes.x.size()),
            static_cast<uint32_t>(planes.y.size()),
            static_cast<uint32_t>(planes.z.size()),
            {}};
  grid.value.resize(size_t{grid.nx} * grid.ny * grid.nz);
  in_parallel((grid.nz + block - 1) / block,
              [&](uint32_t layer) { sample_layer(grid, field, layer); });

  Mesh mesh;
  std::vector<uint32_t> vertex_of(grid.value.size(), no_vertex);
  std::vector<float> reach; // maximum distance that a vertex may move from the crossing
  for (uint32_t z = 0; z + 1 < grid.nz; ++z)
    for (uint32_t y = 0; y + 1 < grid.ny; ++y)
      for (uint32_t x = 0; x + 1 < grid.nx; ++x) {
        if (!cell_is_crossed(grid, x, y, z)) continue;
        vertex_of[grid.at(x, y, z)] = static_cast<uint32_t>(mesh.vertices.size());
        Vertex vertex;
        vertex.position = crossing_mean(grid, x, y, z);
        mesh.vertices.push_back(vertex);
        const glm::vec3 size = grid.position(x + 1, y + 1, z + 1) - grid.position(x, y, z);
        reach.push_back(std::min({size.x, size.y, size.z}));
      }

  // Adds a quad around each grid edge that crosses the surface, from the four cells that share the
  // edge.
  for (uint32_t z = 0; z + 1 < grid.nz; ++z)
    for (uint32_t y = 0; y + 1 < grid.ny; ++y)
      for (uint32_t x = 0; x + 1 < grid.nx; ++x) {
        const bool inside = grid.value[grid.at(x, y, z)] < 0.0f;
        const auto cell = [&](uint32_t cx, uint32_t cy, uint32_t cz) {
          return vertex_of[grid.at(cx, cy, cz)];
        };
        if (y > 0 && z > 0 && inside != (grid.value[grid.at(x + 1, y, z)] < 0.0f))
          add_quad(mesh,
                   {cell(x, y - 1, z - 1), cell(x, y, z - 1), cell(x, y, z), cell(x, y - 1, z)},
                   !inside);
        if (x > 0 && z > 0 && inside != (grid.value[grid.at(x, y + 1, z)] < 0.0f))
          add_quad(mesh,
                   {cell(x - 1, y, z - 1), cell(x - 1, y, z), cell(x, y, z), cell(x, y, z - 1)},
                   !inside);
        if (x > 0 && y > 0 && inside != (grid.value[grid.at(x, y, z + 1)] < 0.0f))
          add_quad(mesh,
                   {cell(x - 1, y - 1, z), cell(x, y - 1, z), cell(x, y, z), cell(x - 1, y, z)},
                   !inside);
      }

  constexpr uint32_t batch = 1024;
  const auto count = static_cast<uint32_t>(mesh.vertices.size());
  in_parallel((count + batch - 1) / batch, [&](uint32_t index) {
    for (uint32_t i = index * batch; i < std::min(count, (index + 1) * batch); ++i) {
      Vertex& vertex = mesh.vertices[i];
      const float step = 0.15f * reach[i];
      glm::vec3 slope = gradient(field, vertex.position, step);
      for (int iteration = 0; iteration < 2; ++iteration) {
        const float length2 = std::max(glm::dot(slope, slope), 1e-6f);
        const glm::vec3 move = -slope * (field(vertex.position) / length2);
        const float length = glm::length(move);
        vertex.position += length > 0.5f * reach[i] ? move * (0.5f * reach[i] / length) : move;
        slope = gradient(field, vertex.position, step);
      }
      const float length = glm::length(slope);
      if (length > 0.0f) vertex.normal = slope / length;
      vertex.openness = openness_at(field, vertex.position, vertex.normal, occlusion_reach);
    }
  });
  return mesh;
}

} // namespace demo
