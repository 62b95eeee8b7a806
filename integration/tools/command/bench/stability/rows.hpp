#pragma once
// What the stability bench found of one case and technique.

#include "integration/tools/command/bench/stability/cases.hpp"
#include "integration/tools/command/bench/technique.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct StabilityRow {
  std::string name,
      technique; // technique "formula": the closed forms in fp64, or moving values in half floats
  uint64_t frames = 1;
  uint64_t nonfinite_pixels = 0; // most in one frame
  uint64_t negative_pixels = 0;  // likewise
  double max_abs_error = 0;      // in units of the brightest light
  double bound = 0;
  std::optional<uint32_t>
      recovered_after_frames; // after the last damaged one; nullopt: nothing to recover from

  bool holds() const { return nonfinite_pixels == 0 && negative_pixels == 0 && max_abs_error <= bound; }
};

// One case of one technique; nullopt where it keeps no history and the case asks for one. Errors: those of
// the run.
demo::Result<std::optional<StabilityRow>> run_case(TechniqueRun& run, const StabilityCase& requested,
                                                   const std::string& name);

// A row of technique "formula".
StabilityRow formula_row(std::string name, double error, double bound, bool finite = true);

// The sampler, the albedo inversion and the control weight at the ends of their ranges.
std::vector<StabilityRow> formula_rows();
// Moving values kept in half floats over `updates` frames beside their fp64 twins.
std::vector<StabilityRow> moving_rows(uint64_t updates);

} // namespace dermis::tools
