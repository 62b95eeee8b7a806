#pragma once
// Result of one stability case for one technique.

#include "integration/tools/command/bench/stability/cases.hpp"
#include "integration/tools/command/bench/technique.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct StabilityRow {
  std::string name,
      technique; // "formula" is the closed forms in fp64, or moving values in half floats
  uint64_t frames = 1;
  uint64_t nonfinite_pixels = 0; // maximum over frames
  uint64_t negative_pixels = 0;  // maximum over frames
  double max_abs_error = 0;      // in units of the brightest light
  double bound = 0;
  // Frames after the last damaged frame; nullopt: no damage to recover from.
  std::optional<uint32_t> recovered_after_frames;

  bool holds() const {
    return nonfinite_pixels == 0 && negative_pixels == 0 && max_abs_error <= bound;
  }
};

// Runs one case on one technique. Returns nullopt if the case needs a history that the technique
// lacks. Errors: those of the run.
demo::Result<std::optional<StabilityRow>>
run_case(TechniqueRun& run, const StabilityCase& requested, const std::string& name);

// Returns a row of technique "formula".
StabilityRow formula_row(std::string name, double error, double bound, bool finite = true);

// Tests the sampler, the albedo inversion and the control weight at the limits of their ranges.
std::vector<StabilityRow> formula_rows();
// Compares moving values in half floats over `updates` frames with fp64 references.
std::vector<StabilityRow> moving_rows(uint64_t updates);

} // namespace dermis::tools
