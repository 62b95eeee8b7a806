#include "integration/examples/demo_engine/render/render_cache.hpp"

#include "integration/examples/demo_engine/model/load_model.hpp"
#include "integration/examples/demo_engine/scene/read_scene.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace demo {
namespace {

Result<Scene> read(const std::string& path, const std::vector<std::string>& roots) {
  dermis::Diagnostics diagnostics;
  auto scene = read_scene(path, diagnostics, roots);
  if (scene) return *scene;
  std::string text;
  for (const dermis::Diagnostic& one : diagnostics.list) {
    if (!text.empty()) text += '\n';
    text += dermis::format_for_people(diagnostics, one);
  }
  return Error{ErrorKind::input, text};
}

// Replaces the bust by the model in scenes that contain no model.
void put_in_place(Scene& scene) {
  const auto is = [](Shape shape) {
    return [shape](const Object& object) { return object.shape == shape; };
  };
  if (std::any_of(scene.objects.begin(), scene.objects.end(), is(Shape::model))) return;
  const auto bust = std::find_if(scene.objects.begin(), scene.objects.end(), is(Shape::bust));
  if (bust == scene.objects.end()) return;
  bust->shape = Shape::model;
  bust->pattern = Pattern::plain;
  bust->albedo = glm::dvec3(1.0); // the map contains the albedo
}

void move_camera(Scene& scene, const CameraPlace& place) {
  const auto point = [](const std::array<double, 3>& p) {
    return Curve<glm::dvec3>(glm::dvec3(p[0], p[1], p[2]));
  };
  scene.camera.orthographic = false;
  scene.camera.position = point(place.position);
  scene.camera.target = point(place.target);
  scene.camera.vertical_fov = Curve<double>(place.vertical_fov);
}

bool can_share_cache(const RenderOptions& a, const RenderOptions& b) {
  const auto of = [](const RenderOptions& o) {
    return std::tie(o.scene, o.model, o.roots, o.width, o.height, o.frames_per_second,
                    o.reversed_depth, o.jitter, o.taa, o.validation, o.device, o.kernels, o.camera,
                    o.zoom, o.pixel_aspect);
  };
  return of(a) == of(b);
}

} // namespace

Result<> load_scene_and_device(RenderCache& cache, const RenderOptions& options) {
  if (cache.made_for && can_share_cache(*cache.made_for, options)) return success();
  cache.kept = {};
  cache.renderer.reset();
  cache.made_for.reset();
  auto scene = read(options.scene, options.roots);
  if (!scene) return scene.error();
  if (options.camera) move_camera(*scene, *options.camera);
  scene->camera.zoom = options.zoom;
  if (options.pixel_aspect > 0) scene->camera.pixel_aspect = options.pixel_aspect;
  if (options.frames_per_second > 0) scene->frames_per_second = options.frames_per_second;
  cache.model = {};
  if (!options.model.mesh.empty()) {
    auto loaded = load_model(options.model, options.roots);
    if (!loaded) return loaded.error();
    cache.model = loaded.take();
    put_in_place(*scene);
  }
  cache.scene = std::make_unique<const Scene>(scene.take());
  HostOptions host_options;
  host_options.validation = options.validation;
  host_options.device = options.device;
  host_options.kernels = options.kernels;
  auto host = create_vulkan_host(host_options);
  if (!host) return host.error();
  cache.host = host.take();
  cache.slots = {}; // another device may have other slots
  cache.made_for = options;
  return success();
}

Result<> prepare_renderer(RenderCache& cache, const RenderOptions& options,
                          const std::array<VkImageUsageFlags, target_count>& usage) {
  bool fits = cache.renderer != nullptr;
  for (size_t i = 0; i < target_count; ++i)
    fits = fits && (usage[i] & ~cache.desc.more_usage[i]) == 0;
  if (fits) return success();
  cache.kept = {};
  cache.renderer.reset();
  cache.desc = {
      {options.width, options.height, options.reversed_depth, options.jitter || options.taa},
      usage};
  auto renderer = create_renderer(*cache.host, *cache.scene, cache.model, cache.desc);
  if (!renderer) return renderer.error();
  cache.renderer = renderer.take();
  return success();
}

void RenderCacheDeleter::operator()(RenderCache* cache) const {
  delete cache;
}

RenderCacheHandle make_render_cache() {
  return RenderCacheHandle(new RenderCache);
}

} // namespace demo
