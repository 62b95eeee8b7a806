#include "integration/tools/command/bench/error_table/table_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace dermis::tools {
namespace {

constexpr double min_counted_rmse = 1e-5; // 100 dB: smaller errors only measure rounding
constexpr double same_d = 0.15;           // cameras of rendered scenes meet a d within 2 %

double log_rmse(const MeasuredError& error) {
  return std::log(std::max(error.rmse, min_counted_rmse));
}

// Returns the mean over classes of the means of their values.
double class_mean(const std::map<std::string, std::vector<double>>& by_class) {
  double sum = 0;
  for (const auto& [name, values] : by_class) {
    double sum_of_class = 0;
    for (const double value : values)
      sum_of_class += value;
    sum += sum_of_class / double(values.size());
  }
  return sum / double(by_class.size());
}

// Rounds to three digits, so that tables stay readable.
double to_three_digits(double value) {
  return std::stod(fmt::format("{:.3g}", value));
}

std::string row_technique(const std::string& name) {
  return name.substr(0, name.find(','));
}

} // namespace

std::vector<choice::ErrorPoint> fit_curve(std::span<const MeasuredError> errors,
                                          const std::string& technique,
                                          std::span<const double> d_px) {
  std::vector<choice::ErrorPoint> curve;
  for (const double d : d_px) {
    std::map<std::string, std::vector<double>> logs;
    for (const MeasuredError& error : errors)
      if (error.technique == technique && error.half == "tuning" &&
          std::abs(error.d_px / d - 1) <= same_d)
        logs[error.scene_class].push_back(log_rmse(error));
    if (logs.empty()) continue;
    const double mean = class_mean(logs);
    for (auto& [name, values] : logs)
      for (double& value : values)
        value = (value - mean) * (value - mean);
    curve.push_back({d, to_three_digits(std::exp(mean)),
                     to_three_digits(std::exp(std::sqrt(class_mean(logs))))});
  }
  return curve;
}

void fit_table(choice::ErrorModel& table, std::span<const MeasuredError> errors,
               std::span<const double> d_px) {
  const auto fit = [&](const std::string& technique, std::vector<choice::ErrorPoint>& curve) {
    std::vector<choice::ErrorPoint> fitted = fit_curve(errors, technique, d_px);
    if (!fitted.empty()) curve = std::move(fitted);
  };
  fit("off", table.unscattered);
  for (choice::TechniqueError& row : table.techniques)
    if (!row.by_rays) fit(row_technique(row.name), row.curve);
}

PredictionError judge_table(const choice::ErrorModel& table, std::span<const MeasuredError> errors,
                            const std::string& technique, const std::string& half) {
  int32_t row = -1; // unscattered
  for (size_t i = 0; i < table.techniques.size(); ++i)
    if (table.techniques[i].name == technique) row = static_cast<int32_t>(i);
  PredictionError out;
  if (row < 0 && technique != "off") return out;
  double squares = 0;
  for (const MeasuredError& error : errors) {
    if (error.technique != technique || error.half != half) continue;
    const double ratio = std::log(expected_rmse(table, row, error.d_px)) - log_rmse(error);
    ++out.scenes;
    out.mean += ratio;
    squares += ratio * ratio;
  }
  if (out.scenes == 0) return out;
  out.mean /= double(out.scenes);
  out.rms = std::sqrt(squares / double(out.scenes));
  return out;
}

} // namespace dermis::tools
