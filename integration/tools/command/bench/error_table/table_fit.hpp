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
  double relief = -1; // subsurface::mean_relief; negative: nothing scatters
};

// Returns a point per d: the geometric mean over classes of equal weight of the geometric means of
// their scenes, and the geometric standard deviation of scenes around it. Uses the errors of the
// half "tuning" whose d is within 15 % of the point's. A d without errors has no point.
std::vector<choice::ErrorPoint> fit_curve(std::span<const MeasuredError> errors,
                                          const std::string& technique,
                                          std::span<const double> d_px);

// Returns the geometric mean of relief + relief_floor at each d, over classes of equal weight.
std::vector<choice::ReliefPoint> fit_relief(std::span<const MeasuredError> errors,
                                            std::span<const double> d_px);

// Returns the power of relief that fits the errors of the half "tuning" best around the table's
// curve, by least squares over classes of equal weight.
double fit_relief_power(const choice::ErrorModel& table, int32_t row,
                        std::span<const MeasuredError> errors, const std::string& technique);

// Replaces curve and power of each row whose name, up to a comma, is that of a measured technique.
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
