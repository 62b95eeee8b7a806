#include "integration/abi/chooser.hpp"

#include "framegraph/text/document.hpp"
#include "integration/abi/compiled_graph.hpp"
#include "passes/choice/defaults.hpp"
#include "passes/common/probe.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace dermis::abi {
namespace {

constexpr double assumed_d_px = 1; // pixels; before any frame has been counted
constexpr double ns_per_ms = 1e6;

// Tests ensure that both built-in files read without errors.
choice::ErrorModel default_errors() {
  Diagnostics diagnostics;
  const auto document =
      parse_document("errors", std::string(choice::default_errors_text()), diagnostics);
  auto read = document ? choice::read_error_model(*document, diagnostics) : std::nullopt;
  return read ? std::move(*read) : choice::ErrorModel{"", {{1, 1}}, {}, 0};
}

choice::Calibration default_calibration(choice::DeviceClass device) {
  Diagnostics diagnostics;
  const auto document = parse_document(
      "calibration", std::string(choice::default_calibration_text(device)), diagnostics);
  auto read = document ? choice::read_calibration(*document, diagnostics) : std::nullopt;
  return read ? std::move(*read) : choice::Calibration{};
}

choice::FrameLoad load_of(const subsurface::FrameCounters& counters,
                          const vulkan::Rectangle& rectangle) {
  const uint64_t listed =
      std::min<uint64_t>(tiles_of(rectangle), uint64_t{counters.scattering_tiles} +
                                                  counters.copied_tiles + counters.uniform_tiles);
  return {rectangle.width, rectangle.height, listed, counters.scattering_tiles == 0 ? listed : 0,
          counters.sample_units};
}

uint64_t launched(const choice::PassLoad& pass, const choice::FrameLoad& load,
                  const subsurface::FrameCounters& counters) {
  if (pass.groups == choice::PassLoad::Groups::sample_units) // one group per tile
    return uint64_t{counters.sampled_tiles[0]} + counters.sampled_tiles[1] +
           counters.sampled_tiles[2];
  if (pass.level < 0) return groups_of(pass, load);
  return counters.level_groups[std::min<size_t>(static_cast<size_t>(pass.level),
                                                counters.level_groups.size() - 1)];
}

void count_groups(std::span<const choice::PassLoad> passes, std::span<const uint8_t> without_bounds,
                  FrameChoice& frame) {
  const choice::FrameLoad load = load_of(frame.counters, frame.rectangle);
  for (size_t p = 0; p < passes.size(); ++p) {
    if (!passes[p].launches || (frame.left_out && without_bounds[p] != 0)) continue;
    ++frame.dispatches;
    frame.groups += launched(passes[p], load, frame.counters);
  }
}

FrameChoice& place_of(Chooser& chooser, uint64_t frame_index) {
  return chooser.frames[frame_index % chooser.frames.size()];
}

void learn(Chooser& chooser, std::span<const choice::PassLoad> passes, FrameChoice& frame) {
  const choice::FrameLoad load = load_of(frame.counters, frame.rectangle);
  frame.measured_ms = 0;
  for (size_t p = 0; p < passes.size(); ++p) {
    const double ms = static_cast<double>(chooser.times[p].nanoseconds) / ns_per_ms;
    frame.measured_ms += ms;
    if (!frame.first_of_plan && !frame.left_out)
      chooser.costs.observe(passes[p].cost, groups_of(passes[p], load), ms);
  }
}

// Learns the ratio of the error that the probe measured to the error that the table predicts.
void learn_error(Chooser& chooser, const choice::Configuration& configuration,
                 const subsurface::FrameCounters& counters) {
  const subsurface::ProbedError probed = subsurface::probed_error(counters);
  if (probed.tiles == 0 || counters.scattering_tiles == 0) return;
  // The probe's reference only sees the screen, so light that rays find beyond it is no error.
  if (configuration.technique >= 0 &&
      chooser.errors.techniques[static_cast<size_t>(configuration.technique)].by_rays)
    return;
  const double expected = expected_rmse(chooser.errors, configuration, mean_d_px(counters),
                                        counters.sample_units, counters.sample_demand);
  observe_error(chooser.found, configuration.technique, probed.rmse, expected);
}

uint64_t listed_tiles(const subsurface::FrameCounters& counters) {
  return uint64_t{counters.scattering_tiles} + counters.copied_tiles + counters.uniform_tiles;
}

void observe_frame(Chooser& chooser, CompiledGraph& compiled_graph, FrameChoice& frame) {
  const choice::Configuration& configuration = compiled_graph.configurations[frame.configuration];
  const RunnablePlan& plan = compiled_graph.plans[frame.plan];
  const std::span<const choice::PassLoad> passes =
      frame.plan == configuration.plan ? configuration.passes : plan.loads;
  vulkan::Executor& executor = *plan.executor;
  std::array<uint32_t, sizeof(subsurface::FrameCounters) / sizeof(uint32_t)> words{};
  const bool counted = executor.read_counters(frame.frame_index, words);
  if (counted) frame.counters = std::bit_cast<subsurface::FrameCounters>(words);
  uint64_t timed_frame = 0;
  const std::span times(chooser.times.data(), passes.size());
  frame.timed = executor.read_timings(frame.frame_index, timed_frame, times) &&
                timed_frame == frame.frame_index;
  count_groups(passes, plan.left_out, frame);
  if (!frame.left_out)
    frame.calibrated_ms =
        calibrated_estimate(configuration, chooser.costs, load_of(frame.counters, frame.rectangle))
            .ms;
  if (counted && frame.timed) learn(chooser, passes, frame);
  if (counted) learn_error(chooser, configuration, frame.counters);
  frame.observed = true;
  if (frame.frame_index <= chooser.newest.frame_index) return;
  chooser.newest = frame;
  if (!counted || frame.left_out) return; // no tile was classified
  if (configuration.takes_samples && frame.counters.scattering_tiles > 0)
    record_units(chooser.demand, subsurface::mean_d_px(frame.counters),
                 double(frame.counters.sample_demand) / frame.counters.scattering_tiles);
  update_growth(chooser.tile_growth, frame.frame_index, listed_tiles(frame.counters));
  chooser.counted = true;
  chooser.counters = frame.counters;
}

} // namespace

choice::DeviceClass device_class(VkPhysicalDeviceType type) {
  switch (type) {
  case VK_PHYSICAL_DEVICE_TYPE_CPU:
    return choice::DeviceClass::cpu;
  case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
    return choice::DeviceClass::large_gpu;
  default:
    return choice::DeviceClass::small_gpu;
  }
}

Chooser make_chooser(choice::DeviceClass device) {
  Chooser chooser;
  chooser.errors = default_errors();
  chooser.found = choice::make_error_correction(chooser.errors.techniques.size());
  chooser.calibration = default_calibration(device);
  chooser.costs = choice::CostModel(chooser.calibration.costs);
  return chooser;
}

void adopt(Chooser& chooser, const PassTypeRegistry& pass_types, CompiledGraph& compiled_graph) {
  compiled_graph.configurations =
      described(pass_types, compiled_graph, chooser.errors, chooser.costs,
                std::move(compiled_graph.configurations));
  for (choice::Configuration empty : compiled_graph.configurations) {
    empty.plan = compiled_graph.plans[empty.plan].without_bounds;
    if (empty.plan == no_plan) continue;
    compiled_graph.plans[empty.plan].loads =
        described(pass_types, compiled_graph, chooser.errors, chooser.costs, {empty})
            .front()
            .passes;
  }
  size_t passes = chooser.times.size();
  for (const RunnablePlan& plan : compiled_graph.plans)
    passes = std::max(passes, plan.compiled->plan.passes.size());
  chooser.times.resize(passes);
  chooser.forecasts.resize(
      std::max(chooser.forecasts.size(), compiled_graph.configurations.size()));
  compiled_graph.serial = ++chooser.compiled_graphs;
}

void observe(Chooser& chooser, CompiledGraph& compiled_graph,
             uint64_t completed_frame_index) noexcept {
  for (FrameChoice& frame : chooser.frames)
    if (frame.frame_index != 0 && !frame.observed && frame.frame_index <= completed_frame_index &&
        frame.compiled_graph == compiled_graph.serial)
      observe_frame(chooser, compiled_graph, frame);
}

FrameChoice choose(const Chooser& chooser, const CompiledGraph& compiled_graph,
                   uint64_t frame_index, double delta_seconds, const vulkan::Rectangle& rectangle,
                   std::span<choice::Forecast> forecasts, choice::DecisionState& state) noexcept {
  // Before any frame is counted, the whole view may scatter.
  const uint64_t view_tiles = tiles_of(rectangle);
  choice::FrameLoad load{rectangle.width, rectangle.height, view_tiles, 0, 0};
  double d_px = assumed_d_px, through = 0;
  uint64_t scattering = view_tiles;
  if (chooser.counted) {
    load = load_of(chooser.counters, rectangle);
    const double growth = growth_until(chooser.tile_growth, frame_index);
    const auto grown = [&](uint64_t tiles) {
      return std::min(view_tiles, static_cast<uint64_t>(std::lround(growth * double(tiles))));
    };
    load.listed_tiles = grown(load.listed_tiles);
    load.copied_tiles = grown(load.copied_tiles);
    scattering = grown(chooser.counters.scattering_tiles);
    if (scattering > 0) d_px = subsurface::mean_d_px(chooser.counters);
    through = subsurface::transmitted_rms(chooser.counters);
  }
  const auto demand =
      static_cast<uint32_t>(expected_units(chooser.demand, d_px) * double(scattering));
  const double filled_ms = chooser.budget_ms / choice::entry_margin;
  for (size_t i = 0; i < compiled_graph.configurations.size(); ++i) {
    const choice::Configuration& configuration = compiled_graph.configurations[i];
    load.sample_units = 0;
    if (configuration.takes_samples)
      load.sample_units = chooser.budget_ms > 0
                              ? std::min(demand, units_within(configuration, chooser.costs, load,
                                                              filled_ms, chooser.deterministic))
                              : demand;
    const choice::Estimate cost = chooser.deterministic
                                      ? calibrated_estimate(configuration, chooser.costs, load)
                                      : estimate(configuration, chooser.costs, load);
    const double rmse = expected_rmse(chooser.errors, configuration, d_px,
                                      static_cast<uint32_t>(load.sample_units), demand);
    const double seen = rmse * error_factor(chooser.found, configuration.technique);
    const double missed = missed_rmse(chooser.errors, configuration.technique, through);
    forecasts[i] = {cost.ms, cost.spread_ms, std::hypot(seen, missed), missed};
  }
  FrameChoice frame;
  frame.compiled_graph = compiled_graph.serial;
  frame.rectangle = rectangle;
  frame.expected_tiles = load.listed_tiles;
  frame.budget_ms = chooser.budget_ms;
  if (chooser.budget_ms > 0)
    frame.decision = decide(forecasts.first(compiled_graph.configurations.size()),
                            chooser.budget_ms, delta_seconds, state);
  else
    frame.decision = {0, choice::ReasonKind::no_budget};
  frame.configuration = frame.decision.configuration;
  if (chooser.budget_ms > 0)
    frame.sample_units = units_within(compiled_graph.configurations[frame.configuration],
                                      chooser.costs, load, filled_ms, chooser.deterministic);
  frame.switches = state.switches;
  frame.forecast = forecasts[frame.configuration];
  return frame;
}

void remember(Chooser& chooser, const FrameChoice& frame,
              const choice::DecisionState& state) noexcept {
  place_of(chooser, frame.frame_index) = frame;
  chooser.state = state;
  chooser.decided_for = frame.compiled_graph;
}

void discard_prediction(Chooser& chooser, uint64_t frame_index) noexcept {
  FrameChoice& frame = place_of(chooser, frame_index);
  if (frame.frame_index == frame_index) frame = {};
}

} // namespace dermis::abi
