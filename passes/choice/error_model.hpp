#pragma once
// Error model: measured RMSE of linear luminance over the projected shape parameter and the relief
// of a frame, for each technique and quality setting. docs/choice.md describes how the tables are
// made.

#include "framegraph/text/document.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::choice {

struct ErrorPoint {
  double d_px = 1; // d of the widest channel in pixels, > 0
  double rmse = 0; // > 0; exposed such that the 99.9th percentile of light is 1
  // geometric standard deviation of RMSE between scenes, at least 1; 1: not measured
  double spread = 1;
};

struct SettingMatch {
  std::string setting, value; // value as in a graph file, without quotes
};

// A pass that identifies a technique.
struct PassTypeMatch {
  std::string type;
  std::vector<SettingMatch> settings; // all must match, in any order; other settings do not matter
};

struct TechniqueError {
  std::string name;                      // human-readable: "separable 25"
  std::vector<PassTypeMatch> pass_types; // passes that a graph must run, all of them
  std::vector<ErrorPoint> curve;         // ascending d_px; at least one point
  double relief_power = 0;               // see expected_rmse
  double through = 0;                    // error relative to light transmitted through thin parts
  // whether the curve was measured against a ray-traced reference, not a screen-space one
  bool by_rays = false;
};

inline constexpr double max_relief_power = 2;
inline constexpr double relief_floor =
    1e-3; // added to relief, so that flat scenes have a logarithm
struct ReliefPoint {
  double d_px = 1;
  double relief = 0; // geometric mean of relief + relief_floor
};

// Properties of a frame by which the errors of techniques differ.
struct FrameKey {
  double d_px = 1;    // geometric mean over scattering tiles of the widest d
  double relief = -1; // subsurface::mean_relief; negative: not known
};

struct ErrorModel {
  std::string scenes;                  // scenes on which the curves were measured, human-readable
  std::vector<ErrorPoint> unscattered; // curve without a technique
  std::vector<TechniqueError> techniques;
  double unscattered_through = 0; // as TechniqueError::through
  // Usual relief of the scenes, for which the curves hold; ascending d_px. If empty, relief is
  // ignored.
  std::vector<ReliefPoint> relief;
  double unscattered_relief_power = 0; // as TechniqueError::relief_power
};

// Reads `"dermis_errors": 2`. Returns nullopt with errors in `diagnostics`. Thread: any.
std::optional<ErrorModel> read_error_model(const Document& document, Diagnostics& diagnostics);
// Returns the table as JSON with a note for readers. Thread: any.
std::string write_error_model(const ErrorModel& model, std::string_view note);

// A pass of a plan with its values as strings.
struct RunningPass {
  std::string_view type;
  std::vector<SettingMatch> settings;
};
// Returns the technique with the most conditions among those whose conditions all hold; -1: none.
int32_t find_technique(const ErrorModel& model, const std::vector<RunningPass>& passes);

// Returns the RMSE from the curve, times ((relief + relief_floor) / usual relief) to the power
// `relief_power`; without relief the factor is 1. Curves are linear between points on logarithmic
// axes, and constant beyond the ends. technique -1: unscattered.
double expected_rmse(const ErrorModel& model, int32_t technique, const FrameKey& key);
// Returns the spread of RMSE between scenes at this d, at least 1. Interpolates as expected_rmse().
double spread_at(const std::vector<ErrorPoint>& curve, double d_px);
// Returns the part of the RMSE that expected_rmse() does not include: the error of light
// transmitted through thin parts. `transmitted_rms`: the RMS of that light in the unit of
// subsurface::transmitted_rms. The result is a measured fraction of it per technique.
double missed_rmse(const ErrorModel& model, int32_t technique, double transmitted_rms);

} // namespace dermis::choice
