// Tests a device that rejects any object or allocation: the call reports the failure, running
// graphs continue, and nothing leaks.

#include "integration/tools/command/bench/record/counted_host.hpp"
#include "tests/framegraph/test_scale.hpp"
#include "tests/integration/abi/sources.hpp"
#include "tests/support/shipped_graphs.hpp"
#include "tests/support/text_file.hpp"

#include <functional>

namespace dermis::test {
namespace {

// Limit for one call; a graph of twenty passes creates about 200 objects.
constexpr uint64_t max_creations = 2000;
constexpr uint32_t frames_in_flight = 2;

struct FailingDevice : ::testing::TestWithParam<const char*> {
  tools::CountedInput input(uint32_t width, uint32_t height) const {
    const std::string graph = dermis::shipped::graph_file(GetParam());
    const std::string profile = "configs/profiles/skin.json";
    return {graph, read_text(graph), profile, read_text(profile), width, height};
  }
  // Step between failing creations, because a new graph fits its kernel tables at each try.
  static uint64_t step() {
    return std::string_view(GetParam()) == "burley" ? 1 : dermis::testing::seeds_to_try(16, 1);
  }
};

// Calls `change` with its first creation failing, then its second, until none fails.
void fail_each_creation(tools::CountedHost& host, const std::function<dermis_result()>& change) {
  uint64_t failures = 0;
  for (uint64_t nth = 1; nth < max_creations; ++nth) {
    const uint64_t alive = host.device().alive(), bytes = host.device().memory_bytes();
    host.device().fail_creation(nth, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    const dermis_result result = change();
    host.device().fail_creation(0, VK_SUCCESS);
    if (result == DERMIS_OK) break;
    ++failures;
    EXPECT_EQ(result, DERMIS_ERROR_DEVICE_MEMORY) << "creation " << nth;
    EXPECT_EQ(host.device().alive(), alive) << "creation " << nth;
    EXPECT_EQ(host.device().memory_bytes(), bytes) << "creation " << nth;
    EXPECT_OK(host.record_frame()) << "creation " << nth;
  }
  EXPECT_GT(failures, 10u);
  EXPECT_LT(failures, max_creations - 2);
}

TEST_P(FailingDevice, FailedGraph_LeaksNothing) {
  uint64_t nth = 1;
  for (; nth < max_creations; nth += step()) {
    tools::CountedHost host;
    host.device().fail_creation(nth, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    const std::string problem = host.open(input(64, 48));
    if (problem.empty()) break;
    EXPECT_NE(problem.find("VK_ERROR_OUT_OF_DEVICE_MEMORY"), std::string::npos) << problem;
    EXPECT_EQ(host.device().alive(), 0u) << "creation " << nth << ": " << problem;
    EXPECT_EQ(host.device().memory_bytes(), 0u) << "creation " << nth;
  }
  EXPECT_GT(nth, 10u);
  EXPECT_LT(nth, max_creations);
}

TEST_P(FailingDevice, FailedResize_KeepsTheGraph) {
  tools::CountedHost host;
  ASSERT_EQ(host.open(input(64, 48)), "");
  ASSERT_OK(host.record_frame());
  uint32_t calls = 0; // The size changes each time, because a resize to the same size does nothing.
  fail_each_creation(
      host, [&] { return dermis_graph_resize(host.graph(), 48 + ++calls % 2, 48, nullptr); });
}

TEST_P(FailingDevice, FailedReload_KeepsTheGraph) {
  tools::CountedHost host;
  const tools::CountedInput given = input(64, 48);
  ASSERT_EQ(host.open(given), "");
  ASSERT_OK(host.record_frame());
  dermis_source source = DERMIS_SOURCE_INIT;
  source.name = given.name.c_str();
  source.text = given.graph.data();
  source.length = given.graph.size();
  fail_each_creation(host, [&] { return abi_test::reload_text(host.graph(), source); });
}

TEST_P(FailingDevice, ReplacedObjects_AreFreedAfterTheirFrames) {
  tools::CountedHost host;
  const tools::CountedInput given = input(64, 48);
  ASSERT_EQ(host.open(given), "");
  ASSERT_OK(host.record_frame());
  const uint64_t alive = host.device().alive(), bytes = host.device().memory_bytes();
  dermis_source source = DERMIS_SOURCE_INIT;
  source.name = given.name.c_str();
  source.text = given.graph.data();
  source.length = given.graph.size();
  for (uint32_t round = 0; round < 5; ++round) {
    ASSERT_OK(abi_test::reload_text(host.graph(), source));
    for (uint32_t frame = 0; frame <= frames_in_flight; ++frame)
      ASSERT_OK(host.record_frame());
    EXPECT_EQ(host.device().alive(), alive);
    EXPECT_EQ(host.device().memory_bytes(), bytes);
  }
}

INSTANTIATE_TEST_SUITE_P(ShippedGraphs, FailingDevice,
                         ::testing::Values("burley", "separable", "sap"),
                         [](const auto& one) { return std::string(one.param); });

} // namespace
} // namespace dermis::test
