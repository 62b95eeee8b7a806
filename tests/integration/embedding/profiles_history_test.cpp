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
};

void PrintTo(const HistoryCase& one, std::ostream* out) {
  *out << one.name;
}

struct ProfilesOfHistories : TwoViewsTest, ::testing::WithParamInterface<HistoryCase> {
  static constexpr uint32_t side = 48;

  std::vector<float> run_frame(dermis_view view, uint64_t index, bool swapped, uint32_t flags,
                               float gain = 1) {
    // Ridges, because flat surfaces are not sampled and need no history.
    fill("depth", [](uint32_t x, uint32_t y) { return 0.5f + 0.002f * float((x + y) / 2 % 2); });
    fill("material", [&](uint32_t x, uint32_t y) { return profile_at(x, y, swapped); });
    fill("lighting", [&](uint32_t x, uint32_t y) {
      return gain * float(index) * float(8 + (x * 7 + y * 3) % 32) / 64;
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
      run_frame(view, index, false, 0, view == other ? 4.0f : 1.0f);
  const std::vector<float> after_dim = run_frame(nullptr, 4, true, 0),
                           after_bright = run_frame(other, 4, true, 0);
  EXPECT_TRUE(after_dim == after_bright) << "bit by bit";
  // Unchanged pixels use their history, and the picture shows whether a history exists.
  std::vector<float> stayed, cut_again;
  for (uint64_t index = 5; index <= 8; ++index) {
    stayed = run_frame(nullptr, index, true, 0);
    cut_again = run_frame(other, index, true, DERMIS_FRAME_RESET_HISTORY);
  }
  EXPECT_FALSE(stayed == cut_again);
}

INSTANTIATE_TEST_SUITE_P(, ProfilesOfHistories,
                         ::testing::Values(HistoryCase{"accumulate", "burley", true},
                                           HistoryCase{"residual", "sap_residual", false},
                                           HistoryCase{"guided", "afis_guided", false}),
                         [](const auto& of) { return std::string(of.param.name); });

} // namespace
} // namespace dermis::abi_test
