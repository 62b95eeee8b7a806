#pragma once
// Runs a plan on the CPU, with tiny images and arithmetic in place of kernels. Plans of one graph that differ
// in order, memory or in what they leave out must give the host the same pixels.

#include "framegraph/compile/plan.hpp"
#include "tests/framegraph/interpret/placeholder.hpp"

#include <optional>
#include <vector>

namespace dermis {

struct InterpretOptions {
  uint32_t frames = 4;   // consecutive ones
  uint64_t contents = 1; // seed of what the host binds
  uint64_t poison = 1;   // seed of contents that mean nothing: never written, discarded, or overwritten
                         // through other memory that overlaps
  uint64_t order = 0;    // 0: commands run as recorded; else seed of another order that the barriers allow
  uint64_t cuts = 0; // bit f: the camera jumps before frame f, 1 .. 63; nothing of earlier frames runs later
};

// [frame][slot]: what the host gets back there; nothing for slots that it left unbound. Pixels of a plan that
// the verifier accepts do not depend on `poison` and `order`. Histories start from zero, and anew where a cut
// invalidates them; what depends on their validity follows from it.
using Interpretation = std::vector<std::vector<std::optional<Pixels>>>;

// `plan` must pass verify_structure(). Free-threaded.
Interpretation interpret(const Plan& plan, const InterpretOptions& options);

// What the host binds to a slot in a frame.
Pixels host_pixels(uint64_t contents, uint32_t frame, uint32_t slot);

} // namespace dermis
