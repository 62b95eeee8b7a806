#include "integration/examples/demo_engine/scene/scene_state.hpp"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace demo {
namespace {

// Returns the view matrix of a camera or light at `from` that looks at `to`; upright unless the
// direction is vertical.
glm::dmat4 look(const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 along = to - from;
  const double length = glm::length(along);
  if (length < 1e-9) return glm::translate(glm::dmat4(1.0), -from);
  const bool steep = std::abs(along.y) > 0.999 * length;
  return glm::lookAt(from, to, steep ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0));
}

// Returns a projection. `extent` is the tangent of half the vertical angle (perspective) or half
// the height (orthographic).
glm::dmat4 project(bool orthographic, double extent, double aspect, double near, double far,
                   bool reversed) {
  glm::dmat4 m(0.0); // m[column][row]
  m[0][0] = 1.0 / (extent * aspect);
  m[1][1] = -1.0 / extent;
  const double range = reversed ? far - near : near - far;
  if (orthographic) {
    m[2][2] = 1.0 / range;
    m[3][2] = (reversed ? far : near) / range;
    m[3][3] = 1.0;
  } else {
    m[2][2] = (reversed ? near : far) / range;
    m[3][2] = near * far / range;
    m[2][3] = -1.0;
  }
  return m;
}

double halton(uint32_t index, uint32_t base) {
  double value = 0.0, digit = 1.0;
  for (; index > 0; index /= base) {
    digit /= base;
    value += digit * (index % base);
  }
  return value;
}

ViewState view_at(const Camera& camera, double seconds, uint32_t frame, const ViewDesc& desc) {
  ViewState view;
  view.view_from_world = look(value_at(camera.position, seconds), value_at(camera.target, seconds));
  const double aspect = camera.pixel_aspect * desc.width / desc.height;
  const double half = camera.orthographic
                          ? 0.5 * value_at(camera.height, seconds)
                          : std::tan(0.5 * glm::radians(value_at(camera.vertical_fov, seconds)));
  const double extent = half / camera.zoom;
  view.clip_from_view_steady = project(camera.orthographic, extent, aspect, camera.near_plane,
                                       camera.far_plane, desc.reversed_depth);
  view.clip_from_view = view.clip_from_view_steady;
  if (!desc.jitter) return view;
  constexpr uint32_t period = 8;
  view.jitter = {halton(frame % period + 1, 2) - 0.5, halton(frame % period + 1, 3) - 0.5};
  const glm::dvec2 shift = 2.0 * view.jitter / glm::dvec2(desc.width, desc.height);
  const int column = camera.orthographic ? 3 : 2;
  const double sign = camera.orthographic ? 1.0 : -1.0; // clip w is 1 or -z
  view.clip_from_view[column][0] += sign * shift.x;
  view.clip_from_view[column][1] += sign * shift.y;
  return view;
}

glm::dmat4 world_at(const Object& object, double seconds) {
  const glm::dvec3 turn = glm::radians(value_at(object.rotation, seconds));
  glm::dmat4 m = glm::translate(glm::dmat4(1.0), value_at(object.position, seconds));
  m = glm::rotate(m, turn.z, glm::dvec3(0, 0, 1));
  m = glm::rotate(m, turn.y, glm::dvec3(0, 1, 0));
  m = glm::rotate(m, turn.x, glm::dvec3(1, 0, 0));
  return glm::scale(m, object.scale);
}

void add_shadow_layers(const Light& light, double seconds, std::vector<glm::dmat4>& layers) {
  constexpr double nearest = 0.02, reach = 6.0; // metres
  const glm::dvec3 from = value_at(light.position, seconds), to = value_at(light.target, seconds);
  switch (light.type) {
  case LightType::directional: {
    const glm::dvec3 along = direction_of(light, seconds);
    const double depth = 8.0 * light.extent;
    layers.push_back(project(true, light.extent, 1.0, 0.0, depth, false) *
                     look(to - along * (0.5 * depth), to));
    break;
  }
  case LightType::spot: {
    const double extent = std::tan(0.5 * glm::radians(light.angle + 1.0));
    layers.push_back(project(false, extent, 1.0, nearest, glm::length(to - from) + reach, false) *
                     look(from, to));
    break;
  }
  case LightType::point: {
    // Slightly wider than a right angle, so that the filter finds texels at a face's edge.
    constexpr double extent = 1.0 + 6.0 / shadow_map_size;
    const glm::dmat4 lens = project(false, extent, 1.0, nearest, reach, false);
    for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(-1, 0, 0), glm::dvec3(0, 1, 0),
                                  glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)})
      layers.push_back(lens * look(from, from + axis));
    break;
  }
  }
}

} // namespace

glm::dvec3 direction_of(const Light& light, double seconds) {
  const glm::dvec3 along = value_at(light.target, seconds) - value_at(light.position, seconds);
  return glm::length(along) > 0.0 ? glm::normalize(along) : glm::dvec3(0, 0, -1);
}

uint32_t shadow_layers_of(const Light& light) {
  if (!light.shadow) return 0;
  return light.type == LightType::point ? 6 : 1;
}

SceneState state_at(const Scene& scene, uint32_t frame, const ViewDesc& desc) {
  SceneState state;
  state.seconds = frame / scene.frames_per_second;
  for (const double cut : scene.cuts)
    state.cut |= frame > 0 && cut > (frame - 1) / scene.frames_per_second && cut <= state.seconds;
  const uint32_t before = frame == 0 || state.cut ? frame : frame - 1;
  const double previous_seconds = before / scene.frames_per_second;
  state.now = view_at(scene.camera, state.seconds, frame, desc);
  state.previous = view_at(scene.camera, previous_seconds, before, desc);
  for (const Object& object : scene.objects) {
    state.world.push_back(world_at(object, state.seconds));
    state.previous_world.push_back(world_at(object, previous_seconds));
  }
  for (const Light& light : scene.lights) {
    const bool fits = state.shadow_from_world.size() + shadow_layers_of(light) <= max_shadow_layers;
    state.first_layer.push_back(
        light.shadow && fits ? static_cast<uint32_t>(state.shadow_from_world.size()) : no_layer);
    if (light.shadow && fits) add_shadow_layers(light, state.seconds, state.shadow_from_world);
  }
  return state;
}

double view_depth(const glm::dmat4& m, double depth) {
  // Solves depth = (m22 z + m23) / (m32 z + m33) for z; view space looks along -z.
  const double z = (m[3][2] - depth * m[3][3]) / (depth * m[2][3] - m[2][2]);
  return -z;
}

} // namespace demo
