#pragma once
// Device time of passes: the calibration times a factor of the device times a factor of the work.
//   ms(work, groups) = (base + per_group * groups) * exp(device + own)
// The factor of the device is what all timed passes share, so work that does not run follows the
// device, too. Optimistic and pessimistic factors say how far work that was not timed may deviate.

#include "passes/choice/affine_fit.hpp"
#include "passes/choice/level_tracker.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::choice {

// Index of a kind of work in a CostEstimator.
struct CostId {
  uint32_t value = UINT32_MAX;
  bool valid() const { return value != UINT32_MAX; }
};

// One line of a calibration: the cost of a kind of work on the device on which it was measured.
struct Cost {
  std::string work;    // pass type and settings: "subsurface.separable axis=vertical taps=25"
  double base_us = 0;  // microseconds per dispatch, >= 0
  double group_us = 0; // microseconds per workgroup, >= 0
  double spread = 0;   // typical relative deviation of one frame, 0 .. 1
  // factor >= 1 by which the time may be wrong; 0: that of the calibration
  double uncertainty = 0;
};

// Costs that a calibration may have.
inline constexpr size_t max_calibrated_costs = 4096;

// Factor by which a time of a calibration may be wrong, in both directions: for another device, and
// for the device on which the calibration was measured.
inline constexpr double other_device_uncertainty = 3.3, same_device_uncertainty = 1.35;

// Times below 1 ns count as 1 ns: timestamps are no finer, and ratios need a time.
inline constexpr double min_calibrated_ms = 1e-6;

// A timed pass of a frame.
struct PassTime {
  CostId cost;
  uint64_t groups = 0;
  double ms = 0;
};

// Factors on the calibrated time of a kind of work in the next frame.
struct CostFactors {
  double expected = 1;
  double pessimistic = 1; // work that never ran takes more than expected
  double optimistic = 1;  // work that never ran takes its least time
  // in addition, work that was disturbed when it ran last takes its usual time
  double undisturbed = 1;
  // Work that is well known and was disturbed when it ran last takes its usual time.
  double usual = 1;
  bool measured = false; // at least known_after times, and recently
};

// Calibrated costs and those observed since. One thread at a time; only the constructor, add() and
// calibration() allocate.
class CostEstimator {
public:
  // `uncertainty`: factor >= 1 by which the calibration may be wrong.
  explicit CostEstimator(std::vector<Cost> calibration = {},
                         double uncertainty = other_device_uncertainty);

  // Returns the entry of a kind of work; creates it if necessary. Until its first measurement, the
  // work of the same pass type with the most equal settings is its placeholder; without any, the
  // work with the largest cost per group, or a small fixed time if it launches no kernel. Must not
  // be called while frames are recorded.
  CostId add(std::string_view work, bool launches = true);
  // Makes predict() and unmeasured() ignore all work until add() or use() names it again. What is
  // known of its cost stays.
  void retire_all() noexcept;
  void use(CostId id) noexcept { lines_[id.value].used = true; }
  // Returns whether the calibration, or an earlier measurement, has work of the same pass type.
  bool has_calibration(CostId id) const;

  // Returns the cost by the calibration only, which is equal on all machines and in all runs.
  const AffineCost& calibrated_cost(CostId id) const { return lines_[id.value].prior; }
  // Returns the factors of all work in use, by CostId, at time `now_s` of observe(). They
  // live until the next call.
  std::span<const CostFactors> predict(double now_s);
  // Returns the number of kinds of work in use that were never timed.
  size_t unmeasured() const;

  // Adds one timed frame, all passes of it. Ignores times that are not finite or negative, and
  // passes without groups. Times only increase.
  void observe(std::span<const PassTime> passes, double now_s);
  // Returns whether the last observe() found that the time of all passes stepped.
  bool device_stepped() const { return device_.outliers_in_a_row >= step_after; }
  // Makes the optimistic times of this work less optimistic, because running it took too long.
  void reduce_optimism(CostId id);

  // Sets the factor of the constructor. If `for_all`, it replaces those of single costs.
  void set_uncertainty(double uncertainty, bool for_all = false);
  double uncertainty() const { return uncertainty_; }

  // Returns the current knowledge as a calibration of this device, sorted by name. Work that was
  // neither calibrated nor observed is left out.
  std::vector<Cost> calibration() const;

private:
  struct Line {
    std::string work;
    AffineCost prior;         // by the calibration
    double measured_like = 1; // factor on a placeholder, measured of the work that it stands for
    bool has_prior = false, placeholder = false; // placeholder: the prior is that of other work
    bool guess = false; // the prior is that of another pass type: unusable for the device's scale
    bool used = false;  // by add()
    double stated = 0;  // Cost::uncertainty
    double uncertainty = 1, pessimism = 1; // factors on the time of work that never ran
    LevelTracker own;                      // logarithm of the factor of this work
    double own_factor = 1;
    double usual = 0;       // `own` where nothing disturbs the work
    double usual_ratio = 1; // usual time to that of the last observation, if that was disturbed
    double seen_s = -1;     // time of the last observation, or of the first prediction
    AffineFit fit;          // for calibration()
    double frame_ms = 0;    // of the frame that is being observed: calibrated
    double frame_measured_ms = 0;
    bool in_frame = false;
  };
  double factor(const Line& line) const; // on the calibrated time
  AffineCost expected_cost(const Line& line) const;
  std::span<const uint32_t> timed() const { return std::span(timed_).first(timed_count_); }
  double log_error(const Line& line) const;
  bool is_absent(double seen_s, double now_s) const;
  const Line* placeholder_for(std::string_view work) const;
  void collect(std::span<const PassTime> passes, double now_s, double before_s);
  void follow_device();
  void follow_lines(double now_s);
  void recenter();
  void update_factors();
  static void update_usual_ratio(Line& line);

  std::vector<Line> lines_;
  std::vector<CostFactors> factors_; // by line
  // The first timed_count_: lines of the frame that is being observed. As long as lines_.
  std::vector<uint32_t> timed_;
  size_t timed_count_ = 0;
  LevelTracker device_;
  double device_factor_ = 1;
  double unmeasured_ = 0, unmeasured_factor_ = 1; // `own` of work that never ran
  double uncertainty_ = 1;
  double observed_s_ = -1e9;                    // time of the last frame with times
  double last_interval_s_ = 0, interval_s_ = 0; // between frames with times
};

} // namespace dermis::choice
