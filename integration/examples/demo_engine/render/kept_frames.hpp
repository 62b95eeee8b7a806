#pragma once
// What the scene's passes left of frames, kept on the device.

#include "integration/examples/demo_engine/render/renderer.hpp"

#include <cstdint>
#include <map>

namespace demo {

// Dies before the host of its buffers.
struct KeptFrames {
  std::map<uint32_t, Buffer> frames; // by number
  uint64_t bytes = 0;                // of all
};

inline bool is_kept(const KeptFrames& kept, uint32_t frame) {
  return kept.frames.contains(frame);
}

// What targets need beside their own usage to be kept and brought back.
std::array<VkImageUsageFlags, target_count> usage_for_keeping();

// Keeps all that record_scene wrote, unless a gigabyte is reached. All targets rest before and after. Waits
// for the device. Errors: environment.
Result<> keep_frame(KeptFrames& kept, const Renderer& renderer, uint32_t frame);
// Takes the place of record_scene for a frame that is kept.
void record_kept(const KeptFrames& kept, const Renderer& renderer, VkCommandBuffer commands, uint32_t frame);

} // namespace demo
