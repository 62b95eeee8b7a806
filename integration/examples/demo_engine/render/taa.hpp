#pragma once
// Temporal anti-aliasing as games have it: each frame's jittered picture is mixed into what the frames before
// made of it, followed by velocity and kept within the colours around (Karis 2014, "High Quality Temporal
// Supersampling").

#include "integration/examples/demo_engine/render/renderer.hpp"

#include <array>
#include <memory>

namespace demo {

// Belongs to one thread; dies before the renderer whose targets it reads.
struct Taa {
  std::array<Image, 2> resolved; // this frame's and the last one's, in turn
  Buffer constants;
  OwnedDescriptorPool pool;
  Program program;
  std::array<VkDescriptorSet, 2> sets{}; // one for each of `resolved` to be written
  uint32_t newest = 0;
  bool begun = false;
};

// Errors: environment.
Result<std::unique_ptr<Taa>> create_taa(const Renderer& renderer);

// Records the frame's turn after record_composite; everything rests before and after. The device must be
// idle. After a cut, and at first, the picture is the frame's own.
void record_taa(Taa& taa, const Renderer& renderer, VkCommandBuffer commands, const SceneState& state);

// What the last frame became.
const Image& taa_result(const Taa& taa);

} // namespace demo
