// Equal inputs give equal bits: in every run, for any thread count of the driver, and for any pass
// order. For a driver and version in the table, the bits match the stored hash.
#include "tests/passes/device/golden.hpp"
#include "tests/passes/device/kept_pictures.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <unistd.h>

namespace dermis::testing {
namespace {

class Golden : public DevicePlayer, public ::testing::WithParamInterface<std::string> {
protected:
  Played frames(PassOrder order = PassOrder::memory, uint64_t order_seed = 0) {
    const auto graph = shipped_graph(GetParam(), pass_types);
    if (!graph) return {};
    const Show show = golden_show(graph->graph);
    CompileInput input = compile_input(*graph, show);
    input.order = order;
    input.order_seed = order_seed;
    Diagnostics diagnostics;
    const auto compiled = compile(input, diagnostics);
    EXPECT_TRUE(compiled) << format_as_json(diagnostics);
    return compiled ? play(*graph, show, compiled->plan, false) : Played{};
  }

  std::string line(const std::string& hash) const {
    return fmt::format("golden\t{}\t{}\t{}\n", driver(), GetParam(), hash);
  }
};

// One graph per technique, and histories.
INSTANTIATE_TEST_SUITE_P(Graphs, Golden,
                         ::testing::Values("burley", "separable", "afis", "afis_guided", "sap",
                                           "sap_residual", "hybrid"),
                         [](const auto& graph) { return graph.param; });

TEST_P(Golden, FramesMatchTheStoredHashOfThisDriver) {
  const std::string here = driver(), found = hash_of(frames());
  if (std::getenv("DERMIS_GOLDEN_UPDATE") != nullptr) keep_golden_hash(here, GetParam(), found);
  std::printf("%s", line(found).c_str());
  const std::string kept = golden_hash(here, GetParam());
  if (kept.empty())
    GTEST_SKIP() << "no frames are kept for this driver, '" << here << "'; there are frames for\n"
                 << golden_drivers();
  EXPECT_EQ(found, kept);
}

TEST_P(Golden, EveryRunAndOrder_GivesEqualBits) {
  const Played first = frames();
  EXPECT_EQ(frames(), first);
  EXPECT_EQ(frames(PassOrder::program), first);
  for (uint64_t seed = 1; seed <= 2; ++seed)
    EXPECT_EQ(frames(PassOrder::random, seed), first) << "order " << seed;
}

// Runs in a separate process, because lavapipe reads its thread count only once.
TEST_P(Golden, AnyThreadCount_GivesEqualBits) {
  if (!driver().starts_with("llvmpipe"))
    GTEST_SKIP() << "only lavapipe has a known way to set its thread count";
  std::string reported[2]; // by one thread and by two
  for (const int threads : {1, 2}) {
    const std::string command = fmt::format(
        "LP_NUM_THREADS={} /proc/{}/exe --gtest_filter=Graphs/Golden.FramesMatchTheStoredHash*/{}",
        threads, getpid(), GetParam());
    FILE* const child = popen(command.c_str(), "r");
    ASSERT_NE(child, nullptr);
    char text[512];
    while (std::fgets(text, sizeof text, child) != nullptr)
      if (std::string(text).starts_with("golden\t")) reported[threads - 1] += text;
    pclose(child);
  }
  EXPECT_FALSE(reported[0].empty());
  EXPECT_EQ(reported[0], reported[1]);
}

// Drivers round differently, and a sample on the border of a texel may read the neighbour. Most
// pixels differ by a few roundings, few by a sample. Bounds:
// - The median is within 4 roundings to half floats (2^-11) of light of about 1: store, filter,
//   exponential and root.
// - 0.1 % of the pixels may differ by more than 1 of at least 16 samples times the contrast of the
//   light, 0.625.
TEST_P(Golden, FramesMatchPicturesOfAnotherDriver) {
  const KeptPictures kept = kept_pictures();
  if (kept.folder.empty())
    GTEST_SKIP() << "DERMIS_PICTURES names no folder with frames of another driver "
                    "(tests/scripts/run_on_drivers.sh)";
  constexpr double rounding = 1.0 / 2048, contrast = 0.625, samples = 16;
  const std::string path = fmt::format("{}/{}.floats", kept.folder, GetParam());
  const std::vector<float> here = light_of(frames());
  if (kept.keep) return keep_floats(path, here);
  const std::vector<float> there = kept_floats(path);
  ASSERT_EQ(here.size(), there.size()) << path;
  const std::vector<double> off = differences(here, there);
  std::printf("pictures\t%s\t%s\t%s\n", driver().c_str(), GetParam().c_str(),
              reported_percentiles(off).c_str());
  EXPECT_LE(percentile(off, 0.5), 4 * rounding);
  EXPECT_LE(percentile(off, 0.999), contrast / samples);
}

} // namespace
} // namespace dermis::testing
