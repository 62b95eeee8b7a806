#pragma once
// Results of the scene's passes, kept on the device by frame.

#include "integration/examples/demo_engine/render/renderer.hpp"

#include <cstdint>
#include <map>

namespace demo {

// Must be destroyed before the host of its buffers.
struct KeptFrames {
  std::map<uint32_t, Buffer> frames; // by frame number
  uint64_t bytes = 0;                // total size
};

inline bool is_kept(const KeptFrames& kept, uint32_t frame) {
  return kept.frames.contains(frame);
}

// Returns the usage that targets need, in addition to their own, to be kept and restored.
std::array<VkImageUsageFlags, target_count> usage_for_keeping();

// Keeps all that record_scene wrote, unless 1 GiB is reached. All targets are in the resting state
// before and after. Waits for the device. Errors: environment.
Result<> keep_frame(KeptFrames& kept, const Renderer& renderer, uint32_t frame);
// Replaces record_scene for a kept frame.
void record_kept(const KeptFrames& kept, const Renderer& renderer, VkCommandBuffer commands,
                 uint32_t frame);

} // namespace demo
