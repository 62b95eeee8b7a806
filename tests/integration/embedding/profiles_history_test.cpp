// Histories belong to a profile: a surface never reads the history of another profile at an equal
// position and depth.

#include "tests/integration/embedding/two_views.hpp"
#include "tests/support/shipped_graphs.hpp"

namespace dermis::abi_test {
namespace {

// Two profiles in a chequered pattern at one depth; `swapped` exchanges them.
float profile_at(uint32_t x, uint32_t y, bool swapped) {
  return (x / 6 + y / 6) % 2 == (swapped ? 1 : 0) ? 1.0f : 2.0f;
}

struct HistoryCase {
  const char *name, *graph;
  bool accumulated;
  bool cut_restarts_samples; // So a frame after a cut differs from one without a valid history.
};

void PrintTo(const HistoryCase& one, std::ostream* out) {
  *out << one.name;
}

struct ProfilesOfHistories : TwoViewsTest, ::testing::WithParamInterface<HistoryCase> {
  static constexpr uint32_t side = 48;

  // `turned`: the light's pattern is turned by 90 degrees. A factor would not do, because some
  // histories hold ratios of light.
  std::vector<float> run_frame(dermis_view view, uint64_t index, bool swapped, uint32_t flags,
                               bool turned = false) {
    // Ridges, because flat surfaces are not sampled and need no history.
    fill("depth", [](uint32_t x, uint32_t y) { return 0.5f + 0.002f * float((x + y) / 2 % 2); });
    fill("material", [&](uint32_t x, uint32_t y) { return profile_at(x, y, swapped); });
    fill("lighting", [&](uint32_t x, uint32_t y) {
      if (turned) std::swap(x, y);
      return float(index) * float(8 + (x * 7 + y * 3) % 32) / 64;
    });
    dermis_frame one = bound_frame(graph, side, side);
    one.flags = flags;
    rest(one);
    record_in(view, one, index);
    return texels("lighting");
  }
};

TEST_P(ProfilesOfHistories, SwappedProfiles_StartAnew) {
  std::vector<std::string> overlays;
  if (GetParam().accumulated) overlays.push_back(read_text("configs/overlays/accumulate.json"));
  make(read_text(dermis::shipped::graph_file(GetParam().graph)), overlays, side, "", 2);
  for (uint64_t index = 1; index <= 3; ++index)
    for (const dermis_view view : {dermis_view{nullptr}, other})
      run_frame(view, index, false, 0, view == other);
  // The other view has either no history or one of other light.
  const uint32_t flags = GetParam().cut_restarts_samples ? 0u : DERMIS_FRAME_RESET_HISTORY;
  const std::vector<float> swapped = run_frame(nullptr, 4, true, 0),
                           compared = run_frame(other, 4, true, flags);
  EXPECT_TRUE(swapped == compared) << "bit by bit";
  // Unchanged pixels use their history, and the picture shows which history that is.
  std::vector<float> stayed, changed;
  for (uint64_t index = 5; index <= 8; ++index) {
    stayed = run_frame(nullptr, index, true, 0);
    changed = run_frame(other, index, true, flags, flags == 0 && index < 8);
  }
  EXPECT_FALSE(stayed == changed);
}

INSTANTIATE_TEST_SUITE_P(, ProfilesOfHistories,
                         ::testing::Values(HistoryCase{"accumulate", "burley", true, false},
                                           HistoryCase{"residual", "sap_residual", false, true},
                                           HistoryCase{"guided", "afis_guided", false, false}),
                         [](const auto& of) { return std::string(of.param.name); });

} // namespace
} // namespace dermis::abi_test
