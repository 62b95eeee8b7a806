#pragma once
// Pictures of one driver, kept in a folder and held against those of another one. DERMIS_PICTURES names the
// folder; with DERMIS_PICTURES_KEEP pictures are kept there, without it compared
// (tests/scripts/run_on_drivers.sh).

#include <string>
#include <vector>

namespace dermis::testing {

struct KeptPictures {
  std::string folder; // empty: none is named
  bool keep = false;
};
KeptPictures kept_pictures();

void keep_floats(const std::string& path, const std::vector<float>& values);
std::vector<float> kept_floats(const std::string& path); // empty where there is no file

// How far values are off from others, as many, sorted. Two that are both no finite numbers are equal; one
// alone is off by infinity.
std::vector<double> differences(const std::vector<float>& here, const std::vector<float>& there);
// Of sorted values, one at least; share: 0 .. 1.
double percentile(const std::vector<double>& sorted, double fraction);
// "median 0 <tab> p99 0.00098 <tab> p99.9 0.0034 <tab> most 0.032"
std::string reported_percentiles(const std::vector<double>& sorted);

} // namespace dermis::testing
