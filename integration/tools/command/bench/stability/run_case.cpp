// Runs one case on one technique and judges each pixel.
#include "integration/tools/command/bench/stability/judge.hpp"
#include "integration/tools/command/bench/stability/rows.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

bool judges_samples(Metric metric) {
  return metric == Metric::mean_samples || metric == Metric::samples_at_edge ||
         metric == Metric::samples_in_tile;
}

bool is_guided(const TechniqueRequest& request) {
  return std::any_of(request.set.begin(), request.set.end(),
                     [](const NamedValue& one) { return one.first == "guidance"; });
}

// Returns one result per frame: light, or the kernels' sampling data.
demo::Result<std::vector<StabilityAnswer>> run_all(TechniqueRun& run,
                                                   const StabilityCase& requested, bool reference) {
  std::vector<StabilityAnswer> all;
  if (requested.same_as) run.start_anew(); // equal frame numbers give equal samples
  for (uint32_t t = 0; t < requested.frames; ++t) {
    if (t == 0 && !reference && requested.frame_index > 0) run.skip_to(requested.frame_index);
    auto light = run.scatter((reference ? requested.same_as : requested.given)(t),
                             t > 0 && requested.follows,
                             reference ? DepthGiven::view_distance : requested.depth);
    if (!light) return light.error();
    StabilityAnswer answer{light.take(), {}};
    if (judges_samples(requested.metric)) {
      auto samples = run.sampling();
      if (!samples) return samples.error();
      answer.samples = samples.take();
    }
    all.push_back(std::move(answer));
  }
  return all;
}

} // namespace

demo::Result<std::optional<StabilityRow>>
run_case(TechniqueRun& run, const StabilityCase& requested, const std::string& name) {
  if (requested.applies_to == AppliesTo::guided && !is_guided(run.request()))
    return std::optional<StabilityRow>();
  if (requested.applies_to == AppliesTo::of_profile &&
      run.request().technique == "separable_jimenez")
    return std::optional<StabilityRow>();
  if (requested.applies_to == AppliesTo::with_history) {
    if (auto once = run.scatter(requested.given(0)); !once) return once.error();
    if (run.history_bytes() == 0) return std::optional<StabilityRow>();
  }
  std::vector<StabilityAnswer> sound;
  if (requested.same_as) {
    auto ran = run_all(run, requested, true);
    if (!ran) return ran.error();
    sound = ran.take();
  }
  const auto found = run_all(run, requested, false);
  if (!found) return found.error();
  StabilityRow row;
  row.name = requested.name;
  row.technique = name;
  row.frames = requested.frames;
  row.bound = requested.bound;
  for (uint32_t t = 0; t < requested.frames; ++t) {
    const Judgement judgement =
        judge(requested, t, (*found)[t], requested.same_as ? &sound[t] : nullptr);
    row.nonfinite_pixels = std::max(row.nonfinite_pixels, judgement.nonfinite);
    row.negative_pixels = std::max(row.negative_pixels, judgement.negative);
    if (t >= requested.first_judged)
      row.max_abs_error = std::max(row.max_abs_error, judgement.error);
    if (requested.damage_ends > 0 && t >= requested.damage_ends && !row.recovered_after_frames &&
        judgement.error <= requested.bound)
      row.recovered_after_frames = t - requested.damage_ends + 1;
  }
  return std::optional<StabilityRow>(std::move(row));
}

} // namespace dermis::tools
