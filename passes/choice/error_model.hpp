#pragma once
// How far a technique is off, as measured beforehand: RMSE of linear luminance over the projected shape
// parameter, for each technique and quality setting (docs/choice.md says how the tables are made).

#include "framegraph/text/document.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dermis::choice {

struct ErrorPoint {
  double d_px = 1; // of the widest channel, projected, > 0
  double rmse = 0; // > 0; exposed so that the light's 99.9th percentile is 1
};

struct SettingMatch {
  std::string setting, value; // as a graph file would write the value, without quotes
};

// A pass that a technique is known by.
struct PassTypeMatch {
  std::string type;
  std::vector<SettingMatch> settings; // all of them, in any order; other settings do not matter
};

struct TechniqueError {
  std::string name;                      // for people: "separable 25"
  std::vector<PassTypeMatch> pass_types; // a graph that runs passes like all of these
  std::vector<ErrorPoint> curve;         // d_px grows; at least one
  double through = 0;                    // of the light that comes through thin parts, how much it is off by
  bool by_rays = false; // the curve is against a truth by rays, not against that of the screen
};

struct ErrorModel {
  std::string scenes;                  // that the curves were measured on, for people
  std::vector<ErrorPoint> unscattered; // where no technique runs
  std::vector<TechniqueError> techniques;
  double unscattered_through = 0; // as TechniqueError::through
};

// Reads `"dermis_errors": 2`. nullopt with errors in `diagnostics`. Thread: any.
std::optional<ErrorModel> read_error_model(const Document& document, Diagnostics& diagnostics);

// A pass of a plan with the values it runs with, as texts.
struct RunningPass {
  std::string_view type;
  std::vector<SettingMatch> settings;
};
// The technique that most of its conditions name; -1: none runs.
int32_t find_technique(const ErrorModel& model, const std::vector<RunningPass>& passes);

// Straight between points on logarithmic axes, constant beyond the ends. technique -1: unscattered.
double expected_rmse(const ErrorModel& model, int32_t technique, double d_px);
// What the curve does not know of: light through thin parts, of which there is `transmitted_rms` (as
// subsurface::transmitted_rms).
double missed_rmse(const ErrorModel& model, int32_t technique, double transmitted_rms);

} // namespace dermis::choice
