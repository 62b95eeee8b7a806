#pragma once
// Temporal anti-aliasing as in games: blends each frame's jittered picture into the accumulated
// picture, which is reprojected by velocity and clipped to the surrounding colours (Karis 2014,
// "High Quality Temporal Supersampling").

#include "integration/examples/demo_engine/render/renderer.hpp"

#include <array>
#include <memory>

namespace demo {

// Belongs to one thread; must be destroyed before the renderer whose targets it reads.
struct Taa {
  std::array<Image, 2> resolved; // this frame's and the last frame's picture, alternating
  Buffer constants;
  OwnedDescriptorPool pool;
  Program program;
  std::array<VkDescriptorSet, 2> sets{}; // by the index of `resolved` that is written
  uint32_t newest = 0;
  bool begun = false;
};

// Errors: environment.
Result<std::unique_ptr<Taa>> create_taa(const Renderer& renderer);

// Records the pass after record_composite. All images are in the resting state before and after.
// The device must be idle. After a cut, and in the first frame, the result is
// the frame without history.
void record_taa(Taa& taa, const Renderer& renderer, VkCommandBuffer commands,
                const SceneState& state);

// Returns the picture of the last frame.
const Image& taa_result(const Taa& taa);

} // namespace demo
