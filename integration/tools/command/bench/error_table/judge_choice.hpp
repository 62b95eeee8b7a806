#pragma once
// How far the error of a choice is from that of the best technique: of a choice by the error table
// only, and of one that also measures the errors of the technique that runs and of separable
// (subsurface.probe).

#include "integration/tools/command/bench/error_table/table_fit.hpp"

#include <span>
#include <string>

namespace dermis::tools {

// Errors of a choice over scenes of one half, relative to those of each scene's best technique.
struct ChoiceError {
  size_t scenes = 0; // in which all techniques, and "off", were measured
  double mean = 1;   // geometric
  double worst = 1;
  double switches = 0; // mean number per scene
};

// Returns the error of the choice among `techniques`, names of rows, without a limit on time.
ChoiceError judge_choice(const choice::ErrorModel& table, std::span<const MeasuredError> errors,
                         std::span<const std::string> techniques, const std::string& half);
// The same where each frame measures its error exactly, after 10 s of frames at rest.
ChoiceError judge_measuring_choice(const choice::ErrorModel& table,
                                   std::span<const MeasuredError> errors,
                                   std::span<const std::string> techniques,
                                   const std::string& half);

} // namespace dermis::tools
