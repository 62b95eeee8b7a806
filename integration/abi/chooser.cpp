#include "integration/abi/chooser.hpp"

#include "framegraph/text/document.hpp"
#include "integration/abi/compiled_graph.hpp"
#include "integration/abi/error_learning.hpp"
#include "passes/choice/defaults.hpp"
#include "passes/choice/tile_selection.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace dermis::abi {
namespace {

uint64_t listed_tiles(const subsurface::FrameCounters& counters) {
  return uint64_t{counters.scattering_tiles} + counters.copied_tiles + counters.uniform_tiles;
}

constexpr double assumed_d_px = 1; // pixels; before any frame has been counted
constexpr double dark_s = 1;       // so long without transmitted light, none is expected
constexpr double ns_per_ms = 1e6;
constexpr std::string_view counting_pass_type = "subsurface.classify"; // writes counters of tiles

// Tests ensure that both built-in files read without errors.
choice::ErrorModel default_errors() {
  Diagnostics diagnostics;
  const auto document =
      parse_document("errors", std::string(choice::default_errors_text()), diagnostics);
  auto read = document ? choice::read_error_model(*document, diagnostics) : std::nullopt;
  choice::ErrorModel unknown;
  unknown.unscattered = {{1, 1}};
  return read ? std::move(*read) : unknown;
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

void learn(Chooser& chooser, std::span<const choice::PassLoad> passes, choice::TimeMargins& margins,
           bool same_work, bool counts_tiles, FrameChoice& frame) {
  const choice::FrameLoad load = load_of(frame.counters, frame.rectangle);
  frame.measured_ms = 0;
  chooser.pass_times.clear();
  for (size_t p = 0; p < passes.size(); ++p) {
    const double ms = static_cast<double>(chooser.times[p].nanoseconds) / ns_per_ms;
    frame.measured_ms += ms;
    chooser.pass_times.push_back({passes[p].cost, groups_of(passes[p], load), ms});
  }
  if (frame.begins || frame.left_out || !same_work) return;
  chooser.costs.observe(chooser.pass_times, chooser.state.clock_s);
  // After a step of the device the times before do not count. Empty dispatches teach nothing.
  if (frame.decision.measured && !chooser.costs.device_stepped() &&
      (listed_tiles(frame.counters) > 0 || !counts_tiles))
    chooser.last_margin = margins.observe(frame.configuration, frame.decision.expected_ms,
                                          frame.measured_ms, chooser.budget.percentile);
}

void reduce_optimism(choice::CostEstimator& costs, const choice::Configuration& configuration) {
  for (const choice::PassLoad& pass : configuration.passes)
    costs.reduce_optimism(pass.cost);
}

// Returns the ratio of the lengths that the same object has in both, in pixels.
double scale_between(const vulkan::Rectangle& from, const vulkan::Rectangle& to) {
  const double from_pixels = double(from.width) * from.height;
  return from_pixels > 0 ? std::sqrt(double(to.width) * to.height / from_pixels) : 1;
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
        calibrated_ms(configuration, chooser.costs, load_of(frame.counters, frame.rectangle));
  // Settings other than those of the frame have another cost and error.
  const bool same_work = frame.revision == compiled_graph.revision;
  if (counted && frame.timed)
    learn(chooser, passes, compiled_graph.margins, same_work, plan.counts_tiles, frame);
  if (frame.decision.rejected != choice::no_configuration)
    reduce_optimism(chooser.costs, compiled_graph.configurations[frame.decision.rejected]);
  // Errors of the content before a cut would count as those of the present content.
  const bool before_cut = std::ranges::any_of(chooser.frames, [&](const FrameChoice& other) {
    return other.cut && other.frame_index > frame.frame_index;
  });
  if (counted && same_work && !before_cut) learn_error(chooser, configuration, frame);
  frame.observed = true;
  if (frame.frame_index <= chooser.newest.frame_index) return;
  chooser.newest = frame;
  if (!counted || frame.left_out || !plan.counts_tiles) return;
  const bool samples = configuration.takes_samples && !configuration.selects_tiles;
  if (samples && frame.counters.scattering_tiles > 0)
    record_units(chooser.demand, subsurface::mean_d_px(frame.counters),
                 double(frame.counters.sample_demand) / frame.counters.scattering_tiles);
  if (chooser.counted)
    rescale(chooser.tile_growth, scale_between(chooser.counted_rectangle, frame.rectangle));
  update_growth(chooser.tile_growth, frame.frame_index, listed_tiles(frame.counters));
  chooser.counted = true;
  chooser.counters = frame.counters;
  chooser.counted_rectangle = frame.rectangle;
  const double transmitted = subsurface::transmitted_rms(frame.counters);
  if (transmitted > 0) chooser.transmitted_s = chooser.state.clock_s;
  if (transmitted > 0 || chooser.state.clock_s - chooser.transmitted_s > dark_s)
    chooser.transmitted_rms = transmitted;
  if (frame.counters.scattering_tiles == 0) return;
  chooser.scattering_key.d_px = subsurface::mean_d_px(frame.counters);
  // Few tiles may all be among those in which relief is not counted.
  if (const double relief = subsurface::mean_relief(frame.counters); relief >= 0)
    chooser.scattering_key.relief = relief;
  chooser.scattering_rectangle = frame.rectangle;
}

// Contents that a frame is expected to show.
struct Content {
  choice::FrameLoad load;
  uint64_t scattering_tiles = 0;
  choice::FrameKey key{assumed_d_px};
  double units_per_tile = choice::max_units; // of samples that scattering tiles request
  double transmitted_rms = 0;
  bool cut = false; // the frame replaces the content
};

// `growth`: factor on the tiles that were counted last.
Content expected_content(const Chooser& chooser, const vulkan::Rectangle& rectangle,
                         double growth) {
  // Before any frame is counted, the whole view may scatter.
  const uint64_t view_tiles = tiles_of(rectangle);
  Content out;
  out.load = {rectangle.width, rectangle.height, view_tiles, 0, 0};
  out.scattering_tiles = view_tiles;
  if (!chooser.counted) return out;
  const uint64_t counted = listed_tiles(chooser.counters);
  const double scale = scale_between(chooser.counted_rectangle, rectangle);
  const double factor =
      counted == tiles_of(chooser.counted_rectangle)
          ? double(view_tiles) / double(counted) // the whole view
          : choice::scaled_tiles(double(counted), scale) / double(std::max<uint64_t>(counted, 1));
  const auto scaled = [&](uint64_t tiles) {
    return std::min(view_tiles,
                    static_cast<uint64_t>(std::lround(growth * factor * double(tiles))));
  };
  out.load = load_of(chooser.counters, rectangle);
  out.load.listed_tiles = scaled(counted);
  out.load.copied_tiles = chooser.counters.scattering_tiles == 0 ? out.load.listed_tiles : 0;
  out.scattering_tiles = scaled(chooser.counters.scattering_tiles);
  if (chooser.scattering_rectangle.width > 0)
    out.key = {scale_between(chooser.scattering_rectangle, rectangle) * chooser.scattering_key.d_px,
               chooser.scattering_key.relief};
  out.units_per_tile = expected_units(chooser.demand, out.key.d_px);
  out.transmitted_rms = chooser.transmitted_rms;
  return out;
}

// `count`: number of configurations, from the first.
std::span<choice::Forecast> forecast_first(Chooser& chooser, const CompiledGraph& compiled_graph,
                                           size_t count, const Content& content, double now_s) {
  const bool deterministic = chooser.budget.deterministic;
  const std::span<const choice::CostFactors> factors =
      deterministic ? std::span<const choice::CostFactors>() : chooser.costs.predict(now_s);
  const double demand = std::floor(content.units_per_tile * double(content.scattering_tiles));
  for (uint32_t i = 0; i < count; ++i) {
    const choice::Configuration& configuration = compiled_graph.configurations[i];
    const auto factor_of = [&](int32_t technique) {
      return error_factor(chooser.error_correction, technique, content.key, now_s, content.cut);
    };
    const double missed =
        missed_rmse(chooser.errors, configuration.technique, content.transmitted_rms);
    const auto error_of = [&](int32_t technique, double factor) {
      return std::hypot(expected_rmse(chooser.errors, technique, content.key) * factor, missed);
    };
    choice::Forecast& out = chooser.scratch.forecasts[i];
    out = {};
    out.time = forecast_time(configuration, chooser.costs, factors, content.load);
    out.margin = deterministic ? choice::calibrated_margin : compiled_graph.margins.margin(i);
    out.takes_samples = configuration.takes_samples;
    out.demand = configuration.selects_tiles ? double(content.scattering_tiles) : demand;
    out.concentration = concentration(configuration);
    if (configuration.selects_tiles)
      out.concentration = selection_concentration(chooser.error_correction, out.concentration,
                                                  content.key, now_s, content.cut);
    out.rmse = error_of(configuration.technique,
                        factor_of(corrected_technique(chooser.error_correction, configuration)));
    out.unsampled_rmse =
        error_of(configuration.without_samples, factor_of(configuration.without_samples));
    out.missed_rmse = missed;
    out.is_probed = is_probed(chooser.errors, configuration);
    out.error_frames = measured_frames(chooser.error_correction,
                                       corrected_technique(chooser.error_correction, configuration),
                                       content.key, now_s, content.cut);
  }
  return std::span(chooser.scratch.forecasts).first(count);
}

// Returns the number of passes whose time is not known; 0 if measured times do not count.
size_t unmeasured(const Chooser& chooser) {
  return chooser.budget.deterministic ? 0 : chooser.costs.unmeasured();
}

choice::Decision without_budget(const choice::Forecast& forecast) {
  choice::Decision decision;
  decision.why = choice::ReasonKind::no_budget;
  decision.units = forecast.takes_samples ? forecast.demand : 0;
  decision.expected_ms = forecast.time.expected_ms + decision.units * forecast.time.unit_ms;
  decision.bound_ms = decision.expected_ms * std::exp(forecast.margin);
  decision.rmse = rmse_with(forecast, decision.units);
  decision.measured = forecast.time.measured;
  return decision;
}

// Returns the milliseconds that the frame may take.
double budget_of_frame(const Chooser& chooser, const FrameRequest& request, bool idle, bool counted,
                       std::span<const choice::Forecast> forecasts) {
  if (!chooser.budget.all_views) return chooser.budget.ms;
  const choice::DecisionState& state = chooser.scratch.state;
  const choice::Offers offers = request.empty_bounds ? choice::offers_of_no_work()
                                : idle               ? choice::offers_of_idle(forecasts, state)
                                                     : choice::make_offers(forecasts, state);
  const std::lock_guard lock(request.shared->mutex);
  return request.shared->division.share(*request.share, chooser.budget.ms, offers,
                                        counted || request.empty_bounds, request.seconds);
}

SelectionChange next_selection(const SelectionChange& before, const FrameChoice& frame) {
  constexpr double same = 0.05; // relative change of units that counts as none
  const double units = frame.decision.units;
  SelectionChange now{units, before.frames_to_final > 0 ? before.frames_to_final - 1 : 0};
  if (frame.begins)
    now.frames_to_final = 0;
  else if (std::abs(units - before.units) > same * std::max(units, before.units))
    now.frames_to_final = choice::fading_frames;
  return now;
}

// Returns the limit on the samples of tiles. Units above the demand that fit are allowed, because
// the demand may grow.
uint32_t units_of(const choice::Decision& decision, const choice::Forecast& forecast) {
  return forecast.takes_samples
             ? static_cast<uint32_t>(std::min(decision.max_units, double(UINT32_MAX)))
             : UINT32_MAX;
}

bool counts_tiles(const CompiledPlan& compiled, const PassTypeRegistry& pass_types) {
  return std::ranges::any_of(compiled.plan.passes, [&](const PlanPass& pass) {
    return pass_types[pass.type].name == counting_pass_type;
  });
}

// Returns whether frames with the configuration that runs count tiles; before the first frame,
// whether those with the defaults do.
bool counts_tiles(const CompiledGraph& compiled_graph, uint32_t current) {
  const bool first = current >= compiled_graph.configurations.size();
  return compiled_graph.plans[compiled_graph.configurations[first ? 0 : current].plan].counts_tiles;
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
  chooser.error_correction = make_error_correction(chooser.errors);
  chooser.calibration = default_calibration(device);
  chooser.costs = choice::CostEstimator(chooser.calibration.costs, chooser.calibration.uncertainty);
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
  for (RunnablePlan& plan : compiled_graph.plans) {
    passes = std::max(passes, plan.compiled->plan.passes.size());
    plan.counts_tiles = counts_tiles(*plan.compiled, pass_types);
  }
  chooser.times.resize(passes);
  chooser.pass_times.reserve(passes);
  const size_t configurations =
      std::max(chooser.scratch.forecasts.size(), compiled_graph.configurations.size());
  chooser.scratch.forecasts.resize(configurations);
  chooser.scratch.assessments.resize(configurations);
  for (choice::DecisionState* state :
       {&chooser.state, &chooser.previous_state, &chooser.scratch.state})
    state->configurations.reserve(configurations);
  compiled_graph.margins.restart(compiled_graph.configurations.size(), chooser.last_margin);
  compiled_graph.serial = ++chooser.compiled_graphs;
}

void retire_other_costs(Chooser& chooser, const CompiledGraph& compiled_graph) noexcept {
  chooser.costs.retire_all();
  for (const choice::Configuration& configuration : compiled_graph.configurations)
    for (const choice::PassLoad& pass : configuration.passes)
      chooser.costs.use(pass.cost);
}

void observe(Chooser& chooser, CompiledGraph& compiled_graph,
             uint64_t completed_frame_index) noexcept {
  for (FrameChoice& frame : chooser.frames)
    if (frame.frame_index != 0 && !frame.observed && frame.frame_index <= completed_frame_index &&
        frame.compiled_graph == compiled_graph.serial)
      observe_frame(chooser, compiled_graph, frame);
}

FrameChoice choose(Chooser& chooser, const CompiledGraph& compiled_graph,
                   const FrameRequest& request) noexcept {
  Content content = expected_content(chooser, request.rectangle,
                                     growth_until(chooser.tile_growth, request.index));
  content.cut = request.cut;
  FrameChoice frame;
  frame.frame_index = request.index;
  frame.compiled_graph = compiled_graph.serial;
  frame.revision = compiled_graph.revision;
  frame.rectangle = request.rectangle;
  frame.expected_tiles = content.load.listed_tiles;
  choice::DecisionState& state = chooser.scratch.state;
  state = chooser.state;
  if (chooser.decided_for != compiled_graph.serial)
    restart(state, compiled_graph.configurations.size(), unmeasured(chooser));
  // Without a budget, the defaults run.
  const size_t count = chooser.budget.ms > 0 ? compiled_graph.configurations.size() : 1;
  const std::span<choice::Forecast> forecasts =
      forecast_first(chooser, compiled_graph, count, content, state.clock_s);
  choice::FrameInput input;
  input.empty = request.empty_bounds;
  // Frames of a plan that counts no tiles do not show whether anything scatters.
  const bool counts = counts_tiles(compiled_graph, state.current);
  const bool counted = chooser.counted || !counts;
  input.idle = input.empty || (counts && counted && chooser.counters.scattering_tiles == 0);
  if (chooser.budget.ms > 0)
    frame.budget_ms = budget_of_frame(chooser, request, input.idle, counted, forecasts);
  input.budget_ms = frame.budget_ms;
  input.seconds = request.seconds;
  input.cut = request.cut;
  input.provisional =
      !counted || (request.empty_bounds && state.current == choice::no_configuration);
  input.trials = chooser.budget.trials;
  input.learning = is_learning(chooser, compiled_graph);
  if (chooser.budget.ms > 0) {
    frame.decision = decide(forecasts, input, state,
                            std::span(chooser.scratch.assessments).first(forecasts.size()));
    frame.sample_units = units_of(frame.decision, forecasts[frame.decision.configuration]);
  } else {
    frame.decision = without_budget(forecasts.front());
    skip_frame(state, request.seconds);
  }
  frame.configuration = frame.decision.configuration;
  frame.switches = state.switches;
  frame.cut = request.cut;
  plan_probe(frame, chooser, compiled_graph.configurations[frame.configuration], content.key,
             counts && !input.idle);
  return frame;
}

std::span<const choice::Forecast> forecast(Chooser& chooser, const CompiledGraph& compiled_graph,
                                           const vulkan::Rectangle& rectangle) noexcept {
  constexpr double no_growth = 1;
  Content content = expected_content(chooser, rectangle, no_growth);
  content.units_per_tile = likely_units(chooser.demand, content.key.d_px);
  return forecast_first(chooser, compiled_graph, compiled_graph.configurations.size(), content,
                        chooser.state.clock_s);
}

choice::Decision settled_decision(Chooser& chooser, const CompiledGraph& compiled_graph,
                                  std::span<const choice::Forecast> forecasts,
                                  double budget_ms) noexcept {
  if (budget_ms <= 0) return without_budget(forecasts.front());
  choice::DecisionState& state = chooser.scratch.state;
  state = chooser.state;
  if (chooser.decided_for != compiled_graph.serial)
    restart(state, compiled_graph.configurations.size(), unmeasured(chooser));
  allow_switches(state);
  choice::FrameInput input;
  input.budget_ms = budget_ms;
  input.trials = choice::Trials::off;
  return decide(forecasts, input, state,
                std::span(chooser.scratch.assessments).first(forecasts.size()));
}

void remember(Chooser& chooser, const FrameChoice& frame) noexcept {
  chooser.previous_run = chooser.run;
  chooser.run = frame.run;
  chooser.previous_selection = chooser.selection;
  chooser.selection = next_selection(chooser.selection, frame);
  place_of(chooser, frame.frame_index) = frame;
  place_of(chooser, frame.frame_index).fading = chooser.selection.frames_to_final > 0;
  std::swap(chooser.previous_state, chooser.state);
  std::swap(chooser.state, chooser.scratch.state);
  chooser.previously_decided_for = chooser.decided_for;
  chooser.decided_for = frame.compiled_graph;
  if (frame.cut) forget_errors(chooser.error_correction);
}

void discard_choice(Chooser& chooser, uint64_t frame_index) noexcept {
  FrameChoice& frame = place_of(chooser, frame_index);
  if (frame.frame_index == frame_index) {
    if (frame.cut) recall_errors(chooser.error_correction);
    frame = {};
  }
  std::swap(chooser.state, chooser.previous_state);
  chooser.selection = chooser.previous_selection;
  chooser.run = chooser.previous_run;
  chooser.decided_for = chooser.previously_decided_for;
}

} // namespace dermis::abi
