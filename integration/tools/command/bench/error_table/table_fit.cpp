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

// Returns whether the error counts for the table's point at d.
bool is_at(const MeasuredError& error, double d) {
  return error.half == "tuning" && std::abs(error.d_px / d - 1) <= same_d;
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
      if (error.technique == technique && is_at(error, d))
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

std::vector<choice::ReliefPoint> fit_relief(std::span<const MeasuredError> errors,
                                            std::span<const double> d_px) {
  std::vector<choice::ReliefPoint> curve;
  for (const double d : d_px) {
    std::map<std::string, std::vector<double>> logs;
    for (const MeasuredError& error : errors) // every technique has an error on the same scenes
      if (is_at(error, d) && error.relief >= 0)
        logs[error.scene_class].push_back(std::log(error.relief + choice::relief_floor));
    if (!logs.empty()) curve.push_back({d, to_three_digits(std::exp(class_mean(logs)))});
  }
  return curve;
}

double fit_relief_power(const choice::ErrorModel& table, int32_t row,
                        std::span<const MeasuredError> errors, const std::string& technique) {
  choice::ErrorModel with = table;
  double& power = row < 0 ? with.unscattered_relief_power
                          : with.techniques[static_cast<size_t>(row)].relief_power;
  // Both are deviations of one scene from the table, so their ratio is a slope through 0.
  std::map<std::string, std::vector<double>> products, squares;
  for (const MeasuredError& error : errors) {
    if (error.technique != technique || error.half != "tuning" || error.relief < 0) continue;
    power = 0;
    const double usual = std::log(expected_rmse(with, row, {error.d_px, error.relief}));
    power = 1;
    const double by_relief = std::log(expected_rmse(with, row, {error.d_px, error.relief})) - usual;
    products[error.scene_class].push_back(by_relief * (log_rmse(error) - usual));
    squares[error.scene_class].push_back(by_relief * by_relief);
  }
  const double square = squares.empty() ? 0 : class_mean(squares);
  const double fitted = square > 0 ? class_mean(products) / square : 0;
  return to_three_digits(std::clamp(fitted, -choice::max_relief_power, choice::max_relief_power));
}

void fit_table(choice::ErrorModel& table, std::span<const MeasuredError> errors,
               std::span<const double> d_px) {
  if (std::vector<choice::ReliefPoint> relief = fit_relief(errors, d_px); !relief.empty())
    table.relief = std::move(relief);
  const auto fit = [&](const std::string& technique, int32_t row,
                       std::vector<choice::ErrorPoint>& curve, double& power) {
    std::vector<choice::ErrorPoint> fitted = fit_curve(errors, technique, d_px);
    if (fitted.empty()) return;
    curve = std::move(fitted);
    power = fit_relief_power(table, row, errors, technique);
  };
  fit("off", -1, table.unscattered, table.unscattered_relief_power);
  for (size_t i = 0; i < table.techniques.size(); ++i)
    if (choice::TechniqueError& row = table.techniques[i]; !row.by_rays)
      fit(row_technique(row.name), static_cast<int32_t>(i), row.curve, row.relief_power);
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
    const double ratio =
        std::log(expected_rmse(table, row, {error.d_px, error.relief})) - log_rmse(error);
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
