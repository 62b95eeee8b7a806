#include "integration/tools/command/bench/stability/judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr uint32_t tile = 8;    // pixels per side
constexpr uint32_t period = 16; // two tiles, so that seams of groups of 16 are also found
constexpr uint32_t beside = 4;  // columns on either side of the middle that count as the edge

// Returns the required light of a frame, 3 values per pixel.
std::vector<float> wanted_light(const StabilityCase& requested, uint32_t t,
                                const CapturedFrame& frame) {
  std::vector<float> light(frame.lighting.values);
  if (requested.expected)
    for (size_t i = 0; i < frame.profile.size(); ++i)
      if (frame.profile[i] != 0)
        for (size_t c = 0; c < 3; ++c)
          light[3 * i + c] = static_cast<float>(requested.expected(t));
  return light;
}

struct Mean {
  double sum = 0;
  uint64_t count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  double value() const { return count > 0 ? sum / static_cast<double>(count) : 0; }
};

// Errors of light at pixels with a profile, in several statistics.
struct LightErrors {
  double largest = 0;
  Mean squares, all;
  std::array<Mean, period> columns, rows;

  void add(uint32_t x, uint32_t y, double error) {
    largest = std::max(largest, std::abs(error));
    squares.add(error * error);
    all.add(error);
    columns[x % period].add(error);
    rows[y % period].add(error);
  }
  double edges() const {
    double maximum = 0;
    for (const auto& lines : {columns, rows})
      for (const Mean& one : lines)
        maximum = std::max(maximum, std::abs(one.value() - all.value()));
    return maximum;
  }
};

// Returns the mean samples of pixels with a profile that `counts` selects.
template <class Counts>
Mean samples_of(const CapturedFrame& frame, const StabilityAnswer& answer, Counts counts) {
  Mean mean;
  for (uint32_t y = 0; y < frame.description.height; ++y)
    for (uint32_t x = 0; x < frame.description.width; ++x) {
      const size_t i = size_t{y} * frame.description.width + x;
      if (frame.profile[i] != 0 && counts(x, y)) mean.add(answer.samples[3 * i]);
    }
  return mean;
}

double beyond(double fraction) {
  return std::max({0.0, -fraction, fraction - 1});
}

double samples_at_edge(const CapturedFrame& frame, const StabilityAnswer& answer) {
  const uint32_t middle = frame.description.width / 2;
  const double mean = samples_of(frame, answer, [&](uint32_t x, uint32_t) {
                        return x + beside >= middle && x < middle + beside;
                      }).value();
  constexpr double minimum = 8;
  return mean > 0 ? minimum / mean : infinity;
}

double samples_in_tile(const CapturedFrame& frame, const StabilityAnswer& answer) {
  double worst = 0;
  for (uint32_t y = 0; y < frame.description.height; y += tile)
    for (uint32_t x = 0; x < frame.description.width; x += tile) {
      double maximum = 0;
      const double mean =
          samples_of(frame, answer, [&](uint32_t i, uint32_t j) {
            if (i / tile != x / tile || j / tile != y / tile) return false;
            maximum = std::max(
                maximum, double(answer.samples[3 * (size_t{j} * frame.description.width + i)]));
            return true;
          }).value();
      if (mean > 0) worst = std::max(worst, maximum / mean);
    }
  return worst > 0 ? worst : infinity;
}

double mean_samples(const CapturedFrame& frame, const StabilityAnswer& found,
                    const StabilityAnswer& sound) {
  const auto all = [](uint32_t, uint32_t) { return true; };
  const double difference =
      std::abs(samples_of(frame, found, all).value() / samples_of(frame, sound, all).value() - 1);
  return std::isfinite(difference) ? difference : infinity; // NaN would compare as within the bound
}

double samples_error(const StabilityCase& requested, const CapturedFrame& frame,
                     const StabilityAnswer& found, const StabilityAnswer* sound) {
  // the graph does not export samples
  if (found.samples.size() != frame.lighting.values.size()) return infinity;
  if (requested.metric == Metric::samples_at_edge) return samples_at_edge(frame, found);
  if (requested.metric == Metric::samples_in_tile) return samples_in_tile(frame, found);
  return sound != nullptr ? mean_samples(frame, found, *sound) : infinity;
}

} // namespace

Judgement judge(const StabilityCase& requested, uint32_t t, const StabilityAnswer& found,
                const StabilityAnswer* sound) {
  // The frame determines the judged pixels: those without a profile or depth are not judged.
  const CapturedFrame frame = requested.same_as ? requested.same_as(t) : requested.given(t);
  const std::vector<float> expected =
      sound != nullptr ? sound->light : wanted_light(requested, t, frame);
  Judgement judgement;
  LightErrors errors;
  const uint32_t width = frame.description.width, height = frame.description.height;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const size_t i = size_t{y} * width + x;
      bool finite = true, negative = false;
      for (size_t c = 0; c < 3; ++c) {
        finite = finite && std::isfinite(found.light[3 * i + c]);
        negative = negative || found.light[3 * i + c] < 0;
      }
      judgement.nonfinite += finite ? 0 : 1;
      judgement.negative += finite && negative ? 1 : 0;
      const bool inside = x >= requested.margin && x + requested.margin < width &&
                          y >= requested.margin && y + requested.margin < height;
      if (!finite || requested.finite_only || frame.profile[i] == 0 || !inside) continue;
      for (size_t c = requested.first_channel; c < 3; ++c)
        if (requested.metric == Metric::light_beyond)
          errors.add(x, y, beyond(double(found.light[3 * i + c]) / requested.scale));
        else
          errors.add(x, y,
                     (double(found.light[3 * i + c]) - double(expected[3 * i + c])) /
                         requested.scale);
    }
  switch (requested.metric) {
  case Metric::light:
  case Metric::light_beyond:
    judgement.error = errors.largest;
    break;
  case Metric::light_rms:
    judgement.error = std::sqrt(errors.squares.value());
    break;
  case Metric::tile_edges:
    judgement.error = errors.edges();
    break;
  case Metric::mean_samples:
  case Metric::samples_at_edge:
  case Metric::samples_in_tile:
    judgement.error = samples_error(requested, frame, found, sound);
    break;
  }
  return judgement;
}

} // namespace dermis::tools
