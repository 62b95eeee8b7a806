// Compares reprojection in kernels on a device with its CPU reference in fp64. Decisions use
// numbers that fp32 holds exactly, so that results are equal even on a limit. Bounds of positions
// follow from the precision that Vulkan requires: one ulp for sums and products, 2.5 ulp for
// quotients.
#include "passes/common/reproject.hpp"
#include "tests/shaders/common/kernel_fixture.hpp"

#include "test_reproject.spv.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace dermis::subsurface::reproject_kernel {
namespace {

constexpr uint32_t cases = 768, rows = 4;
constexpr double ulp = std::numeric_limits<float>::epsilon();

struct Case { // The layout that test_reproject.comp reads.
  float x, y, depth, rise;
  float velocity[3], id;
  float place_x, place_y, place_depth, tolerance;
};
static_assert(sizeof(Case) == 3 * 4 * sizeof(float));

// Images of the previous frame, 16x16 texels. Texels outside the frame's rectangle contain a
// surface as well, so that a kernel that reads them gives a wrong result.
struct Texel {
  float depth, id, unused[2];
};
constexpr int texels = 16;
std::vector<Texel> make_texels() {
  std::vector<Texel> made;
  for (uint32_t i = 0; i < texels * texels; ++i) {
    const uint32_t hash = (i + 1) * 2654435761u >> 16;
    // Two adjacent profiles at equal depths; depths differ by a tolerance or a little more.
    made.push_back({512.0f + 8 * float(hash % 3) + (hash / 4 % 8 == 0 ? 0.125f : 0),
                    1 + float(hash / 32 % 8 == 0),
                    {}});
  }
  return made;
}

std::vector<Case> make_cases(const FrameConstants& frame) {
  std::mt19937 random(5);
  const auto between = [&](double low, double high) {
    return static_cast<float>(std::uniform_real_distribution<double>(low, high)(random));
  };
  const auto steps = [&](double low, double high) {
    return std::floor(64 * between(low, high)) / 64;
  };
  const int width = frame.previous_rect[2], height = frame.previous_rect[3];
  std::vector<Case> made;
  for (uint32_t i = 0; i < cases; ++i) {
    Case one{};
    one.x = std::floor(between(0, 320));
    one.y = std::floor(between(0, 180));
    one.depth = between(200, 4000);
    one.rise = i % 3 == 0 ? 0 : between(0, 60);
    for (float& v : one.velocity)
      v = i % 5 == 0 ? 0 : between(-6, 6);
    one.velocity[2] *= 0.01f; // Metres.
    // Too fast for a motion.
    if (i % 97 == 1) one.velocity[i / 97 % 3] = i % 2 == 0 ? 1e6f : -65536;
    one.id = i % 8 == 0 ? 2 : 1;
    one.place_x = i % 4 == 0 ? std::floor(between(-2, width + 1)) : steps(-2, width + 1);
    one.place_y = i % 6 == 0 ? std::floor(between(-2, height + 1)) : steps(-2, height + 1);
    one.place_depth = i % 41 == 0 ? 0 : 504 + 8 * std::floor(between(0, 5));
    one.tolerance = 8 * std::floor(between(1, 4));
    made.push_back(one);
  }
  made[0].place_x = 65536; // The smallest value that is too far.
  made[1].place_y = -65536;
  made[2].place_depth = -512;
  return made;
}

Matrix4 lens(bool perspective, double scale) {
  if (perspective) return {scale, 0, 0, 0, 0, -1.5 * scale, 0, 0, 0, 0, 0, 0.1, 0, 0, -1, 0};
  return {scale, 0, 0, 0, 0, -1.5 * scale, 0, 0, 0, 0, -0.1, 0, 0, 0, 0, 1};
}
// Builds a camera at `x` metres, turned by `angle` about the vertical axis.
Matrix4 camera(double x, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c, 0, s, -c * x, 0, 1, 0, 0.01, -s, 0, c, s * x, 0, 0, 0, 1};
}

struct Scene {
  const char* name;
  bool perspective, was_perspective;
  double x_before, angle_before, jitter_before;
  bool cut = false;
};
constexpr Scene scenes[] = {
    {"a camera that rests", true, true, 0, 0, 0},
    {"a camera that turns", true, true, 0.02, 0.03, 0.25},
    {"a camera that turns round", true, true, 0, 3.1, 0},
    {"parallel rays", false, false, 0.01, 0.01, -0.375},
    {"rays that were parallel", true, false, 0.01, 0, 0},
    {"rays that were not parallel", false, true, 0, 0.01, 0},
    {"a cut", true, true, 0, 0, 0, true},
};

FrameConstants constants_of(const Scene& scene) {
  FrameInput input;
  input.rect_width = 320;
  input.rect_height = 180;
  input.camera.clip_from_view = lens(scene.perspective, 3);
  input.jitter_px = {-0.25, 0.125};
  input.camera.view_from_world = camera(0, 0);
  const bool rests = scene.x_before == 0 && scene.angle_before == 0;
  if (rests) input.jitter_px = {};
  input.previous_x = 3;
  input.previous_y = 2;
  input.previous_width = rests ? input.rect_width : 9;
  input.previous_height = rests ? input.rect_height : 7;
  input.camera.previous_clip_from_view = lens(scene.was_perspective, rests ? 3 : 2.5);
  input.camera.previous_view_from_world = camera(scene.x_before, scene.angle_before);
  input.previous_jitter_px = {scene.jitter_before, -scene.jitter_before};
  input.history_invalid = scene.cut;
  FrameConstants constants{};
  EXPECT_TRUE(fill_frame_constants(input, constants)) << scene.name;
  return constants;
}

struct Bounded {
  double value = 0, bound = 0;
};

// Computes reproject with rounding bounds, before positions next to whole pixels snap to them.
struct PlaceBounds {
  std::array<Bounded, 2> pixel;
  Bounded depth;
};
PlaceBounds still_bounds(const FrameConstants& frame, const Case& one) {
  const double zoom = (frame.flags & 1) != 0 ? one.depth : 1, requested[] = {one.x, one.y};
  double at[4] = {0, 0, -double(one.depth), 1}, size[4] = {0, 0, one.depth, 1};
  for (size_t axis = 0; axis < 2; ++axis) {
    const double scaled = double(frame.ray_scale[axis]) * requested[axis],
                 offset = frame.ray_offset[axis];
    at[axis] = (scaled + offset) * zoom;
    size[axis] = (std::abs(scaled) + std::abs(offset)) * zoom;
  }
  Bounded before[3];
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 4; ++c) {
      before[r].value += double(frame.previous_from_view[r][c]) * at[c];
      // A product, a sum and a product for the position; a product and three sums for the row.
      before[r].bound += 7 * ulp * std::abs(double(frame.previous_from_view[r][c])) * size[c];
    }
  PlaceBounds out;
  out.depth = {-before[2].value, before[2].bound};
  const Bounded k = (frame.flags & 8) != 0 ? out.depth : Bounded{1, 0};
  for (size_t axis = 0; axis < 2; ++axis) {
    const double offset = frame.previous_ray_offset[axis], scale = frame.previous_ray_scale[axis];
    const double divided = before[axis].value / k.value;
    double bound =
        before[axis].bound / k.value + std::abs(divided) * (k.bound / k.value + 2.5 * ulp);
    bound += ulp * (std::abs(divided) + std::abs(offset));
    const double place = (divided - offset) / scale;
    out.pixel[axis] = {place, bound / std::abs(scale) + 2.5 * ulp * std::abs(place)};
  }
  return out;
}
PlaceBounds moving_bounds(const FrameConstants& frame, const Case& one) {
  PlaceBounds out = still_bounds(frame, one);
  const double requested[] = {one.x, one.y};
  for (size_t axis = 0; axis < 2; ++axis) {
    const double jitter = frame.jitter[axis],
                 ratio = double(frame.previous_rect[2 + axis]) / frame.rect[2 + axis];
    const double steady = (requested[axis] - jitter - one.velocity[axis] + 0.5) * ratio - 0.5;
    const double size =
        (requested[axis] + std::abs(jitter) + std::abs(one.velocity[axis]) + 0.5) * ratio + 0.5 +
        std::abs(frame.previous_jitter[axis]);
    // Five sums, a product, a quotient.
    out.pixel[axis] = {steady + frame.previous_jitter[axis], (5 + 1 + 2.5) * ulp * size};
  }
  const double own = double(one.velocity[2]) * frame.depth_unit;
  out.depth.value -= own;
  out.depth.bound += 2 * ulp * (std::abs(out.depth.value) + std::abs(own));
  return out;
}

class ReprojectKernel : public dermis::testing::KernelTest {
protected:
  struct Answers {
    FrameConstants frame;
    std::vector<Case> requested;
    std::vector<float> values;
    double at(size_t x, size_t row, size_t channel) const {
      return double(values[4 * (row * cases + x) + channel]);
    }
  };
  Answers ask(const Scene& scene) {
    Answers out{constants_of(scene), {}, {}};
    out.requested = make_cases(out.frame);
    std::vector<std::byte> questions;
    for (const auto bytes :
         {std::as_bytes(std::span(out.requested)), std::as_bytes(std::span(before))})
      questions.insert(questions.end(), bytes.begin(), bytes.end());
    out.values = answers_of({"test_reproject", test_reproject_spirv}, cases, rows,
                            {.questions = questions, .frame = &out.frame});
    EXPECT_EQ(out.values.size(), size_t{4} * cases * rows);
    return out;
  }
  HistoryTaps reference_taps(const FrameConstants& frame, const Case& one) const {
    return find_history(
        frame, {one.place_x, one.place_y, one.place_depth}, static_cast<uint32_t>(one.id),
        one.tolerance, [&](int x, int y) {
          const Texel& texel =
              before[size_t((y + frame.previous_rect[1]) * texels + x + frame.previous_rect[0])];
          return SurfaceBefore{texel.depth, static_cast<uint32_t>(texel.id)};
        });
  }
  const std::vector<Texel> before = make_texels();
};

// Checks that the position on the device matches the reference. Next to the snapping limit both
// decisions are allowed.
void expect_place(const Bounded& place, double reference, double device, const std::string& where) {
  const double whole = std::round(place.value);
  const bool either = std::abs(std::abs(place.value - whole) - reproject_snap_px) <= place.bound;
  if (either && device == whole) return;
  EXPECT_NEAR(device, either ? place.value : reference,
              reference == whole && !either ? 0 : place.bound)
      << where;
}

TEST_F(ReprojectKernel, PlacesEqualTheReference) {
  size_t found = 0, behind = 0, snapped = 0, too_fast = 0;
  for (const Scene& scene : scenes) {
    const Answers answers = ask(scene);
    if (HasFailure() || IsSkipped()) return;
    for (size_t i = 0; i < cases; ++i) {
      const Case& one = answers.requested[i];
      const std::string where = std::string(scene.name) + ", case " + std::to_string(i);
      EXPECT_EQ(answers.at(i, 0, 3), history_usable(answers.frame) ? 1 : 0) << where;
      const PreviousPosition still = reproject(answers.frame, one.x, one.y, one.depth);
      const PlaceBounds bounds = still_bounds(answers.frame, one);
      const PreviousPosition moving =
          reproject(answers.frame, one.x, one.y, one.depth,
                    {one.velocity[0], one.velocity[1], one.velocity[2]});
      const double steep = depth_tolerance(answers.frame, one.depth, one.rise);
      // A constant and a product.
      EXPECT_NEAR(answers.at(i, 1, 3), steep, 2 * ulp * steep) << where;
      EXPECT_EQ(answers.at(i, 0, 2) > 0, still.depth > 0) << where;
      EXPECT_EQ(answers.at(i, 1, 2) > 0, moving.depth > 0) << where;
      if (!(still.depth > 0)) {
        ++behind;
        continue;
      }
      ++found;
      EXPECT_NEAR(answers.at(i, 0, 2), still.depth, bounds.depth.bound) << where;
      const double places[] = {still.x, still.y}, moved[] = {moving.x, moving.y};
      for (size_t axis = 0; axis < 2; ++axis) {
        expect_place(bounds.pixel[axis], places[axis], answers.at(i, 0, axis), where);
        snapped += places[axis] == std::round(places[axis]) ? 1 : 0;
      }
      if (!(moving.depth > 0)) {
        ++too_fast;
        continue;
      }
      const PlaceBounds moving_bound = moving_bounds(answers.frame, one);
      EXPECT_NEAR(answers.at(i, 1, 2), moving.depth, moving_bound.depth.bound) << where;
      for (size_t axis = 0; axis < 2; ++axis)
        expect_place(moving_bound.pixel[axis], moved[axis], answers.at(i, 1, axis), where);
    }
  }
  for (const size_t seen : {found, behind, snapped, too_fast})
    EXPECT_GE(seen, 32u) << "the cases have to contain each kind";
}

TEST_F(ReprojectKernel, TapsEqualTheReference) {
  const Answers answers = ask(scenes[1]);
  if (HasFailure() || IsSkipped()) return;
  size_t none = 0, some = 0, all = 0;
  for (size_t i = 0; i < cases; ++i) {
    const Case& one = answers.requested[i];
    const HistoryTaps taps = reference_taps(answers.frame, one);
    const auto used =
        std::count_if(taps.weight.begin(), taps.weight.end(), [](double w) { return w > 0; });
    const std::string where = "case " + std::to_string(i);
    EXPECT_EQ(answers.at(i, 2, 2), double(used)) << where;
    EXPECT_EQ(answers.at(i, 2, 0), taps.x) << where;
    EXPECT_EQ(answers.at(i, 2, 1), taps.y) << where;
    for (size_t t = 0; t < 4; ++t) {
      EXPECT_EQ(answers.at(i, 3, t) > 0, taps.weight[t] > 0) << where << ", tap " << t;
      // Positions are multiples of 1/64: products and their sum are exact, the quotient is not.
      EXPECT_NEAR(answers.at(i, 3, t), taps.weight[t], 2.5 * ulp * taps.weight[t])
          << where << ", tap " << t;
    }
    (used == 0 ? none : used == 4 ? all : some) += 1;
  }
  for (const size_t seen : {none, some, all})
    EXPECT_GT(seen, cases / 20) << "the cases have to contain each kind";
}

} // namespace
} // namespace dermis::subsurface::reproject_kernel
