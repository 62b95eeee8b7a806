// One case of one technique, judged pixel by pixel.
#include "integration/tools/command/bench/stability/judge.hpp"
#include "integration/tools/command/bench/stability/rows.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

bool judges_samples(Judged judged) {
  return judged == Judged::mean_samples || judged == Judged::samples_at_edge ||
         judged == Judged::samples_in_tile;
}

bool is_guided(const TechniqueRequest& request) {
  return std::any_of(request.set.begin(), request.set.end(),
                     [](const NamedValue& one) { return one.first == "guidance"; });
}

// One answer a frame: light, or what the kernels say of their samples.
demo::Result<std::vector<StabilityAnswer>> run_all(TechniqueRun& run, const StabilityCase& asked,
                                                   bool reference) {
  std::vector<StabilityAnswer> all;
  if (asked.same_as) run.start_anew(); // the same frame numbers draw the same samples
  for (uint32_t t = 0; t < asked.frames; ++t) {
    if (t == 0 && !reference && asked.frame_index > 0) run.skip_to(asked.frame_index);
    auto light = run.scatter((reference ? asked.same_as : asked.given)(t), t > 0 && asked.follows,
                             reference ? DepthGiven::view_distance : asked.depth);
    if (!light) return light.error();
    StabilityAnswer answer{light.take(), {}};
    if (judges_samples(asked.judged)) {
      auto samples = run.sampling();
      if (!samples) return samples.error();
      answer.samples = samples.take();
    }
    all.push_back(std::move(answer));
  }
  return all;
}

} // namespace

demo::Result<std::optional<StabilityRow>> run_case(TechniqueRun& run, const StabilityCase& asked,
                                                   const std::string& name) {
  if (asked.asked == Asked::guided && !is_guided(run.request())) return std::optional<StabilityRow>();
  if (asked.asked == Asked::of_profile && run.request().technique == "separable_jimenez")
    return std::optional<StabilityRow>();
  if (asked.asked == Asked::with_history) {
    if (auto once = run.scatter(asked.given(0)); !once) return once.error();
    if (run.history_bytes() == 0) return std::optional<StabilityRow>();
  }
  std::vector<StabilityAnswer> sound;
  if (asked.same_as) {
    auto ran = run_all(run, asked, true);
    if (!ran) return ran.error();
    sound = ran.take();
  }
  const auto found = run_all(run, asked, false);
  if (!found) return found.error();
  StabilityRow row;
  row.name = asked.name;
  row.technique = name;
  row.frames = asked.frames;
  row.bound = asked.bound;
  for (uint32_t t = 0; t < asked.frames; ++t) {
    const Judgement judgement = judge(asked, t, (*found)[t], asked.same_as ? &sound[t] : nullptr);
    row.nonfinite_pixels = std::max(row.nonfinite_pixels, judgement.nonfinite);
    row.negative_pixels = std::max(row.negative_pixels, judgement.negative);
    if (t >= asked.first_judged) row.max_abs_error = std::max(row.max_abs_error, judgement.error);
    if (asked.damage_ends > 0 && t >= asked.damage_ends && !row.recovered_after_frames &&
        judgement.error <= asked.bound)
      row.recovered_after_frames = t - asked.damage_ends + 1;
  }
  return std::optional<StabilityRow>(std::move(row));
}

} // namespace dermis::tools
