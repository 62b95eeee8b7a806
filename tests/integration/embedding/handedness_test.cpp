// Tests one scene in a right-handed and in a left-handed view space: the pictures are equal.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <cmath>

namespace dermis::abi_test {
namespace {

constexpr float near_plane_m = 0.25f, far_plane_m = 4.0f; // Planes of the projections.
constexpr float half_height = 0.032f;                     // Half of the picture's height at 1 m.
constexpr float wall_m = 0.5f;                            // Distance to the middle of the wall.

enum class Lens : uint8_t { perspective, orthographic };
enum class Range : uint8_t { forward, reversed, reversed_infinite };

struct View {
  Lens lens = Lens::perspective;
  Range range = Range::forward;
  dermis_depth_kind depth = DERMIS_DEPTH_DEVICE;
  bool left = false;       // Whether view space is left-handed.
  bool left_world = false; // Whether world space is left-handed.
  float past_error = 0;    // Error of the position in the previous matrices, in metres.
};

// Fills the rows of depth and w, for view positions with z = -distance.
void project(float (&m)[16], const View& view, float jitter_x) {
  std::fill(std::begin(m), std::end(m), 0.0f);
  const float range = far_plane_m - near_plane_m;
  if (view.lens == Lens::perspective) {
    m[0] = 1 / half_height;
    m[5] = -1 / half_height;
    m[2] = -2 * jitter_x / 64;
    m[10] = view.range == Range::forward    ? -far_plane_m / range
            : view.range == Range::reversed ? near_plane_m / range
                                            : 0;
    m[11] = view.range == Range::forward    ? -far_plane_m * near_plane_m / range
            : view.range == Range::reversed ? far_plane_m * near_plane_m / range
                                            : near_plane_m;
    m[14] = -1;
  } else {
    m[0] = 1 / (half_height * wall_m);
    m[5] = -1 / (half_height * wall_m);
    m[3] = 2 * jitter_x / 64;
    m[10] = view.range == Range::forward ? -1 / range : 1 / range;
    m[11] = view.range == Range::forward ? -near_plane_m / range : far_plane_m / range;
    m[15] = 1;
  }
  for (size_t row = 0; row < 4 && view.left; ++row)
    m[4 * row + 2] = -m[4 * row + 2];
}

float stored(const View& view, float distance) {
  if (view.depth == DERMIS_DEPTH_VIEW_UNITS) return distance;
  float m[16];
  project(m, view, 0);
  const float z = view.left ? distance : -distance;
  return (m[10] * z + m[11]) / (m[14] * z + m[15]);
}

// Fills the matrix of a camera at `x`, turned by `angle` about the y axis.
void place(float (&m)[16], const View& view, float x, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  const float rows[16] = {c, 0, -s, -c * x, 0, 1, 0, 0, s, 0, c, -s * x, 0, 0, 0, 1};
  std::copy(std::begin(rows), std::end(rows), std::begin(m));
  for (size_t i = 8; i < 12 && view.left; ++i)
    m[i] = -m[i];
  for (size_t row = 0; row < 3 && view.left_world; ++row)
    m[4 * row + 2] = -m[4 * row + 2];
}

struct Handedness : DermisTest {
  // Returns the light of the last frame of a moving, turning, jittered camera in front of a slanted
  // wall.
  std::vector<float> picture(const View& view) {
    GraphOptions options;
    options.text =
        // Keeps light, depth and ids over frames.
        read_text("configs/graphs/papers/sap_residual.json");
    for (const char* unbound : {"velocity", "thickness", "back_lighting"})
      options.unbound.emplace_back(unbound);
    const dermis_graph graph = make_graph(options);
    if (graph == nullptr) return {};
    make_images(graph);
    // Ridges, because flat surfaces are not sampled and need no history.
    fill("depth", [&](uint32_t x, uint32_t y) {
      return stored(view, wall_m + 0.0005f * float(x) + 0.004f * float((x + y) / 3 % 2));
    });
    last_frame = 0;
    for (int i = 0; i < 4; ++i) {
      fill("lighting",
           [&](uint32_t x, uint32_t y) { return float((x / 8 + y / 8 + uint32_t(i)) % 2); });
      dermis_frame one = bound_frame(graph);
      one.depth_kind = view.depth;
      one.flags = view.left && view.lens == Lens::orthographic ? DERMIS_FRAME_LEFT_HANDED : 0;
      const auto jitter = [](int frame) { return frame % 2 == 0 ? 0.25f : -0.25f; };
      one.jitter_x = jitter(i);
      project(one.clip_from_view, view, jitter(i));
      project(one.previous_clip_from_view, view, jitter(i - 1));
      place(one.view_from_world, view, 0.0004f * float(i), 0.001f * float(i));
      place(one.previous_view_from_world, view, 0.0004f * float(i - 1) + view.past_error,
            0.001f * float(i - 1));
      EXPECT_OK(record(graph, one));
    }
    std::vector<float> light = texels("lighting");
    dermis_graph_destroy(graph);
    graphs.clear();
    return light;
  }
};

TEST_F(Handedness, ViewSpace_DoesNotChangeThePicture) {
  const View views[] = {
      {Lens::perspective, Range::forward, DERMIS_DEPTH_DEVICE},
      {Lens::perspective, Range::reversed, DERMIS_DEPTH_DEVICE},
      {Lens::perspective, Range::reversed_infinite, DERMIS_DEPTH_DEVICE},
      {Lens::perspective, Range::forward, DERMIS_DEPTH_VIEW_UNITS},
      {Lens::orthographic, Range::forward, DERMIS_DEPTH_DEVICE},
      {Lens::orthographic, Range::reversed, DERMIS_DEPTH_DEVICE},
      {Lens::orthographic, Range::forward, DERMIS_DEPTH_VIEW_UNITS},
  };
  std::vector<float> first;
  for (const View& right : views) {
    SCOPED_TRACE(static_cast<int>(&right - views));
    View left = right, left_in_left = right;
    left.left = left_in_left.left = left_in_left.left_world = true;
    const std::vector<float> expected = picture(right);
    ASSERT_FALSE(expected.empty());
    EXPECT_EQ(picture(left), expected);
    EXPECT_EQ(picture(left_in_left), expected) << "the world is left-handed, too";
    if (first.empty()) first = expected;
  }
  View misplaced = views[0];
  misplaced.past_error = 0.004f;
  EXPECT_NE(picture(misplaced), first) << "the pictures depend on the previous matrices";
}

} // namespace
} // namespace dermis::abi_test
