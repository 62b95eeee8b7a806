// Tests which modules are changed for drivers that unroll loops without limit.
#include "framegraph/vulkan/shader/loop_hints.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {
namespace {

using namespace dermis::vulkan;

constexpr uint32_t loop_merge = 246, store = 62; // Opcodes of the SPIR-V specification.
constexpr uint32_t header[] = {0x07230203, 0x10600, 0, 9, 0};

std::vector<uint32_t> module_of(std::initializer_list<uint32_t> words) {
  std::vector<uint32_t> out(std::begin(header), std::end(header));
  out.insert(out.end(), words);
  return out;
}

TEST(LoopHints, UnrollHintBecomesDontUnroll) {
  const auto before = module_of({4u << 16 | loop_merge, 1, 2, 1, 3u << 16 | store, 1, 1,
                                 4u << 16 | loop_merge, 3, 4, 0, 4u << 16 | loop_merge, 5, 6, 2});
  const auto after = module_of({4u << 16 | loop_merge, 1, 2, 2, 3u << 16 | store, 1, 1,
                                4u << 16 | loop_merge, 3, 4, 0, 4u << 16 | loop_merge, 5, 6, 2});
  EXPECT_EQ(without_unrolling(before), after);
}

TEST(LoopHints, BrokenModulesStayUnchanged) {
  for (const auto& broken :
       {std::vector<uint32_t>{}, std::vector<uint32_t>{1, 2}, module_of({0}),
        module_of({9u << 16 | loop_merge, 1, 2, 1}), module_of({3u << 16 | loop_merge, 1, 1})})
    EXPECT_EQ(without_unrolling(broken), broken);
}

TEST(LoopHints, OnlySwiftShaderModulesChange) {
  VkPhysicalDeviceProperties device{};
  device.vendorID = 0x1ae0; // Google
  EXPECT_FALSE(unrolls_without_end(device));
  device.deviceID = 0xc0de;
  EXPECT_TRUE(unrolls_without_end(device));
  device.vendorID = 0x10005; // Mesa
  EXPECT_FALSE(unrolls_without_end(device));
}

} // namespace
} // namespace dermis::testing
