#pragma once
// Curves of the error table from measured errors, and how well they predict other scenes.

#include "passes/choice/error_model.hpp"

#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

struct MeasuredError {
  std::string technique; // name of its row; "off": unscattered
  std::string scene, scene_class, half;
  double d_px = 0, rmse = 0;
};

// Returns a point per d: the geometric mean over classes of equal weight of the geometric means of
// their scenes, and the geometric standard deviation of scenes around it. Uses the errors of the
// half "tuning" whose d is within 15 % of the point's. A d without errors has no point.
std::vector<choice::ErrorPoint> fit_curve(std::span<const MeasuredError> errors,
                                          const std::string& technique,
                                          std::span<const double> d_px);

// Replaces the curve of each row whose name, up to a comma, is that of a measured technique.
void fit_table(choice::ErrorModel& table, std::span<const MeasuredError> errors,
               std::span<const double> d_px);

// Logarithm of predicted over measured RMSE, over scenes of one half.
struct PredictionError {
  size_t scenes = 0;
  double mean = 0, rms = 0; // natural logarithms
};
PredictionError judge_table(const choice::ErrorModel& table, std::span<const MeasuredError> errors,
                            const std::string& technique, const std::string& half);

} // namespace dermis::tools
