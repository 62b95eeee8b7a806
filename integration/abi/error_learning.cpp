#include "integration/abi/error_learning.hpp"

#include "integration/abi/compiled_graph.hpp"
#include "passes/common/probe.hpp"

#include <algorithm>

namespace dermis::abi {
namespace {

// Number of frames that are probed in a row: enough that single pixels do not decide.
constexpr uint32_t first_probes = 16;
// Number of frames until histories hold about what the error table assumes.
constexpr uint32_t converging_frames = 16;

// Returns the fraction of the tiles that a frame selected; 0 while their weights still change.
double selected_fraction(const FrameChoice& frame) {
  const subsurface::FrameCounters& counters = frame.counters;
  if (frame.fading || counters.sample_demand == 0) return 0;
  return std::min(1.0, double(counters.sample_units) / counters.sample_demand);
}

// Returns the run that a frame belongs to.
TechniqueRun next_run(const Chooser& chooser, const choice::Configuration& configuration,
                      const choice::FrameKey& key, bool cut, bool scatters) {
  const choice::ErrorCorrection& correction = chooser.error_correction;
  const int32_t technique = corrected_technique(correction, configuration);
  if (technique == chooser.run.technique && !cut)
    return {technique, chooser.run.frames + (scatters ? 1 : 0), chooser.run.known};
  return {technique, 0,
          measured_frames(correction, technique, key, chooser.state.clock_s, cut) >=
              choice::proven_frames};
}

// Returns the first frame of a run whose error is the technique's.
uint32_t first_valid_frame(const choice::Configuration& configuration) {
  return configuration.accumulates ? converging_frames : 0;
}

} // namespace

bool is_probed(const choice::ErrorModel& errors, const choice::Configuration& configuration) {
  return configuration.technique < 0 ||
         !errors.techniques[static_cast<size_t>(configuration.technique)].by_rays;
}

int32_t corrected_technique(const choice::ErrorCorrection& correction,
                            const choice::Configuration& configuration) {
  if (configuration.selects_tiles && correction.compared >= 0) return correction.compared;
  return configuration.without_samples >= 0 ? configuration.without_samples
                                            : configuration.technique;
}

void learn_error(Chooser& chooser, const choice::Configuration& configuration,
                 const FrameChoice& of_frame) {
  const subsurface::FrameCounters& counters = of_frame.counters;
  const subsurface::ProbedError probed = subsurface::probed_error(counters);
  if (probed.tiles == 0 || counters.scattering_tiles == 0) return;
  if (!is_probed(chooser.errors, configuration)) return;
  const choice::FrameKey key = {mean_d_px(counters), mean_relief(counters)};
  choice::ProbedFrame frame;
  frame.technique = corrected_technique(chooser.error_correction, configuration);
  frame.square = probed.square;
  frame.expected = expected_rmse(chooser.errors, configuration, key, counters.sample_units,
                                 counters.sample_demand);
  frame.unscattered_square = probed.unscattered_square;
  frame.expected_unscattered = expected_rmse(chooser.errors, -1, key);
  if (const int32_t compared = chooser.error_correction.compared; compared >= 0) {
    frame.compared_square = probed.separable_square;
    frame.compared_expected = expected_rmse(chooser.errors, compared, key);
    if (configuration.selects_tiles) { // only a part of the picture shows it
      frame.selection_square = probed.square;
      frame.selected = selected_fraction(of_frame);
      frame.square = frame.compared_square;
      frame.expected = frame.compared_expected;
    }
  }
  if (of_frame.converging) frame.technique = -1; // only the light is observed
  frame.key = key;
  frame.now_s = chooser.state.clock_s;
  observe_error(chooser.error_correction, frame);
}

bool is_learning(const Chooser& chooser, const CompiledGraph& compiled_graph) {
  const uint32_t current = chooser.state.current;
  return chooser.run.technique >= -1 && !chooser.run.known &&
         current < compiled_graph.configurations.size() &&
         chooser.run.frames <
             first_valid_frame(compiled_graph.configurations[current]) + first_probes;
}

void plan_probe(FrameChoice& frame, const Chooser& chooser,
                const choice::Configuration& configuration, const choice::FrameKey& key,
                bool scatters) {
  if (chooser.budget.ms <= 0) return; // nothing is chosen
  frame.run = next_run(chooser, configuration, key, frame.cut, scatters);
  const uint32_t first = first_valid_frame(configuration);
  frame.converging = frame.run.frames < first;
  frame.probed = !frame.run.known && !frame.converging && frame.run.frames < first + first_probes &&
                 is_probed(chooser.errors, configuration);
}

void restart_histories(FrameChoice& frame, const choice::Configuration& configuration) {
  if (frame.run.technique == TechniqueRun{}.technique || !configuration.accumulates) return;
  frame.run.frames = 0;
  frame.converging = true;
  frame.probed = false;
}

} // namespace dermis::abi
