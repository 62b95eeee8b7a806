#pragma once
// Cost of a pass: milliseconds = base + per_group * groups, learned for each kind of work from
// timestamps. Robust against outliers, forgets slowly, and reports its recent deviation.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::choice {

// Index of a kind of work in a CostModel.
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
};

struct Estimate {
  double ms = 0;
  double spread_ms = 0; // typical deviation of one frame
  // measured on this device; otherwise from the calibration, scaled by other measurements
  bool measured = false;
};

// Calibrated costs and those observed since. One thread at a time; only add() allocates.
class CostModel {
public:
  explicit CostModel(std::vector<Cost> calibration = {});

  // Returns the entry of a kind of work; creates it if necessary. Until its first measurement, the
  // work of the same pass type with most equal settings is its placeholder; without any, the work
  // with the largest cost per group. Must not be called while frames are recorded.
  CostId add(std::string_view work);

  Estimate estimate(CostId id, uint64_t groups) const;
  // Returns the time by the calibration only, which is equal on all machines and in all runs.
  double calibrated_ms(CostId id, uint64_t groups) const;
  // Adds one timestamped run. Ignores times that are not finite or negative.
  void observe(CostId id, uint64_t groups, double ms);

  // Returns the current knowledge as a calibration of this device, sorted by name. Work that was
  // neither calibrated nor observed is left out.
  std::vector<Cost> calibration() const;

private:
  struct Line {
    std::string work;
    double prior[2] = {0, 0}; // prior of the calibration, ms: base, and for unit_groups groups
    bool has_prior = false, placeholder = false; // placeholder: the prior is that of other work
    // the prior is that of another pass type: unusable for the scale of the device
    bool guess = false;
    uint64_t observations = 0;
    double moments[3] = {0, 0, 0}; // weighted sums of 1, x and x^2; x = groups / unit_groups
    double targets[2] = {0, 0};    // weighted sums of ms and ms * x
    double spread = 0;             // moving mean of |residual| / time
  };
  struct Coefficients {
    double base_ms, unit_ms;
  };
  const Line* placeholder_for(std::string_view work) const;
  Coefficients solve(const Line& line) const;
  double device_scale() const; // factor on the calibration's times

  std::vector<Line> lines_;
  double scale_sum_ = 0, scale_weight_ = 0; // sums of log(measured / calibrated) over all lines
};

} // namespace dermis::choice
