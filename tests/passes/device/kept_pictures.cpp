#include "tests/passes/device/kept_pictures.hpp"
#include "tests/support/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>

namespace dermis::testing {

KeptPictures kept_pictures() {
  const char* const folder = std::getenv("DERMIS_PICTURES");
  return {folder != nullptr ? folder : "", std::getenv("DERMIS_PICTURES_KEEP") != nullptr};
}

void keep_floats(const std::string& path, const std::vector<float>& values) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(float)));
}

std::vector<float> kept_floats(const std::string& path) {
  const std::string all = test::read_text(path);
  std::vector<float> values(all.size() / sizeof(float));
  std::memcpy(values.data(), all.data(), values.size() * sizeof(float));
  return values;
}

std::vector<double> differences(const std::vector<float>& here, const std::vector<float>& there) {
  std::vector<double> off;
  for (size_t i = 0; i < here.size(); ++i) {
    const bool finite = std::isfinite(here[i]);
    if (finite != std::isfinite(there[i]))
      off.push_back(std::numeric_limits<double>::infinity());
    else
      off.push_back(finite ? std::abs(double(here[i]) - double(there[i])) : 0.0);
  }
  std::sort(off.begin(), off.end());
  return off;
}

double percentile(const std::vector<double>& sorted, double fraction) {
  return sorted[static_cast<size_t>(fraction * double(sorted.size() - 1))];
}

std::string reported_percentiles(const std::vector<double>& sorted) {
  return fmt::format("median {:.2g}\tp99 {:.2g}\tp99.9 {:.2g}\tmost {:.2g}",
                     percentile(sorted, 0.5), percentile(sorted, 0.99), percentile(sorted, 0.999),
                     sorted.back());
}

} // namespace dermis::testing
