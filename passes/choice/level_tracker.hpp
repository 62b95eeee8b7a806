#pragma once
// Follows the level of a noisy value, here the logarithm of a ratio of times. Smooths noise,
// ignores single outliers, and follows a step of the level immediately.

namespace dermis::choice {

// Plain data; starts without observations.
struct LevelTracker {
  double level = 0;
  double deviation = 0.1;    // moving mean of |residual|; starts at that of a usual timestamp
  int observations = 0;      // since the start
  int since_restart = 0;     // since the start or the last restart()
  int outliers_in_a_row = 0; // residuals beyond the limit, of one sign
  int outlier_sign = 0;
  double smallest_outlier = 0; // of those in a row
};

// A residual beyond this many deviations is an outlier (Huber 1964).
inline constexpr double outlier_deviations = 3;
// With as many outliers of one sign in a row the level has stepped.
inline constexpr int step_after = 3;
// With as many observations after a restart the level is known.
inline constexpr int known_after = 3;

// Adds the residual `observation - level`. `gain` is the weight of an observation once the tracker
// has settled; outliers are relative to `deviation`.
void follow(LevelTracker& tracker, double residual, double gain, double deviation);
// Trusts the next observations like the first ones: the level may have changed unseen.
void restart(LevelTracker& tracker);

} // namespace dermis::choice
