#pragma once
// Runs a plan on the CPU, with tiny images and simple arithmetic in place of kernels. Plans of one
// graph that differ in order, memory or culling must give the host equal pixels.

#include "framegraph/compile/plan.hpp"
#include "tests/framegraph/interpret/placeholder.hpp"

#include <optional>
#include <vector>

namespace dermis {

struct InterpretOptions {
  uint32_t frames = 4;   // Number of consecutive frames.
  uint64_t contents = 1; // Seed of the host's contents.
  // Seed of undefined contents: never written, discarded, or overwritten through overlapping
  // memory.
  uint64_t poison = 1;
  // 0 runs commands as recorded; any other seed picks another order that the barriers allow.
  uint64_t order = 0;
  // Bit f: the camera cuts before frame f (1 .. 63). All earlier frames finish before frame f.
  uint64_t cuts = 0;
};

// Result by [frame][slot]; unbound slots are empty. For a verified plan the pixels do not depend on
// `poison` and `order`. Histories start from zero, also after a cut that invalidates them, and
// reads that depend on validity follow.
using Interpretation = std::vector<std::vector<std::optional<Pixels>>>;

// `plan` must pass verify_structure(). Free-threaded.
Interpretation interpret(const Plan& plan, const InterpretOptions& options);

// Returns the pixels that the host binds to a slot in a frame.
Pixels host_pixels(uint64_t contents, uint32_t frame, uint32_t slot);

} // namespace dermis
