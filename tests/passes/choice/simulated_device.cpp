#include "tests/passes/choice/simulated_device.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::choice_test {

double Random::uniform(double low, double high) {
  return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
}

double Random::log_uniform(double low, double high) {
  return std::exp(uniform(std::log(low), std::log(high)));
}

double Random::normal(double deviation) { // Box and Muller
  if (deviation <= 0) return 0;
  const double radius = std::sqrt(-2 * std::log(1 - uniform(0, 1)));
  return deviation * radius * std::cos(2 * std::numbers::pi * uniform(0, 1));
}

std::string name_of(Disturbance disturbance) {
  constexpr std::array names = {"None",      "Calibration", "ClockSteps",   "DeviceHitch",
                                "PassHitch", "LongPass",    "Thermal",      "Dolly",
                                "Cut",       "Oscillation", "NoTimestamps", "Mixed"};
  return names[static_cast<size_t>(disturbance)];
}

double requested_units(double tiles) {
  return units_per_tile * tiles;
}

double groups_of(const Scenario& scenario, uint32_t pass, double tiles) {
  return scenario.passes[pass].over_view ? scenario.view_tiles : tiles;
}

double true_ms(const Scenario& scenario, uint32_t pass, double groups, int frame) {
  const auto t = static_cast<size_t>(frame);
  const SimulatedPass& one = scenario.passes[pass];
  double ms = one.base_ms + one.group_ms * groups;
  if (scenario.clock[t] != 1) ms *= std::pow(scenario.clock[t], one.clock_exponent);
  for (const PassFactor& factor : scenario.factors[t])
    if (factor.pass == pass) ms *= factor.factor;
  return ms;
}

void set_frames(Scenario& scenario, int frames) {
  const auto count = static_cast<size_t>(frames);
  scenario.clock.assign(count, 1);
  scenario.tiles_at.assign(count, scenario.tiles);
  scenario.factors.assign(count, {});
  scenario.without_timestamps.assign(count, 0);
}

namespace {

// Adds passes and configurations: `off`, and families of techniques that share a pass. Slower
// techniques have less error, with exceptions.
class SceneMaker {
public:
  SceneMaker(Scenario& scenario, Random& random) : scenario_(scenario), random_(random) {}

  void make() {
    scenario_.view_tiles = std::floor(random_.log_uniform(3600, 36000));
    scenario_.tiles = std::floor(scenario_.view_tiles * random_.log_uniform(0.05, 0.6));
    common_ = {add_pass(random_.log_uniform(0.05, 0.15), 0.3, true),
               add_pass(random_.log_uniform(0.05, 0.2), 0.2, false)};
    scenario_.configurations.push_back({common_, -1, 0.05, 0.05});
    const auto families = static_cast<int>(random_.uniform(2, 5));
    for (int f = 0; f < families; ++f)
      add_family(f == 0);
  }

private:
  uint32_t add_pass(double ms, double base_fraction, bool over_view) {
    SimulatedPass pass;
    pass.over_view = over_view;
    pass.base_ms = ms * base_fraction;
    pass.group_ms = ms * (1 - base_fraction) / (over_view ? scenario_.view_tiles : scenario_.tiles);
    return keep(pass);
  }

  uint32_t keep(SimulatedPass pass) {
    pass.clock_exponent = random_.uniform(0.6, 1);
    pass.noise = random_.log_uniform(0.01, 0.08);
    scenario_.passes.push_back(pass);
    return static_cast<uint32_t>(scenario_.passes.size() - 1);
  }

  void add_family(bool with_samples) {
    const uint32_t shared =
        add_pass(random_.log_uniform(0.1, 0.8), random_.uniform(0.1, 0.5), false);
    const auto variants = static_cast<int>(random_.uniform(1, 4));
    for (int v = 0; v < variants; ++v) {
      const double ms = random_.log_uniform(0.2, 5);
      const uint32_t own = add_pass(ms, random_.uniform(0.05, 0.4), false);
      const double all_ms = scenario_.passes[shared].base_ms + ms + 0.3;
      const double rmse =
          std::min(0.045, 0.006 * std::pow(all_ms, -0.8) * std::exp(random_.normal(0.2)));
      SimulatedConfiguration made{common_, -1, rmse, rmse};
      made.passes.insert(made.passes.end(), {shared, own});
      scenario_.configurations.push_back(made);
      if (!with_samples || v > 0) continue;
      SimulatedPass samples;
      samples.group_ms = ms * random_.log_uniform(0.5, 2) / requested_units(scenario_.tiles);
      made.samples = static_cast<int32_t>(keep(samples));
      made.rmse = 0.6 * rmse;
      scenario_.configurations.push_back(made);
    }
  }

  Scenario& scenario_;
  Random& random_;
  std::vector<uint32_t> common_;
};

// Every second scenario has a calibration of another device; in half of these the costs of
// dispatches and groups are wrong by different factors.
void calibrate(Scenario& scenario, Random& random) {
  const bool wrong = scenario.disturbance == Disturbance::calibration ||
                     scenario.disturbance == Disturbance::mixed || scenario.seed % 2 == 1;
  const double device = wrong ? random.log_uniform(0.5, 2) : 1;
  for (SimulatedPass& pass : scenario.passes) {
    const double both = wrong ? random.log_uniform(1.0 / 3, 3) : std::exp(random.normal(0.1));
    const double group = wrong && scenario.seed % 4 == 3 ? random.log_uniform(1.0 / 3, 3) : both;
    pass.calibrated_base_ms = pass.base_ms * both * device;
    pass.calibrated_group_ms = pass.group_ms * group * device;
  }
}

class Disturber {
public:
  Disturber(Scenario& scenario, Random& random) : scenario_(scenario), random_(random) {}

  // Disturbs at most `frames` frames from `from` on.
  void disturb(Disturbance disturbance, int from, int frames) {
    const int until = from + length(disturbance, frames);
    switch (disturbance) {
    case Disturbance::clock_steps:
      for (int t = from; t < until;) {
        const int next = std::min(until, t + static_cast<int>(random_.log_uniform(60, 400)));
        slow_device(t, next, random_.log_uniform(0.6, 1.5));
        t = next;
      }
      break;
    case Disturbance::device_hitch:
      slow_device(from, until, random_.log_uniform(1.5, 6));
      break;
    case Disturbance::pass_hitch:
      slow_technique(from, until, random_.log_uniform(1.5, 6));
      break;
    case Disturbance::long_pass:
      slow_technique(from, until, random_.log_uniform(1.5, 4));
      break;
    case Disturbance::thermal:
      heat(from, until, random_.log_uniform(1.2, 1.6));
      break;
    case Disturbance::dolly:
      approach(from, until, random_.log_uniform(0.05, 4));
      break;
    case Disturbance::cut:
      show(from, until, random_.log_uniform(0.02, 5));
      break;
    case Disturbance::oscillation:
      oscillate(from, until, random_.log_uniform(60, 600), random_.uniform(0.2, 0.7));
      break;
    case Disturbance::no_timestamps:
      std::fill(scenario_.without_timestamps.begin() + from,
                scenario_.without_timestamps.begin() + until, uint8_t{1});
      slow_device(from, until, random_.log_uniform(0.7, 1.4));
      break;
    default:
      return;
    }
    scenario_.disturbed_until = std::max(scenario_.disturbed_until, until);
  }

private:
  int length(Disturbance disturbance, int frames) {
    const auto at_most = [&](double low, double high) {
      return std::min(frames, static_cast<int>(random_.log_uniform(low, high)));
    };
    switch (disturbance) {
    case Disturbance::clock_steps:
      return at_most(60, 900);
    case Disturbance::device_hitch:
      return at_most(1, 60);
    case Disturbance::pass_hitch:
      return at_most(1, 120);
    case Disturbance::long_pass:
      return at_most(240, 1200);
    case Disturbance::cut:
      return at_most(60, 600);
    case Disturbance::no_timestamps:
      return at_most(10, 600);
    default:
      return frames;
    }
  }

  double limited(double tiles) const {
    return std::floor(std::clamp(tiles, 8.0, scenario_.view_tiles));
  }

  void slow_device(int from, int until, double factor) {
    for (int t = from; t < until; ++t)
      scenario_.clock[static_cast<size_t>(t)] *= factor;
  }

  // Slows the passes that only the family of a random technique runs.
  void slow_technique(int from, int until, double factor) {
    const auto& one =
        scenario_.configurations[1 + random_.integer(scenario_.configurations.size() - 1)];
    for (int t = from; t < until; ++t)
      for (size_t p = 2; p < one.passes.size(); ++p)
        scenario_.factors[static_cast<size_t>(t)].push_back({one.passes[p], factor});
  }

  void heat(int from, int until, double peak) {
    for (int t = from; t < until; ++t)
      scenario_.clock[static_cast<size_t>(t)] *=
          std::pow(peak, std::min({1.0, (t - from) / 600.0, (until - t) / 300.0}));
  }

  void approach(int from, int until, double factor) {
    for (int t = from; t < until; ++t) {
      const double turn = 2 * std::numbers::pi * (t - from) / (until - from);
      scenario_.tiles_at[static_cast<size_t>(t)] =
          limited(scenario_.tiles * std::pow(factor, 0.5 - 0.5 * std::cos(turn)));
    }
  }

  void show(int from, int until, double factor) {
    std::fill(scenario_.tiles_at.begin() + from, scenario_.tiles_at.begin() + until,
              limited(scenario_.tiles * factor));
  }

  void oscillate(int from, int until, double period, double depth) {
    for (int t = from; t < until; ++t)
      scenario_.tiles_at[static_cast<size_t>(t)] = limited(
          scenario_.tiles * (1 + depth * std::sin(2 * std::numbers::pi * (t - from) / period)));
  }

  Scenario& scenario_;
  Random& random_;
};

void disturb(Scenario& scenario, Random& random) {
  Disturber disturber(scenario, random);
  if (scenario.disturbance != Disturbance::mixed)
    return disturber.disturb(scenario.disturbance, first_disturbed,
                             last_disturbed - first_disturbed);
  constexpr std::array some = {Disturbance::clock_steps,  Disturbance::device_hitch,
                               Disturbance::pass_hitch,   Disturbance::thermal,
                               Disturbance::dolly,        Disturbance::cut,
                               Disturbance::no_timestamps};
  for (int i = 0; i < 4; ++i)
    disturber.disturb(some[random.integer(some.size())], first_disturbed + 300 * i, 280);
}

// Budgets between the cheapest and the most expensive configuration, in logarithms.
void set_budgets(Scenario& scenario) {
  double least = 1e9, most = 0;
  for (const SimulatedConfiguration& one : scenario.configurations) {
    double ms = 0;
    for (const uint32_t pass : one.passes)
      ms += true_ms(scenario, pass, groups_of(scenario, pass, scenario.tiles), 0);
    if (one.samples >= 0)
      ms +=
          true_ms(scenario, static_cast<uint32_t>(one.samples), requested_units(scenario.tiles), 0);
    least = std::min(least, ms);
    most = std::max(most, ms);
  }
  for (size_t b = 0; b < scenario.budgets_ms.size(); ++b)
    scenario.budgets_ms[b] = 1.3 * least * std::pow(most / least, 0.2 + 0.35 * double(b));
}

} // namespace

Scenario make_scenario(Disturbance disturbance, uint64_t seed) {
  Scenario scenario;
  Random random(seed * 7919 + static_cast<uint64_t>(disturbance) * 104729 + 13);
  scenario.disturbance = disturbance;
  scenario.seed = seed;
  scenario.frame_noise = random.log_uniform(0.01, 0.06);
  scenario.correlation = seed % 3 == 0 ? 0.3 : 0.0;
  scenario.timestamp_ms = std::array{1e-6, 1e-3, 1e-2}[seed % 3];
  scenario.untimed = seed % 4 == 0 ? 0.1 : 0.0;
  scenario.latency = 2 + static_cast<int>(seed % 3);
  SceneMaker(scenario, random).make();
  calibrate(scenario, random);
  set_frames(scenario, scenario_frames);
  set_budgets(scenario);
  disturb(scenario, random);
  return scenario;
}

SimulatedDevice::SimulatedDevice(const Scenario& scenario, uint64_t noise_seed)
    : scenario_(scenario), random_(noise_seed) {}

void SimulatedDevice::run(uint32_t configuration, double units, int frame, bool first,
                          SimulatedFrame& out) {
  constexpr double cold_factor = 1.3, empty_dispatch_ms = 0.002;
  const SimulatedConfiguration& one = scenario_.configurations[configuration];
  const double tiles = scenario_.tiles_at[static_cast<size_t>(frame)];
  const double kept = scenario_.correlation;
  frame_noise_ =
      kept * frame_noise_ + random_.normal(scenario_.frame_noise * std::sqrt(1 - kept * kept));
  double factor = std::exp(frame_noise_) * (first ? cold_factor : 1);
  if (scenario_.strange_frames && random_.uniform(0, 1) < 0.01) factor *= random_.uniform(1.5, 3);
  out.ms.assign(scenario_.passes.size(), -1);
  out.groups.assign(scenario_.passes.size(), 0);
  out.total_ms = 0;
  const auto run_pass = [&](uint32_t pass, double groups) {
    const double ms = true_ms(scenario_, pass, groups, frame) * factor *
                      std::exp(random_.normal(scenario_.passes[pass].noise));
    out.groups[pass] = groups;
    out.ms[pass] =
        std::floor(ms / scenario_.timestamp_ms + random_.uniform(0, 1)) * scenario_.timestamp_ms;
    out.total_ms += ms;
  };
  for (const uint32_t pass : one.passes)
    run_pass(pass, groups_of(scenario_, pass, tiles));
  if (one.samples >= 0 && units > 0)
    run_pass(static_cast<uint32_t>(one.samples), std::floor(units));
  else if (one.samples >= 0)
    out.ms[static_cast<size_t>(one.samples)] = empty_dispatch_ms; // takes no groups, but is timed
  out.timed = scenario_.without_timestamps[static_cast<size_t>(frame)] == 0 &&
              random_.uniform(0, 1) >= scenario_.untimed;
}

} // namespace dermis::choice_test
