#pragma once
// A device whose pass times are known, and random scenarios of what happens to it, to test
// controllers of device time. The same seed gives the same frames with every standard library.

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace dermis::choice_test {

constexpr double frame_seconds = 1.0 / 60;
constexpr int scenario_frames = 5400; // 90 s
// A disturbance lies within these frames.
constexpr int first_disturbed = 1800, last_disturbed = 3000;
constexpr double units_per_tile = 2; // of samples that tiles request

// Random numbers that do not depend on the standard library.
class Random {
public:
  explicit Random(uint64_t seed) : bits_(seed) {}
  uint64_t integer(uint64_t count) { return bits_() % count; }
  double uniform(double low, double high);
  double log_uniform(double low, double high);
  double normal(double deviation);

private:
  std::mt19937_64 bits_;
};

enum class Disturbance : uint8_t {
  none,
  calibration,   // costs are wrong by another factor per pass
  clock_steps,   // of the whole device
  device_hitch,  // up to a second
  pass_hitch,    // of the passes of one configuration, up to 2 s
  long_pass,     // the same for 4 to 20 s
  thermal,       // slow change of the clock
  dolly,         // slow change of the number of tiles
  cut,           // sudden change of the number of tiles
  oscillation,   // of the number of tiles
  no_timestamps, // while the clock changes
  mixed,
  count
};
std::string name_of(Disturbance disturbance);

struct SimulatedPass {
  double base_ms = 0, group_ms = 0; // true costs at clock 1
  double calibrated_base_ms = 0, calibrated_group_ms = 0;
  double clock_exponent = 1; // 1: bound by computation; less: by memory
  double noise = 0;          // standard deviation of the logarithm
  bool over_view = false;    // groups: all tiles of the view, not those with subsurface
};

struct SimulatedConfiguration {
  std::vector<uint32_t> passes;
  int32_t samples = -1; // pass that takes units of samples; -1: none
  double rmse = 0, unsampled_rmse = 0;
};

// A factor on the time of one pass in one frame.
struct PassFactor {
  uint32_t pass = 0;
  double factor = 1;
};

struct Scenario {
  Disturbance disturbance{};
  uint64_t seed = 0;
  std::vector<SimulatedPass> passes;
  std::vector<SimulatedConfiguration> configurations;
  double view_tiles = 0, tiles = 0;
  // Noise of a frame: standard deviation of the logarithm, and correlation with the previous frame.
  double frame_noise = 0, correlation = 0;
  double timestamp_ms = 1e-6; // resolution
  double untimed = 0;         // fraction of frames without timestamps
  bool strange_frames = true; // 1 % take 1.5 to 3 times as long
  int latency = 3;            // frames until counts and times are known
  std::array<double, 3> budgets_ms{};
  int disturbed_until = first_disturbed; // frame
  std::vector<double> clock, tiles_at;   // by frame
  std::vector<std::vector<PassFactor>> factors;
  std::vector<uint8_t> without_timestamps;
};

// Returns a random scenario.
Scenario make_scenario(Disturbance disturbance, uint64_t seed);
// Makes room for `frames` undisturbed frames.
void set_frames(Scenario& scenario, int frames);

double true_ms(const Scenario& scenario, uint32_t pass, double groups, int frame);
double groups_of(const Scenario& scenario, uint32_t pass, double tiles);
double requested_units(double tiles);

// Measured passes of one frame.
struct SimulatedFrame {
  std::vector<double> ms, groups; // by pass; ms < 0: did not run
  double total_ms = 0;            // true time
  bool timed = true;
};

class SimulatedDevice {
public:
  SimulatedDevice(const Scenario& scenario, uint64_t noise_seed);
  // Runs a configuration in frame `frame`. `first`: the first frame of its plan is longer.
  void run(uint32_t configuration, double units, int frame, bool first, SimulatedFrame& out);

private:
  const Scenario& scenario_;
  Random random_;
  double frame_noise_ = 0;
};

} // namespace dermis::choice_test
