#pragma once
// What frames are rendered on: made bit by bit, and anew where another call wants another.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/examples/demo_engine/render/dermis_host.hpp"
#include "integration/examples/demo_engine/render/kept_frames.hpp"

#include <memory>
#include <optional>

namespace demo {

// Members die from the last to the first.
struct Stage {
  std::optional<RenderOptions> made_for; // what of them is the scene's, the camera's and the device's
  std::unique_ptr<VulkanHost> host;
  std::unique_ptr<const Scene> scene;
  Model model;
  RendererDesc desc;
  std::unique_ptr<Renderer> renderer;
  KeptFrames kept;
  KnownSlots slots;
};

// Loads scene and model and finds a device, unless the stage was made for the same ones. Errors: input,
// usage, environment.
Result<> load_stage(Stage& stage, const RenderOptions& options);
// Makes the renderer, unless there is one whose targets have this usage. Errors: usage, environment.
Result<> furnish_stage(Stage& stage, const RenderOptions& options,
                       const std::array<VkImageUsageFlags, target_count>& usage);

} // namespace demo
