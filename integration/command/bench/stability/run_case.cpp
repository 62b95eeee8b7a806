// One case of one technique, judged pixel by pixel.
#include "integration/command/bench/stability/rows.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

struct Judged {
  uint64_t nonfinite = 0;
  double error = 0;   // largest
  double squares = 0; // of all errors
  uint64_t values = 0;
};

// What a frame must give, 3 values a pixel.
std::vector<float> wanted_light(const CapturedFrame& frame, double level) {
  std::vector<float> light(frame.lighting.values);
  for (size_t i = 0; i < frame.profile.size(); ++i)
    if (frame.profile[i] != 0)
      for (size_t c = 0; c < 3; ++c)
        light[3 * i + c] = static_cast<float>(level);
  return light;
}

Judged judge(const std::vector<float>& found, const std::vector<float>* wanted, const CapturedFrame& frame,
             double scale) {
  Judged judged;
  for (size_t i = 0; i < frame.profile.size(); ++i) {
    bool finite = true;
    for (size_t c = 0; c < 3; ++c)
      finite = finite && std::isfinite(found[3 * i + c]);
    judged.nonfinite += finite ? 0 : 1;
    // A frame in which a pixel has no profile, or no place, says nothing of its light.
    if (!finite || wanted == nullptr || frame.profile[i] == 0) continue;
    for (size_t c = 0; c < 3; ++c) {
      const double error = std::abs(double(found[3 * i + c]) - double((*wanted)[3 * i + c])) / scale;
      judged.error = std::max(judged.error, error);
      judged.squares += error * error;
      ++judged.values;
    }
  }
  return judged;
}

demo::Result<std::vector<std::vector<float>>> run_all(TechniqueRun& run, const StabilityCase& asked,
                                                      const std::function<CapturedFrame(uint32_t)>& frames,
                                                      bool numbered) {
  std::vector<std::vector<float>> all;
  if (asked.same_as) run.start_anew(); // the same frame numbers draw the same samples
  for (uint32_t t = 0; t < asked.frames; ++t) {
    if (t == 0 && numbered && asked.frame_index > 0) run.skip_to(asked.frame_index);
    auto light = run.scatter(frames(t), t > 0 && asked.follows);
    if (!light) return light.error();
    all.push_back(light.take());
  }
  return all;
}

} // namespace

demo::Result<std::optional<StabilityRow>> run_case(TechniqueRun& run, const StabilityCase& asked,
                                                   const std::string& name) {
  if (asked.needs_history) {
    if (auto once = run.scatter(asked.given(0)); !once) return once.error();
    if (run.history_bytes() == 0) return std::optional<StabilityRow>();
  }
  std::vector<std::vector<float>> wanted;
  if (asked.same_as) {
    auto sound = run_all(run, asked, asked.same_as, false);
    if (!sound) return sound.error();
    wanted = sound.take();
  }
  const auto found = run_all(run, asked, asked.given, true);
  if (!found) return found.error();
  StabilityRow row;
  row.name = asked.name;
  row.technique = name;
  row.frames = asked.frames;
  row.bound = asked.bound;
  for (uint32_t t = 0; t < asked.frames; ++t) {
    const CapturedFrame frame = asked.given(t), judged_by = asked.same_as ? asked.same_as(t) : frame;
    if (asked.wanted) wanted.push_back(wanted_light(frame, asked.wanted(t)));
    const Judged judged =
        judge((*found)[t], asked.finite_only ? nullptr : &wanted[t], judged_by, asked.scale);
    row.nonfinite_pixels = std::max(row.nonfinite_pixels, judged.nonfinite);
    const double error = asked.mean_square && judged.values > 0
                             ? std::sqrt(judged.squares / static_cast<double>(judged.values))
                             : judged.error;
    if (t >= asked.first_judged) row.max_abs_error = std::max(row.max_abs_error, error);
    if (asked.damage_ends > 0 && t >= asked.damage_ends && !row.recovered_after_frames &&
        error <= asked.bound)
      row.recovered_after_frames = t - asked.damage_ends + 1;
  }
  return std::optional<StabilityRow>(std::move(row));
}

} // namespace dermis::tools
