#pragma once
// Configurations of a graph's choices by budget: a value for each choice, the resulting plan, its
// work and its technique.

#include "framegraph/compile/compile.hpp"
#include "passes/choice/budget_controller.hpp"
#include "passes/choice/cost_estimator.hpp"
#include "passes/choice/error_model.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::choice {

// maximum per graph: the product of the options of its choices
inline constexpr size_t max_configurations = 64;

// Number of workgroups that a pass launches.
struct PassLoad {
  CostId cost;
  enum class Groups : uint8_t {
    fixed,
    rectangle,
    listed_tiles,
    copied_tiles,
    sample_units,
    selected_tiles
  } groups = Groups::fixed;
  uint64_t count = 1;   // for Groups::fixed
  DispatchRule rule;    // for Groups::rectangle
  bool launches = true; // launches a kernel; clears do not
  // level of the surface-aware pyramid whose tile list the pass runs over; -1: none
  int32_t level = -1;
  // groups per listed tile: 1 for square pixels, also at coarser levels, to which costs refer
  uint32_t multiple = 1;
};

struct Configuration {
  std::string name; // "technique=separable, taps=25": the choices that affect the running passes
  std::vector<SettingValue> settings; // one per Graph::settings
  uint32_t plan = 0;                  // index into Combinations::first
  int32_t technique = -1;             // index into ErrorModel::techniques; -1: none runs
  // Technique if no tile has samples; equal to `technique` if the configuration takes no samples by
  // tile.
  int32_t without_samples = -1;
  bool takes_samples = false;   // takes samples by tile, as many as the budget allows
  bool accumulates = false;     // blends frames into a history: its error decreases over frames
  bool selects_tiles = false;   // scatters in as many tiles as the budget allows; a unit is a tile
  std::vector<PassLoad> passes; // in plan order
};

// The combinations of all choices by budget that the device and the bound slots offer.
struct Combinations {
  std::vector<std::vector<SettingValue>> settings; // at least one; the first has the default values
  std::vector<uint32_t> plans; // by combination: number of its plan. Equal passes share a plan.
  std::vector<uint32_t> first; // by plan: the first combination that needs the plan
};

// Returns whether the pass runs over tiles that the budget selects: those with samples, or those
// that scatter.
bool runs_by_budget(const PassType& type);
// Returns whether the pass has groups only in frames in which no tile scatters.
bool copies_all_tiles(const PassType& type);

// Returns the name under which a calibration lists a pass with its settings, such as
// "subsurface.separable axis=vertical taps=25". `values`: one per setting of the pass type.
std::string work_name(const PassType& type, std::span<const SettingValue> values);

struct Work {
  std::string name; // work_name()
  PassLoad load;    // without a cost
};
// Returns the name and load of each pass of a plan with these settings of the graph.
std::vector<Work> works_of(const PassTypeRegistry& pass_types, const Plan& plan,
                           const std::vector<SettingValue>& settings);

// Enumerates the combinations. Other settings have the values in `input` (empty: the defaults). So
// have choices that the host made itself, `pinned` (one per setting; empty: none). Returns nullopt
// with an error in `diagnostics` if there are more than max_configurations.
std::optional<Combinations> enumerate_combinations(const CompileInput& input,
                                                   Diagnostics& diagnostics,
                                                   const std::vector<bool>& pinned = {});

// Returns the configurations of compiled combinations. `plans`: one per Combinations::first.
// Combinations that run the same passes with the same values are merged. Adds costs to `costs`.
std::vector<Configuration> make_configurations(const CompileInput& input,
                                               const Combinations& combinations,
                                               std::span<const Plan* const> plans,
                                               const ErrorModel& errors, CostEstimator& costs);

// Updates the passes and the technique of each configuration, after a change of a setting that
// turns no pass on or off, or with other models. `plans` is indexed by Configuration::plan.
void describe_configurations(const PassTypeRegistry& pass_types, std::span<const Plan* const> plans,
                             const ErrorModel& errors, CostEstimator& costs,
                             std::span<Configuration> configurations);

// Returns whether frames of both tell equally much about costs and errors: the plan, the work of
// its passes and the technique are equal.
bool is_same_work(const Configuration& a, const Configuration& b);

// Properties of a frame that affect costs.
struct FrameLoad {
  uint64_t width = 0, height = 0; // of the render rectangle, in pixels
  uint64_t listed_tiles = 0;      // tiles with subsurface
  uint64_t copied_tiles = 0;      // all tiles with subsurface if none scatters, else 0
  // units that subsurface.allocate_samples or subsurface.select_tiles spends
  uint64_t sample_units = 0;
};
uint64_t groups_of(const PassLoad& pass, const FrameLoad& load);
// Returns the time by the calibration only, which is equal on all machines.
double calibrated_ms(const Configuration& configuration, const CostEstimator& costs,
                     const FrameLoad& load);
// Returns the time of a frame; load.sample_units does not matter. `factors`: by
// CostEstimator::predict(); empty: the time by the calibration only.
TimeForecast forecast_time(const Configuration& configuration, const CostEstimator& costs,
                           std::span<const CostFactors> factors, const FrameLoad& load);
// Returns Forecast::concentration.
double concentration(const Configuration& configuration);
// Returns the expected RMSE if `given` of the `demand` units are taken: interpolates the mean
// squares without samples and with all samples as Forecast::concentration says. Units with the
// largest benefit come first, so the result is an upper bound of the measured error.
double expected_rmse(const ErrorModel& errors, const Configuration& configuration,
                     const FrameKey& key, uint32_t given, uint32_t demand);

} // namespace dermis::choice
