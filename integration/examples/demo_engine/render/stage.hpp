#pragma once
// The stage of a rendering: device, scene, renderer and kept frames. Each part is rebuilt only if a
// call needs another.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/examples/demo_engine/render/dermis_host.hpp"
#include "integration/examples/demo_engine/render/kept_frames.hpp"

#include <memory>
#include <optional>

namespace demo {

// Members are destroyed from the last to the first.
struct Stage {
  std::optional<RenderOptions> made_for; // options for which scene, camera and device were made
  std::unique_ptr<VulkanHost> host;
  std::unique_ptr<const Scene> scene;
  Model model;
  RendererDesc desc;
  std::unique_ptr<Renderer> renderer;
  KeptFrames kept;
  KnownSlots slots;
};

// Loads scene and model and selects a device, unless the stage was made for equal options. Errors:
// input, usage, environment.
Result<> load_stage(Stage& stage, const RenderOptions& options);
// Makes the renderer, unless there is one whose targets have this usage. Errors: usage,
// environment.
Result<> prepare_stage(Stage& stage, const RenderOptions& options,
                       const std::array<VkImageUsageFlags, target_count>& usage);

} // namespace demo
