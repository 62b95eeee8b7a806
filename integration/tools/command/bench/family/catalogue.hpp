#pragma once
// The kinds of scenes in the family.

#include "integration/tools/command/bench/family/family.hpp"
#include "integration/tools/command/bench/family/surface.hpp"

#include <string_view>

namespace dermis::tools {

struct FamilyParameter {
  const char* name = "";    // "": none
  double low = 0, high = 0; // limits of the half "judging"
  bool whole = false;
};

// The pixels' shape and the projection.
enum class FamilyView : uint8_t { square, perspective, non_square, non_square_perspective };

struct FamilyKind {
  std::string_view name, scene_class;
  FamilySurface (*make)(const FamilyValues& values) = nullptr;
  bool shaded = false; // may have FamilyPattern::shade
  std::array<FamilyParameter, 4> parameters{};
  double d_low = 0.5, d_high = 16; // limits of d_px in the half "judging"
  uint32_t judging = 2;            // random scenes of that half
  FamilyView view = FamilyView::square;
};

} // namespace dermis::tools
