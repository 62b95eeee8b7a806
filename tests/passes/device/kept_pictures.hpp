#pragma once
// Pictures of one driver, stored in a folder and compared with those of another driver.
// DERMIS_PICTURES names the folder; DERMIS_PICTURES_KEEP stores pictures instead of comparing them
// (tests/scripts/run_on_drivers.sh).

#include <string>
#include <vector>

namespace dermis::testing {

struct KeptPictures {
  std::string folder; // Empty if no folder is named.
  bool keep = false;
};
KeptPictures kept_pictures();

void keep_floats(const std::string& path, const std::vector<float>& values);
// Returns an empty list if the file does not exist.
std::vector<float> kept_floats(const std::string& path);

// Returns the sorted absolute differences of equally many values. Two non-finite values are equal;
// one non-finite value gives infinity.
std::vector<double> differences(const std::vector<float>& here, const std::vector<float>& there);
// Returns the percentile of sorted, non-empty values; `fraction` is in 0 .. 1.
double percentile(const std::vector<double>& sorted, double fraction);
// Returns a text such as "median 0 <tab> p99 0.00098 <tab> p99.9 0.0034 <tab> most 0.032".
std::string reported_percentiles(const std::vector<double>& sorted);

} // namespace dermis::testing
