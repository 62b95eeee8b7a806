#pragma once
// Keeps device, scene, renderer and rendered inputs between calls of render(). Rebuilds a part only
// if a call needs another one.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/examples/demo_engine/render/dermis_host.hpp"
#include "integration/examples/demo_engine/render/kept_frames.hpp"

#include <memory>
#include <optional>

namespace demo {

// Members are destroyed from the last to the first.
struct RenderCache {
  std::optional<RenderOptions> made_for; // options for which scene, camera and device were made
  std::unique_ptr<VulkanHost> host;
  std::unique_ptr<const Scene> scene;
  Model model;
  RendererDesc desc;
  std::unique_ptr<Renderer> renderer;
  KeptFrames kept;
  KnownSlots slots;
};

// Loads scene and model and selects a device, unless the cache was made for equal options. Errors:
// input, usage, environment.
Result<> load_scene_and_device(RenderCache& cache, const RenderOptions& options);
// Makes the renderer, unless there is one whose targets have this usage. Errors: usage,
// environment.
Result<> prepare_renderer(RenderCache& cache, const RenderOptions& options,
                          const std::array<VkImageUsageFlags, target_count>& usage);

} // namespace demo
