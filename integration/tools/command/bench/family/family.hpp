#pragma once
// The family of seeded scenes: small generated frames of every kind of surface, to judge a
// technique on scenes that it was not tuned on. Scenes of the half "tuning" have fixed parameters.
// Those of the half "judging" are generated from a seed; no constant may be chosen on them.

#include "integration/tools/command/bench/subject.hpp"

#include <array>
#include <string>
#include <vector>

namespace dermis::tools {

struct FamilyKind; // a row of the catalogue

enum class FamilyPattern : uint8_t {
  shade,   // the surface under a key light
  texture, // contrasts at every scale
  edge,    // two halves of the picture
  bands,
  waves,
};

struct FamilyScene {
  std::string name; // "zigzag_56_d6", "zigzag_j1"
  FamilyMember member;
  const FamilyKind* kind = nullptr;
  std::array<double, 4> values{}; // parameters of the kind
  double d_px = 1;                // of the widest channel of the first material, mean pixel sides
  double aspect = 1;              // width of a pixel / its height
  bool perspective = false;
  FamilyPattern pattern = FamilyPattern::texture; // of the light
  bool skin = false;                              // three different d; else one d in every channel

  // Returns "angle 56, period 48".
  std::string parameters() const;
};

// Returns all scenes in a fixed order, the half "tuning" first. Names are unique.
const std::vector<FamilyScene>& family_scenes();
// Returns one scene per class, of alternating halves.
std::vector<FamilyScene> few_family_scenes();

inline constexpr uint32_t family_width = 256, family_height = 144; // pixels

// Generates a scene. Equal arguments give equal frames. `skin` is the profile of scenes with three
// different d. Thread: any.
CapturedFrame generate_family_scene(const FamilyScene& scene, uint32_t width, uint32_t height,
                                    const subsurface::Profile& skin);

} // namespace dermis::tools
