#include "integration/examples/demo_engine/render/ray_placing.hpp"

namespace demo {
namespace {

constexpr float sun_distance = 1000.0f; // length in metres of shadow rays of directional lights

RayLight ray_light(const Light& light, double seconds) {
  RayLight out;
  const glm::dvec3 position = value_at(light.position, seconds);
  out.emission = glm::vec3(light.color * value_at(light.intensity, seconds));
  if (light.type == LightType::directional) {
    out.type = 3;
    out.position = glm::vec3(-direction_of(light, seconds));
    out.area = sun_distance;
  } else {
    out.position = glm::vec3(position);
  }
  return out;
}

} // namespace

Result<> place_rays(Renderer& renderer, const SceneState& state) {
  if (!renderer.rays) {
    auto made = create_ray_scene(*renderer.host, renderer.gpu.shapes);
    if (!made) return made.error();
    renderer.rays = std::make_unique<RayScene>(made.take());
  }
  std::vector<RayInstance> instances;
  for (size_t i = 0; i < renderer.scene->objects.size(); ++i) {
    const Object& object = renderer.scene->objects[i];
    // Rays only look for subsurface and for what casts shadows.
    if (object.casts_shadow || object.profile != 0)
      instances.push_back({renderer.gpu.mesh_of[i], object.profile, state.world[i]});
  }
  if (instances.empty()) // a structure has at least one instance
    instances.push_back({renderer.gpu.mesh_of.front(), 0, state.world.front()});
  std::vector<RayLight> lights;
  for (const Light& light : renderer.scene->lights)
    lights.push_back(ray_light(light, state.seconds));
  return place_rays(*renderer.host, *renderer.rays, instances, lights);
}

} // namespace demo
