#pragma once
// Outcomes of a graph's choices by budget: a value for each choice, the resulting plan, its work
// and its technique.

#include "framegraph/compile/compile.hpp"
#include "passes/choice/cost_model.hpp"
#include "passes/choice/error_model.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::choice {

// maximum per graph: the product of the options of its choices
inline constexpr size_t max_outcomes = 64;

// Number of workgroups that a pass launches.
struct PassLoad {
  CostId cost;
  enum class Groups : uint8_t {
    fixed,
    view_tiles,
    tile_grid,
    tile_blocks,
    listed_tiles,
    copied_tiles,
    sample_units
  } groups = Groups::fixed;
  uint64_t count = 1;   // for Groups::fixed
  bool launches = true; // launches a kernel; clears do not
  // level of the surface-aware pyramid whose tile list the pass runs over; -1: none
  int32_t level = -1;
};

struct Outcome {
  std::string name; // "technique=separable, taps=25": the choices that affect the running passes
  std::vector<SettingValue> settings; // one per Graph::settings
  uint32_t plan = 0;                  // index into OutcomePlans::plans
  int32_t technique = -1;             // index into ErrorModel::techniques; -1: none runs
  // Technique if no tile has samples; equal to `technique` if the outcome takes no samples by tile.
  int32_t without_samples = -1;
  bool takes_samples = false;   // takes samples by tile, as many as the budget allows
  std::vector<PassLoad> passes; // in plan order
};

// Compiles one combination: dermis::compile, or a cache.
using CompileOne = std::function<std::optional<CompiledPlan>(const CompileInput&, Diagnostics&)>;

struct OutcomePlans {
  std::vector<Outcome> outcomes; // at least one; the first has the default values
  // Distinct plans: outcomes whose settings turn no pass on or off share a plan.
  std::vector<CompiledPlan> plans;
};

// Returns the name of a work, such as "subsurface.separable axis=vertical taps=25". `values`: one
// per setting of the pass type.
std::string work_name(const PassType& type, std::span<const SettingValue> values);

// Enumerates the combinations of all choices by budget and compiles them. Other settings have the
// values in `input` (empty: the defaults). So have choices that the host made itself, `pinned` (one
// per setting; empty: none). Combinations that run the same passes with the same values are merged.
// Adds costs to `costs`. Returns nullopt with errors in `diagnostics`: those of compile(), and more
// than max_outcomes.
std::optional<OutcomePlans> make_outcomes(const CompileInput& input, const ErrorModel& errors,
                                          CostModel& costs, const CompileOne& compile,
                                          Diagnostics& diagnostics, const std::vector<bool>& pinned = {});

// Updates the passes and the technique of each outcome, after a change of a setting that turns no
// pass on or off, or with other models. `plans` is indexed by Outcome::plan.
void describe_outcomes(const PassTypeRegistry& pass_types, std::span<const Plan* const> plans,
                       const ErrorModel& errors, CostModel& costs, std::span<Outcome> outcomes);

// Properties of a frame that affect costs.
struct FrameLoad {
  uint64_t view_tiles = 0;   // 8x8 tiles of the render rectangle
  uint64_t listed_tiles = 0; // tiles with subsurface
  uint64_t copied_tiles = 0; // all tiles with subsurface if none scatters, else 0
  uint64_t sample_units = 0; // units that subsurface.allocate_samples spends
  uint64_t view_blocks = 0;  // 4x4 tiles of the render rectangle
};
uint64_t groups_of(const PassLoad& pass, const FrameLoad& load);
// Returns the time by the calibration only, which is equal on all machines; no spread.
Estimate calibrated_estimate(const Outcome& outcome, const CostModel& costs, const FrameLoad& load);
Estimate estimate(const Outcome& outcome, const CostModel& costs, const FrameLoad& load);
// Typical deviations of a budget that samples leave free when they fill it. One of twenty frames is
// late by more than two (a mean deviation is 0.8 of a standard deviation). Work that runs in any
// case needs one.
inline constexpr double given_deviations = 2.0;
// Returns the units of samples that fit into `budget_ms` in addition to all other work, with the
// deviations of both. Returns UINT32_MAX if the outcome takes no samples by tile, or if a unit
// costs nothing.
uint32_t units_within(const Outcome& outcome, const CostModel& costs, FrameLoad load, double budget_ms,
                      bool deterministic);
// Returns the expected RMSE if `given` of the `wanted` units are taken: interpolates linearly
// between the mean squares without samples and with all samples. Units with the largest benefit
// come first, so the result is an upper bound of the measured error.
double expected_rmse(const ErrorModel& errors, const Outcome& outcome, double d_px, uint32_t given,
                     uint32_t wanted);

} // namespace dermis::choice
