// Tests the number of samples that guidance takes over frames: the number follows the light's
// relative variation in any unit.
#include "tests/framegraph/test_scale.hpp"
#include "tests/properties/noise.hpp"
#include "tests/properties/sequences.hpp"

#include <cmath>
#include <string_view>

namespace {

using namespace dermis;
using namespace dermis::tools;
using properties::Judge;
using properties::SequenceRun;

class GuidedSequence : public properties::SequenceTest {
protected:
  static TechniqueRequest guided(const std::string& guidance, std::vector<NamedValue> set = {}) {
    set.emplace_back("guidance", guidance);
    return properties::request_of("afis_guided", set);
  }
};

TEST_F(GuidedSequence, UnitsAndExposure_DoNotChangeSampleCounts) {
  // From frame 6 on the host's light is 16 times smaller and the exposure 16 times larger.
  constexpr uint32_t frames = 12, changed = 6;
  const Sequence same = properties::standing_still(frames_of("pan", 40, 1), frames);
  Sequence other = same;
  for (uint32_t t = changed; t < frames; ++t) {
    CapturedFrame& frame = other.frames[t].captured;
    for (float& value : frame.lighting.values)
      value /= 16; // Exact in half floats.
    frame.description.exposure *= 16;
  }
  Judge judge{same}, other_judge{other};
  for (const char* guidance : {"spvg", "split_half", "ccv", "ocv"}) {
    if (guidance == std::string_view("ccv") && dermis::testing::seeds_to_try(0, 1) == 0) break;
    const SequenceRun one = run(judge, guided(guidance), {}),
                      two = run(other_judge, guided(guidance), {});
    ASSERT_EQ(one.samples.size(), frames);
    ASSERT_EQ(two.samples.size(), frames);
    for (uint32_t t = 0; t < frames; ++t)
      // Light below 1e-3 loses bits in half floats.
      EXPECT_NEAR(two.samples[t], one.samples[t], 1e-3 * one.samples[t])
          << guidance << ", frame " << t;
  }
}

TEST_F(GuidedSequence, GlobalFlicker_ControlNeedsNoMoreSamples) {
  DERMIS_FULL_TESTS_ONLY();
  // All light times 1 +- 0.02, random in each frame, like candles and compressed textures.
  constexpr uint32_t frames = 36, counted = 18;
  Sequence sequence = properties::standing_still(frames_of("pan", 40, 1), frames);
  for (uint32_t t = 0; t < frames; ++t)
    for (float& value : sequence.frames[t].captured.lighting.values)
      value *= 1 + 0.02f * (2 * properties::noise(t, 0) - 1);
  Judge judge{sequence};
  const auto mean = [&](const char* guidance) {
    const SequenceRun one = run(judge, guided(guidance), {});
    double sum = 0;
    for (uint32_t t = counted; t < frames; ++t)
      sum += one.samples.at(t) / (frames - counted);
    RecordProperty(guidance, std::to_string(sum));
    return sum;
  };
  const double none = mean("spvg");
  EXPECT_LE(mean("ocv"), 1.005 * none); // C16; 0.5 % for the rounding of whole samples.
}

// Jitter changes the pixel's own light most, which no guidance watches, and the control by the mean
// of its neighbours least. With the whole light spvg takes 2.2 times its samples at rest.
TEST_F(GuidedSequence, Jitter_TakesAtMostAFifthMoreSamples) {
  constexpr uint32_t frames = 24, counted = 16; // two periods of the jitter
  const auto bust = [](bool jitter) {
    SequenceRequest request{"bust", "natural", properties::root() + "/configs/scenes/bust.json"};
    request.frames = frames;
    request.jitter = jitter;
    auto rendered =
        render_sequence(request, properties::larger_width, properties::larger_height, {});
    EXPECT_TRUE(rendered) << rendered.error().text;
    return rendered ? rendered.take() : Sequence{};
  };
  const Sequence still = bust(false), moving = bust(true);
  ASSERT_EQ(still.frames.size(), frames);
  ASSERT_NE(moving.frames[1].captured.description.jitter_px,
            moving.frames[2].captured.description.jitter_px);
  Judge judge{still}, moving_judge{moving};
  const auto samples = [&](Judge& judged, const TechniqueRequest& request) {
    const SequenceRun one = run(judged, request, {});
    double sum = 0;
    for (uint32_t t = counted; t < frames; ++t)
      sum += one.samples.at(t) / (frames - counted);
    return sum;
  };
  for (const char* guidance : {"spvg", "ccv"})
    for (const char* pool : {"pixel", "tile"}) {
      const TechniqueRequest request = guided(guidance, {{"pool", pool}});
      const double at_rest = samples(judge, request), jittered = samples(moving_judge, request);
      EXPECT_LE(jittered, 1.2 * at_rest)
          << guidance << " " << pool << ": " << at_rest << " samples";
    }
}

// Noise on a plane with uniform statistics.
Sequence plane_of_noise(uint32_t frames) {
  constexpr uint32_t side = 128;
  CapturedFrame frame;
  FrameDescription& description = frame.description;
  description.width = description.height = side;
  description.render = {0, 0, side, side};
  description.perspective = false;
  description.clip_from_view = {
      2 / (side * 1e-3), 0, 0, 0, 0, -2 / (side * 1e-3), 0, 0, 0, 0, -0.1, 0, 0, 0, 0, 1};
  description.view_from_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  EXPECT_TRUE(complete_projection(description, frame.rays));
  subsurface::Profile profile;
  profile.name = "plane";
  profile.albedo = {0.33, 0.33, 0.33};
  profile.dmfp_mm = {14, 14, 14}; // 3.5 d at this albedo; d is 4 pixels.
  profile.d_mm = {4, 4, 4};
  description.profiles.push_back({1, profile});
  frame.lighting = Image::sized(side, side, 3);
  for (size_t i = 0; i < frame.lighting.values.size(); ++i)
    frame.lighting.values[i] = properties::noise(double(i / 3 % side), double(i / 3 / side));
  frame.depth = Image::sized(side, side, 1);
  std::fill(frame.depth.values.begin(), frame.depth.values.end(), 1.0f);
  frame.profile.assign(size_t{side} * side, 1);
  Sequence sequence;
  sequence.frames.push_back({frame, false});
  return properties::standing_still(std::move(sequence), frames);
}

// A group of a GPU runs as long as its pixel with the most samples.
TEST_F(GuidedSequence, PooledTile_HasOneSampleCount) {
  constexpr uint32_t frames = 6, side = 128, tile = 8;
  const Sequence still = plane_of_noise(frames);
  Judge judge{still};
  const auto tiles_of_one_count = [&](const char* pool) {
    const SequenceRun one =
        run(judge, guided("spvg", {{"pool", pool}, {"sigma2_target", "3e-3"}, {"mips", "none"}}),
            {frames - 1});
    const std::vector<float>& sampling = one.sampling.at(frames - 1);
    uint32_t equal = 0;
    for (uint32_t y = 0; y < side; y += tile)
      for (uint32_t x = 0; x < side; x += tile) {
        bool same = true;
        for (uint32_t i = 0; i < tile * tile; ++i)
          same &= sampling[3 * size_t{(y + i / tile) * side + x + i % tile}] ==
                  sampling[3 * size_t{y * side + x}];
        equal += same ? 1 : 0;
      }
    return equal;
  };
  EXPECT_EQ(tiles_of_one_count("tile"), side * side / tile / tile);
  EXPECT_LT(tiles_of_one_count("pixel"), side * side / tile / tile / 10);
}

TEST_F(GuidedSequence, FlashingLight_SamplesFollowTheVariance) {
  DERMIS_FULL_TESTS_ONLY();
  // All light times 1 + sin: its square, and so the variance, is 1.5 times as large on average.
  // Without mips the variance of n samples of noise is 1/n of one sample's. With mips, which
  // average between n samples, pixel noise stays equal for any n.
  constexpr uint32_t frames = 61, counted = 25, period = 12;
  const Sequence still = plane_of_noise(frames);
  Sequence flashing = still;
  for (uint32_t t = 0; t < frames; ++t)
    for (float& value : flashing.frames[t].captured.lighting.values)
      value *= static_cast<float>(1 + std::sin(2 * std::acos(-1.0) * t / period));
  const std::vector<NamedValue> wide = {{"sigma2_target", "3e-3"}, {"mips", "none"}};
  Judge judge{still}, flashing_judge{flashing};
  const SequenceRun one = run(judge, guided("split_half", wide), {60}),
                    two = run(flashing_judge, guided("split_half", wide), {60});
  const auto mean = [&](const SequenceRun& run) {
    double sum = 0;
    for (uint32_t t = counted; t < counted + 3 * period; ++t)
      sum += run.samples[t] / (3 * period);
    return sum;
  };
  const auto clamped = [](const SequenceRun& run) { // Fraction of pixels.
    const std::vector<float>& sampling = run.sampling.at(60);
    double count = 0;
    for (size_t i = 0; i < sampling.size(); i += 3)
      count += sampling[i] <= 8 || sampling[i] >= 64;
    return count / (double(sampling.size()) / 3);
  };
  RecordProperty("still", std::to_string(mean(one)));
  RecordProperty("flashing", std::to_string(mean(two)));
  RecordProperty("still_clamped", std::to_string(clamped(one)));
  RecordProperty("flashing_clamped", std::to_string(clamped(two)));
  // Regression bounds of the present implementation.
  EXPECT_GE(mean(one), 16);
  EXPECT_LE(mean(one), 24);
  EXPECT_LT(clamped(one), 0.02);
  EXPECT_NEAR(mean(two) / mean(one), 1.5, 0.2);
}

// A choice may switch from `hybrid` to `afis`, which then has no history.
TEST_F(GuidedSequence, FirstFramesAfterASwitch_AreNotNoisy) {
  const Sequence sequence = properties::standing_still(
      frames_of("pan", 40, 1, properties::larger_width, properties::larger_height), 3);
  Judge judge{sequence};
  const auto psnr_db = [&](const char* technique) {
    return run(judge,
               properties::request_of("skin", {{"technique", technique}, {"history", "camera"}}),
               {0, 1, 2})
        .psnr_db;
  };
  const auto afis = psnr_db("afis"), hybrid = psnr_db("hybrid");
  for (uint32_t t = 0; t < 3; ++t) {
    RecordProperty("loss_db_" + std::to_string(t), std::to_string(hybrid.at(t) - afis.at(t)));
    // Regression bound: measured 0.03 dB; without settings for first frames: 10.4 dB.
    EXPECT_GT(afis.at(t), hybrid.at(t) - 1) << "frame " << t;
  }
}

} // namespace
