// Graphs of a context share their kernels, including graphs that are created later.
#include "tests/integration/embedding/null_host.hpp"

#include <gtest/gtest.h>

namespace {

constexpr uint64_t objects_of_kernel = 2; // Pipeline layout, descriptor set layout.

TEST(SharedKernels, LaterGraph_CompilesNoSharedKernel) {
  dermis::abi_test::NullHost host;
  const dermis_context_desc desc = host.context_desc();
  ASSERT_OK(host.make_context(desc));
  const uint64_t before = host.device.alive();
  const auto make = [&] {
    const uint64_t start = host.device.creations();
    EXPECT_OK(host.make_graph());
    return host.device.creations() - start;
  };
  const uint64_t first = make();
  dermis_graph_destroy(host.graph);
  const uint64_t pipelines = host.device.pipelines();
  EXPECT_GT(pipelines, 0u);
  const uint64_t of_kernels = host.device.alive() - before - pipelines;
  EXPECT_EQ(of_kernels % objects_of_kernel, 0u);
  const uint64_t second = make();
  EXPECT_EQ(host.device.pipelines(), pipelines) << "all pipelines are shared";
  // A pipeline needs a shader module while it is created.
  EXPECT_EQ(first - second, of_kernels + 2 * pipelines);
  host.destroy();
  EXPECT_EQ(host.device.alive(), 0u);
}

TEST(SharedKernels, FailedGraph_KeepsNoKernels) {
  dermis::abi_test::NullHost host;
  const dermis_context_desc desc = host.context_desc();
  ASSERT_OK(host.make_context(desc));
  const uint64_t before = host.device.alive(), start = host.device.creations();
  ASSERT_OK(host.make_graph());
  const uint64_t last = host.device.creations() - start;
  dermis_graph_destroy(host.graph);
  host.graph = nullptr;
  const uint64_t kept = host.device.alive();
  dermis::abi_test::NullHost other;
  const dermis_context_desc other_desc = other.context_desc();
  ASSERT_OK(other.make_context(other_desc));
  other.device.fail_creation(last, VK_ERROR_OUT_OF_DEVICE_MEMORY);
  EXPECT_EQ(other.make_graph(), DERMIS_ERROR_DEVICE_MEMORY);
  EXPECT_EQ(other.device.alive(), before);
  EXPECT_OK(other.make_graph());
  dermis_graph_destroy(other.graph);
  other.graph = nullptr;
  EXPECT_EQ(other.device.alive(), kept);
}

TEST(SharedKernels, HostShaders_AreFreedWithTheLastGraph) {
  dermis::abi_test::NullHost host;
  const dermis_context_desc desc = host.context_desc();
  ASSERT_OK(host.make_context(desc));
  ASSERT_OK(host.make_graph());
  dermis_graph_destroy(host.graph);
  const uint64_t kept = host.device.alive();
  ASSERT_OK(host.make_graph());
  const uint64_t with_graph = host.device.alive();
  uint32_t requested = 0;
  const dermis_result result =
      dermis_graph_reload_shaders(host.graph, dermis::abi_test::open_kernel, &requested, nullptr);
  if (result == DERMIS_ERROR_UNSUPPORTED)
    GTEST_SKIP() << "this library compiles no shaders; test_shared_shaders is the one that does";
  ASSERT_OK(result);
  EXPECT_GT(host.device.alive(), with_graph);
  dermis_graph_destroy(host.graph);
  host.graph = nullptr;
  EXPECT_EQ(host.device.alive(), kept);
}

} // namespace
