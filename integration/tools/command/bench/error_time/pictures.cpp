#include "integration/tools/command/bench/error_time/pictures.hpp"

#include "framegraph/model/splitmix.hpp"
#include "integration/tools/files/exr.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace dermis::tools {
namespace {

constexpr size_t resamples = 1000;
constexpr uint64_t resample_seed = 1;

// Returns the squared error of exposed luminance at each pixel of the reference.
std::vector<double> squared_errors(std::span<const float> light, const Reference& reference) {
  std::vector<double> squares;
  squares.reserve(reference.pixels.size());
  for (size_t i = 0; i < reference.pixels.size(); ++i) {
    const double error = (luminance_of(&light[size_t{3} * reference.pixels[i]]) -
                          luminance_of(&reference.light[3 * i])) *
                         reference.exposure;
    squares.push_back(error * error);
  }
  return squares;
}

} // namespace

demo::Result<> write_captures(const std::string& folder, std::span<const Subject> subjects,
                              std::span<const CaptureProfile> profiles) {
  CaptureWriter writer;
  std::string problem;
  bool good = writer.begin(folder, problem);
  for (size_t i = 0; good && i < subjects.size(); ++i) {
    CapturedFrame frame = subjects[i].frame;
    frame.description.profiles.assign(profiles.begin(), profiles.end());
    good = writer.add(frame, problem);
  }
  if (good && writer.finish(problem)) return demo::success();
  return demo::Error{demo::ErrorKind::environment, problem};
}

demo::Result<std::vector<float>> read_picture(const std::string& folder, size_t number,
                                              uint32_t width, uint32_t height) {
  const auto path =
      std::filesystem::path(folder) / fmt::format("frame_{:04}", number) / "scattered.exr";
  std::string problem;
  const ChannelNames names[] = {rgb_names};
  auto image = read_exr(path, names, problem);
  if (image && (image->width != width || image->height != height))
    problem = fmt::format("'{}' is {} x {} instead of {} x {} pixels", path.string(), image->width,
                          image->height, width, height);
  if (!problem.empty()) return demo::Error{demo::ErrorKind::input, problem};
  return std::move(image->values);
}

std::optional<PairedRatio> paired_ratio(std::span<const float> light, std::span<const float> other,
                                        const Reference& reference) {
  const std::vector<double> own = squared_errors(light, reference),
                            base = squared_errors(other, reference);
  double own_sum = 0, base_sum = 0;
  for (size_t i = 0; i < own.size(); ++i) {
    own_sum += own[i];
    base_sum += base[i];
  }
  if (!(base_sum > 0)) return std::nullopt;
  const double ratio = std::sqrt(own_sum / base_sum);
  if (reference.everywhere) return PairedRatio{ratio, ratio, ratio};
  SplitMix64 random{resample_seed};
  std::vector<double> ratios(resamples);
  for (double& one : ratios) {
    double own_part = 0, base_part = 0;
    for (size_t i = 0; i < own.size(); ++i) {
      const size_t at = random.below(own.size());
      own_part += own[at];
      base_part += base[at];
    }
    one = base_part > 0 ? std::sqrt(own_part / base_part) : ratio;
  }
  std::sort(ratios.begin(), ratios.end());
  return PairedRatio{ratio, ratios[resamples / 40], ratios[resamples - 1 - resamples / 40]};
}

} // namespace dermis::tools
