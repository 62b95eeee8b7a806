// Measures how much of its scattered light each point of a surface shows under technique=partial of
// skin.json, from frame to frame: while the camera moves, at rest, and after a cut of the budget.
#include "tests/properties/sequences.hpp"

#include "integration/examples/demo_engine/dermis_calls.hpp"
#include "passes/choice/tile_selection.hpp"
#include "passes/choice/time_margin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace {

using namespace dermis;
using namespace dermis::tools;

constexpr uint32_t width = 320, height = 180;
// Weights are measured where scattering changes light by this fraction of it.
constexpr double least_change = 0.1;
// Light of two pictures is rounded to half floats twice, each time by up to 2^-12 of the light.
constexpr double rounding = 4 * 0x1p-12 / least_change;
constexpr double largest_step = 0.125;
// A point is the same if its depth differs by this fraction, which a zoom of 3 % per frame exceeds
// only at edges.
constexpr double same_depth = 0.05;

// A listed tile costs 1 us, all other work nothing.
const std::string tile_times = R"({ "dermis_calibration": 2, "device": "invented",
  "costs": [
  { "work": "subsurface.separable_selected axis=horizontal taps=25 texturing=post", "base_us": 0, "group_us": 1, "spread": 0 },
  { "work": "subsurface.separable_selected axis=vertical taps=25 texturing=post", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.classify texturing=post", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.tile_change", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.tile_histogram", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.select_tiles", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.tile_list", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.probe texturing=post tiles=8 interval=4", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.export_scattered texturing=post leave_scattered=false", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.combine texturing=post result=color copied=unscattered", "base_us": 0, "group_us": 0, "spread": 0 } ] })";

// Fraction of scattered light by pixel; NaN where scattering changes little.
using Weights = std::vector<double>;

struct Change {
  double largest = 0; // of a point between two frames
  size_t points = 0;  // compared
  uint32_t tiles = 0; // whose mean weight changed by more than largest_step
};

class PartialMotion : public properties::SequenceTest {
protected:
  static Sequence frames_of(const std::string& scene, uint32_t first, uint32_t count) {
    auto sequence = render_sequence({scene, "natural",
                                     properties::root() + "/configs/scenes/" + scene + ".json", 0,
                                     first, count, false},
                                    width, height, {});
    EXPECT_TRUE(sequence) << sequence.error().text;
    return sequence ? sequence.take() : Sequence{};
  }

  std::unique_ptr<TechniqueRun> make_run(const Sequence& sequence, const char* technique) {
    auto run = TechniqueRun::create(properties::shared_host(),
                                    properties::request_of("skin", {{"technique", technique}}),
                                    sequence.frames.front().captured.description.profiles, {});
    EXPECT_TRUE(run) << run.error().text;
    return run ? run.take() : nullptr;
  }

  static std::vector<float> scatter(TechniqueRun& run, const CapturedFrame& frame, bool follows) {
    auto light = run.scatter(frame, follows);
    EXPECT_TRUE(light) << light.error().text;
    return light ? light.take() : std::vector<float>();
  }

  // Lets tiles scatter in the next frames.
  static void set_units(TechniqueRun& run, uint32_t units) {
    dermis_budget budget = DERMIS_BUDGET_INIT;
    budget.milliseconds =
        (float(units) + 0.5f) / 1000 * std::exp(static_cast<float>(choice::calibrated_margin));
    budget.flags = DERMIS_BUDGET_DETERMINISTIC;
    const dermis_source calibration = demo::source_of("invented", tile_times);
    budget.calibration = &calibration;
    const auto set = run.set_budget(budget);
    ASSERT_TRUE(set) << set.error().text;
  }

  static Weights weights_of(const CapturedFrame& frame, const std::vector<float>& none,
                            const std::vector<float>& all, const std::vector<float>& some) {
    Weights weights(frame.profile.size(), std::numeric_limits<double>::quiet_NaN());
    for (size_t i = 0; i < weights.size(); ++i) {
      if (frame.profile[i] == 0) continue;
      double shown = 0, change = 0, light = 0;
      for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
        const double full = double(all[c]) - double(none[c]);
        shown += full * (double(some[c]) - double(none[c]));
        change += full * full;
        light += double(none[c]) * double(none[c]);
      }
      if (change > least_change * least_change * light) weights[i] = shown / change;
    }
    return weights;
  }

  // Compares the weights of points of surfaces that both frames show.
  static Change change_of(const CapturedFrame& frame, const Weights& now,
                          const CapturedFrame& earlier, const Weights& before) {
    Change out;
    constexpr uint32_t across = (width + 7) / 8;
    std::array<double, across*((height + 7) / 8)> sum{}, count{};
    const size_t channels = frame.velocity.values.size() / frame.profile.size();
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width; ++x) {
        const size_t i = size_t{y} * width + x;
        if (std::isnan(now[i])) continue;
        const double from_x =
                         x - (channels > 0 ? double(frame.velocity.values[channels * i]) : 0.0),
                     from_y =
                         y - (channels > 0 ? double(frame.velocity.values[channels * i + 1]) : 0.0);
        const double left = std::floor(from_x), top = std::floor(from_y);
        if (left < 0 || top < 0 || left > width - 2 || top > height - 2) continue;
        double weight = 0;
        for (int k = 0; k < 4; ++k) {
          const size_t tap = (size_t(top) + size_t(k >> 1)) * width + size_t(left) + size_t(k & 1);
          const double right_part = from_x - left, lower_part = from_y - top;
          const double part = ((k & 1) != 0 ? right_part : 1 - right_part) *
                              ((k >> 1) != 0 ? lower_part : 1 - lower_part);
          const bool same =
              earlier.profile[tap] == frame.profile[i] &&
              std::abs(double(earlier.depth.values[tap]) / double(frame.depth.values[i]) - 1) <
                  same_depth;
          if (part > 0) weight += same ? part * before[tap] : std::nan("");
        }
        if (std::isnan(weight)) continue;
        out.largest = std::max(out.largest, std::abs(now[i] - weight));
        ++out.points;
        sum[y / 8 * across + x / 8] += now[i] - weight;
        count[y / 8 * across + x / 8] += 1;
      }
    for (size_t tile = 0; tile < sum.size(); ++tile)
      out.tiles += std::abs(sum[tile]) > largest_step * count[tile] && count[tile] > 4 ? 1 : 0;
    return out;
  }

  // Runs the frames with a budget for this fraction of the tiles, which begins after the first.
  void expect_slow_changes(const Sequence& sequence, double fraction) {
    auto off = make_run(sequence, "off"), full = make_run(sequence, "separable"),
         partial = make_run(sequence, "partial");
    ASSERT_TRUE(off && full && partial);
    Weights before;
    double largest = 0, listed = 0;
    size_t points = 0;
    uint32_t tiles = 0;
    for (uint32_t t = 0; t < sequence.frames.size(); ++t) {
      const CapturedFrame& frame = sequence.frames[t].captured;
      const std::vector<float> none = scatter(*off, frame, t > 0),
                               all = scatter(*full, frame, t > 0),
                               some = scatter(*partial, frame, t > 0);
      if (HasFailure()) return;
      const auto choice = partial->choice();
      ASSERT_TRUE(choice);
      set_units(*partial, static_cast<uint32_t>(fraction * choice->sample_demand));
      if (t > 10) listed += double(choice->sample_units) / choice->sample_demand;
      const Weights now = weights_of(frame, none, all, some);
      if (t > 0) {
        const Change change = change_of(frame, now, sequence.frames[t - 1].captured, before);
        EXPECT_LE(change.largest, largest_step + rounding) << "frame " << t;
        EXPECT_EQ(change.tiles, 0u) << "frame " << t;
        largest = std::max(largest, change.largest);
        points += change.points;
        tiles += change.tiles;
      }
      before = now;
    }
    EXPECT_GT(points, 100 * sequence.frames.size());
    listed /= double(sequence.frames.size() - 11);
    RecordProperty("largest_change", std::to_string(largest));
    RecordProperty("switched_tiles_per_frame",
                   std::to_string(tiles / double(sequence.frames.size() - 1)));
    RecordProperty("listed", std::to_string(listed));
    EXPECT_NEAR(listed, fraction, 0.1 * fraction);
  }
};

TEST_F(PartialMotion, Pan_NoPointChangesByMoreThanAnEighth) {
  expect_slow_changes(frames_of("pan", 20, 32), 0.3);
}

TEST_F(PartialMotion, Dolly_NoPointChangesByMoreThanAnEighth) {
  expect_slow_changes(frames_of("dolly", 90, 28), 0.3);
}

// With damaged inputs, the pixels that represent full tiles have no depth or no velocity.
class PartialCut : public PartialMotion, public ::testing::WithParamInterface<bool> {};
INSTANTIATE_TEST_SUITE_P(Inputs, PartialCut, ::testing::Bool(), [](const auto& one) {
  return std::string(one.param ? "Damaged" : "Sound");
});

TEST_P(PartialCut, BudgetCutAtRest_FadesThenStays) {
  Sequence sequence = properties::standing_still(frames_of("pan", 40, 1), 1);
  CapturedFrame& frame = sequence.frames.front().captured;
  const size_t channels = frame.velocity.values.size() / frame.profile.size();
  for (uint32_t y = 4; GetParam() && y < height; y += 8)
    for (uint32_t x = 4; x < width; x += 8) {
      const size_t i = size_t{y} * width + x;
      if (x % 16 == 4)
        frame.depth.values[i] = 0;
      else
        std::fill_n(frame.velocity.values.begin() + static_cast<ptrdiff_t>(channels * i), channels,
                    std::numeric_limits<float>::quiet_NaN());
    }
  auto off = make_run(sequence, "off"), full = make_run(sequence, "separable"),
       partial = make_run(sequence, "partial");
  ASSERT_TRUE(off && full && partial);
  const std::vector<float> none = scatter(*off, frame, false), all = scatter(*full, frame, false);
  std::vector<float> last = scatter(*partial, frame, false);
  const uint32_t demand = partial->choice()->sample_demand;
  const auto settle = [&](double fraction) {
    set_units(*partial, static_cast<uint32_t>(fraction * demand));
    uint32_t changing = 0; // last frame with a change
    for (uint32_t t = 1; t <= 75; ++t) {
      const std::vector<float> some = scatter(*partial, frame, true);
      const Change change = change_of(frame, weights_of(frame, none, all, some), frame,
                                      weights_of(frame, none, all, last));
      EXPECT_LE(change.largest, largest_step + (GetParam() ? 2 : 1) * rounding) << "frame " << t;
      if (some != last) changing = t;
      last = some;
    }
    EXPECT_LE(partial->choice()->sample_units, fraction * demand);
    return changing;
  };
  for (const double fraction : {0.6, 0.15}) {
    const uint32_t frames = settle(fraction);
    EXPECT_GE(frames, 8u) << fraction;
    EXPECT_LE(frames, 60u) << fraction; // at rest, nothing changes
  }
}

} // namespace
