#pragma once
// What a pass costs: milliseconds = base + per_group * groups, learned for each kind of work from timestamps.
// Robust against outliers, forgets slowly, and says how far it was off lately.

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

// One line of a calibration: what a kind of work costs on the device it was measured on.
struct Cost {
  std::string work;    // kind and settings: "subsurface.separable axis=vertical taps=25"
  double base_us = 0;  // microseconds a dispatch, >= 0
  double group_us = 0; // microseconds a workgroup, >= 0
  double spread = 0;   // typical relative deviation of one frame, 0 .. 1
};

struct Estimate {
  double ms = 0;
  double spread_ms = 0;  // typical deviation of one frame
  bool measured = false; // on this device; else from the calibration, scaled by what else was measured
};

// Costs known beforehand, and those seen since. One thread at a time; allocates in add() alone.
class CostModel {
public:
  explicit CostModel(std::vector<Cost> calibration = {});

  // The entry of a kind of work; made where there is none. Until it is measured, work of the same kind that
  // has most settings in common stands for it; without any, the costliest. Not while frames are recorded.
  CostId add(std::string_view work);

  Estimate estimate(CostId id, uint64_t groups) const;
  // What the calibration alone says: the same on every machine and in every run.
  double metered_ms(CostId id, uint64_t groups) const;
  // One timestamped run. Nothing is learned from times that are not finite or below 0.
  void observe(CostId id, uint64_t groups, double ms);

  // What is known now, sorted by name: a calibration of this device. Work that was neither calibrated nor
  // seen is left out.
  std::vector<Cost> calibration() const;

private:
  struct Line {
    std::string work;
    double prior[2] = {0, 0};                    // ms: base, and for unit_groups groups; of the calibration
    bool has_prior = false, placeholder = false; // placeholder: the prior is that of other work,
    bool guess = false;                          // of another kind even: it says nothing of the device
    uint64_t observations = 0;
    double moments[3] = {0, 0, 0}; // weighted sums of 1, x and x^2; x = groups / unit_groups
    double targets[2] = {0, 0};    // weighted sums of ms and ms * x
    double spread = 0;             // running mean of |residual| / time
  };
  struct Coefficients {
    double base_ms, unit_ms;
  };
  const Line* placeholder_for(std::string_view work) const;
  Coefficients solve(const Line& line) const;
  double device_scale() const; // of the calibration's times

  std::vector<Line> lines_;
  double scale_sum_ = 0, scale_weight_ = 0; // of log(measured / calibrated), over all lines
};

} // namespace dermis::choice
