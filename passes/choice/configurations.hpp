#pragma once
// Everything that a graph's choices by budget can come to: a value for each of them, the plan it leads to,
// what work that is and which technique.

#include "framegraph/compile/compile.hpp"
#include "passes/choice/cost_model.hpp"
#include "passes/choice/error_model.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::choice {

inline constexpr size_t max_outcomes = 64; // of a graph: the product of the options of its choices

// How many workgroups a pass launches.
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
  uint64_t count = 1;   // of fixed
  bool launches = true; // a kernel; clears do not
  int32_t level = -1;   // of the surface-aware pyramid whose list of tiles it runs over; -1: none
};

struct Outcome {
  std::string name;                   // "technique=separable, taps=25": the choices that matter to what runs
  std::vector<SettingValue> settings; // one per Graph::settings
  uint32_t plan = 0;                  // into OutcomePlans::plans
  int32_t technique = -1;             // into ErrorModel::techniques; -1: none runs
  int32_t without_samples = -1; // the same where no tile is given samples; as technique where none can be
  bool takes_samples = false;   // by tile, as many as the budget leaves
  std::vector<PassLoad> passes; // in plan order
};

// Compiles one combination: dermis::compile, or from a cache.
using CompileOne = std::function<std::optional<CompiledPlan>(const CompileInput&, Diagnostics&)>;

struct OutcomePlans {
  std::vector<Outcome> outcomes; // at least one: the first has the defaults' values
  std::vector<CompiledPlan>
      plans; // different ones only: outcomes whose settings turn no pass on or off share
};

// "subsurface.separable axis=vertical taps=25". `values`: one per setting of the pass type.
std::string work_name(const PassType& type, std::span<const SettingValue> values);

// Values of all choices by budget in every combination, those of other settings as in `input` (empty: the
// defaults); so are choices that the host made itself, `pinned` (one per setting; empty: none). Combinations
// that run the same passes with the same values are one. Costs are added to `costs`. nullopt with errors in
// `diagnostics`: as compile(), and more than max_outcomes.
std::optional<OutcomePlans> make_outcomes(const CompileInput& input, const ErrorModel& errors,
                                          CostModel& costs, const CompileOne& compile,
                                          Diagnostics& diagnostics, const std::vector<bool>& pinned = {});

// What each outcome's passes are and which technique: again after a setting changed that turns no pass on or
// off, or with other models. `plans` as Outcome::plan counts them.
void describe_outcomes(const PassTypeRegistry& pass_types, std::span<const Plan* const> plans,
                       const ErrorModel& errors, CostModel& costs, std::span<Outcome> outcomes);

// What a frame is like, as far as it bears on costs.
struct FrameLoad {
  uint64_t view_tiles = 0;   // 8x8 tiles of the render rectangle
  uint64_t listed_tiles = 0; // of them with subsurface
  uint64_t copied_tiles = 0; // where none scatters: all of them; else 0
  uint64_t sample_units = 0; // that subsurface.allocate_samples spends
  uint64_t view_blocks = 0;  // 4x4 tiles of the render rectangle
};
uint64_t groups_of(const PassLoad& pass, const FrameLoad& load);
// By the calibration alone, as on any other machine; no spread.
Estimate calibrated_estimate(const Outcome& outcome, const CostModel& costs, const FrameLoad& load);
Estimate estimate(const Outcome& outcome, const CostModel& costs, const FrameLoad& load);
// Typical deviations that samples leave free of a budget which they fill: frames are late by more than two in
// one of twenty (a mean deviation is .8 of a standard one). Work that is there in any case needs one.
inline constexpr double given_deviations = 2.0;
// Units of samples that fit into `budget_ms` beside everything else, with the deviations of both; UINT32_MAX
// where the outcome takes no samples by tile, or a unit costs nothing.
uint32_t units_within(const Outcome& outcome, const CostModel& costs, FrameLoad load, double budget_ms,
                      bool deterministic);
// Where `given` of the `wanted` units are taken: between the mean squares without samples and with all. Units
// that take off most come first, so that this is no less than what is measured.
double expected_rmse(const ErrorModel& errors, const Outcome& outcome, double d_px, uint32_t given,
                     uint32_t wanted);

} // namespace dermis::choice
