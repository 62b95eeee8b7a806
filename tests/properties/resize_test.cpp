// Histories stay useful after a resize: they are rescaled and reprojected along surfaces. The tests
// use the sculpted bust and a smaller size; DERMIS_TESTS_FULL adds a larger size.
#include "tests/framegraph/test_scale.hpp"
#include "tests/properties/sequences.hpp"

#include <cmath>

namespace {

using namespace dermis;
using namespace dermis::tools;
using properties::close_d_px;
using properties::Frames;
using properties::Judge;
using properties::SequenceRun;
using properties::standing_still;

struct Size {
  uint32_t width, height;
};
constexpr Size before{properties::larger_width, properties::larger_height};
constexpr Size larger{361, 203}, smaller{163, 91}, odd{241, 135};
// Frames before the view is resized, and frames from then on.
constexpr uint32_t learned = 24, after = 3;

// Concatenates two sequences; the camera may be a little nearer in the second.
Sequence one_after_the_other(Sequence first, const Sequence& second) {
  const subsurface::Matrix4 last = first.frames.back().captured.description.clip_from_view;
  const size_t at = first.frames.size();
  first.frames.insert(first.frames.end(), second.frames.begin(), second.frames.end());
  first.frames[at].captured.description.previous_clip_from_view = last;
  return first;
}

bool before_the_resize_or_after(uint32_t t) {
  return t > 0 && t != learned;
}

class Resize : public properties::SequenceTest {
protected:
  static Sequence frames(Size size, uint32_t first, uint32_t count) {
    auto sequence =
        render_sequence({"pan", "close", properties::root() + "/configs/scenes/pan.json",
                         close_d_px * size.height / before.height, first, count, false},
                        size.width, size.height, {});
    EXPECT_TRUE(sequence) << sequence.error().text;
    return sequence ? sequence.take() : Sequence{};
  }
  static Sequence still(Size size, uint32_t count) {
    return standing_still(frames(size, 40, 1), count);
  }

  // All are rendered before anything runs on the device.
  struct Case {
    std::string name;
    Sequence resized, always; // `always` has the other size from the first frame on.
  };
  static std::vector<Case> cases() {
    std::vector<std::pair<std::string, Size>> sizes = {{"smaller", smaller}};
    if (dermis::testing::seeds_to_try(0, 1) == 1) sizes.emplace_back("larger", larger);
    std::vector<Case> all;
    for (const auto& [name, size] : sizes)
      all.push_back({name, one_after_the_other(still(before, learned), still(size, after)),
                     still(size, learned + after)});
    return all;
  }
};

TEST_F(Resize, Ratio_RefinesTheFirstFrameOfTheNewSize) {
  const Frames judged = {learned, learned + 2};
  for (const Case& one : cases()) {
    Judge judge{one.resized}, judge_always{one.always};
    const auto request = properties::request_of("sap_residual");
    const SequenceRun kept = run(judge, request, judged);
    const SequenceRun restarted = run(judge, request, judged, before_the_resize_or_after);
    const SequenceRun always = run(judge_always, request, judged);
    RecordProperty(one.name + "_kept", std::to_string(kept.psnr_db.at(learned)));
    RecordProperty(one.name + "_anew", std::to_string(restarted.psnr_db.at(learned)));
    RecordProperty(one.name + "_always", std::to_string(always.psnr_db.at(learned)));
    // Regression bounds. Measured: larger 56.5, 53.6 and 56.7 dB; smaller 57.2, 52.4 and 55.4 dB.
    for (const uint32_t t : judged)
      EXPECT_GT(kept.psnr_db.at(t), always.psnr_db.at(t) - 1) << one.name << ", frame " << t;
    EXPECT_GT(kept.psnr_db.at(learned), restarted.psnr_db.at(learned) + 2) << one.name;
    // Measured 1.52, of the few pixels that need samples.
    EXPECT_LT(kept.samples[learned], 1.6 * always.samples[learned]) << one.name;
    EXPECT_GT(restarted.samples[learned], 5 * kept.samples[learned]) << one.name;
  }
}

TEST_F(Resize, Guidance_KeepsItsSampleCounts) {
  DERMIS_FULL_TESTS_ONLY();
  for (const Case& one : cases())
    for (const char* guidance : {"split_half", "ccv"}) {
      Judge judge{one.resized}, judge_always{one.always};
      const auto request = properties::request_of("afis_guided", {{"guidance", guidance}});
      const SequenceRun kept = run(judge, request, {});
      const SequenceRun restarted = run(judge, request, {}, before_the_resize_or_after);
      const SequenceRun always = run(judge_always, request, {});
      const std::string name = one.name + "_" + guidance;
      RecordProperty(name + "_kept", std::to_string(kept.samples[learned]));
      RecordProperty(name + "_always", std::to_string(always.samples[learned]));
      EXPECT_NEAR(kept.samples[learned], always.samples[learned], 0.05 * always.samples[learned])
          << name;
      EXPECT_EQ(restarted.samples[learned], 16)
          << name; // The sample count of a pixel without history.
    }
}

TEST_F(Resize, Accumulation_Continues) {
  // Independent frames without mips: a single frame is 12 dB noisier than their moving mean.
  TechniqueRequest request = properties::request_of(
      "afis",
      {{"sequence", "hashed"}, {"mips", "none"}, {"samples", "8"}, {"accumulate_clip", "0"}});
  request.overlays = {properties::root() + "/configs/overlays/accumulate.json"};
  for (const Case& one : cases()) {
    Judge judge{one.resized}, judge_always{one.always};
    const SequenceRun kept = run(judge, request, {learned});
    const SequenceRun restarted = run(judge, request, {learned}, before_the_resize_or_after);
    const SequenceRun always = run(judge_always, request, {learned});
    RecordProperty(one.name + "_kept", std::to_string(kept.mean_psnr_db));
    RecordProperty(one.name + "_anew", std::to_string(restarted.mean_psnr_db));
    RecordProperty(one.name + "_always", std::to_string(always.mean_psnr_db));
    EXPECT_GT(kept.mean_psnr_db, restarted.mean_psnr_db + 4) << one.name;
    EXPECT_LT(kept.mean_psnr_db, always.mean_psnr_db + 3) << one.name;
  }
}

TEST_F(Resize, RepeatedResizesInAPan_LeaveNoTrail) {
  DERMIS_FULL_TESTS_ONLY();
  // Four frames in each size, like a host that follows a time budget.
  constexpr uint32_t first = 20, count = 24, each = 4;
  Sequence sequence = frames(before, first, count);
  const Sequence other = frames(odd, first, count), small = frames(smaller, first, count);
  for (uint32_t t = 0; t < count; ++t) {
    if (t / each % 3 == 1) sequence.frames[t] = other.frames[t];
    if (t / each % 3 == 2) sequence.frames[t] = small.frames[t];
    FrameDescription& now = sequence.frames[t].captured.description;
    // Computed for another camera; the matrices contain the motion, too.
    sequence.frames[t].captured.velocity = {};
    if (t > 0)
      now.previous_clip_from_view = sequence.frames[t - 1].captured.description.clip_from_view;
  }
  Judge judge{sequence};
  const Frames judged = {12, 13, 16, 17, 20, 21};
  const SequenceRun sap = run(judge, properties::request_of("sap"), judged),
                    residual = run(judge, properties::request_of("sap_residual"), judged),
                    never = run(judge, properties::request_of("sap_residual"), judged,
                                [](uint32_t) { return false; });
  RecordProperty("sap", std::to_string(sap.mean_psnr_db));
  RecordProperty("residual", std::to_string(residual.mean_psnr_db));
  RecordProperty("never", std::to_string(never.mean_psnr_db));
  for (const uint32_t t : judged) {
    RecordProperty("sap_" + std::to_string(t), std::to_string(sap.psnr_db.at(t)));
    RecordProperty("residual_" + std::to_string(t), std::to_string(residual.psnr_db.at(t)));
    RecordProperty("samples_" + std::to_string(t), std::to_string(residual.samples[t]));
    EXPECT_GT(residual.psnr_db.at(t), sap.psnr_db.at(t)) << t;
    // Regression bound of the present implementation.
    EXPECT_LT(residual.samples[t], 0.6 * never.samples[t]) << t;
  }
  EXPECT_GT(residual.mean_psnr_db, sap.mean_psnr_db + 1);
}

} // namespace
