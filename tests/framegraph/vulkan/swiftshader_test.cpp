// Tests which modules are simplified for SwiftShader, and how.
#include "framegraph/vulkan/shader/swiftshader.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {
namespace {

using namespace dermis::vulkan;

// Operations of the SPIR-V specification.
constexpr uint32_t loop_merge = 246, store = 62, selection_merge = 247, branch = 249,
                   branch_conditional = 250, decorate = 71, spec_true = 48, spec_false = 49,
                   spec_op = 52, logical_not = 168, spec_id = 1, phi = 245, label = 248;
constexpr uint32_t header[] = {0x07230203, 0x10600, 0, 99, 0};

std::vector<uint32_t> module_of(std::initializer_list<std::vector<uint32_t>> instructions) {
  std::vector<uint32_t> out(std::begin(header), std::end(header));
  for (const std::vector<uint32_t>& one : instructions) {
    out.push_back(static_cast<uint32_t>(one.size()) << 16 | one[0]);
    out.insert(out.end(), one.begin() + 1, one.end());
  }
  return out;
}
std::vector<uint32_t> simplified(std::span<const uint32_t> spirv) {
  return simplify_for_swiftshader(spirv, {});
}

TEST(SwiftShader, UnrollHintBecomesDontUnroll) {
  const auto before = module_of(
      {{loop_merge, 1, 2, 1}, {store, 1, 1}, {loop_merge, 3, 4, 0}, {loop_merge, 5, 6, 2}});
  const auto after = module_of(
      {{loop_merge, 1, 2, 2}, {store, 1, 1}, {loop_merge, 3, 4, 0}, {loop_merge, 5, 6, 2}});
  EXPECT_EQ(simplified(before), after);
}

// Constant 10 has id 3 of the host, constant 11 its default, 12 is the opposite of 10.
TEST(SwiftShader, BranchesOnConstantsBecomeJumps) {
  const std::vector<uint32_t> declared[] = {{decorate, 10, spec_id, 3},
                                            {decorate, 11, spec_id, 4},
                                            {spec_true, 1, 10},
                                            {spec_true, 1, 11},
                                            {spec_op, 1, 12, logical_not, 10}};
  const auto with = [&](std::initializer_list<std::vector<uint32_t>> body) {
    std::vector<uint32_t> out =
        module_of({declared[0], declared[1], declared[2], declared[3], declared[4]});
    const std::vector<uint32_t> rest = module_of(body);
    out.insert(out.end(), rest.begin() + std::size(header), rest.end());
    return out;
  };
  const VkBool32 no = VK_FALSE;
  const VkSpecializationMapEntry entry{3, 0, sizeof(no)};
  const VkSpecializationInfo constants{1, &entry, sizeof(no), &no};
  const auto before = with({{selection_merge, 30, 0},
                            {branch_conditional, 10, 20, 21},
                            {label, 20},
                            {selection_merge, 31, 0},
                            {branch_conditional, 11, 22, 23},
                            {label, 22},
                            {loop_merge, 32, 33, 1},
                            {branch_conditional, 12, 24, 25},
                            {label, 24},
                            {selection_merge, 34, 0},
                            {branch_conditional, 13, 26, 27}});
  const auto after = with({{branch, 21},
                           {label, 20},
                           {branch, 22},
                           {label, 22},
                           {loop_merge, 32, 33, 2},
                           {branch, 24},
                           {label, 24},
                           {selection_merge, 34, 0},
                           {branch_conditional, 13, 26, 27}});
  EXPECT_EQ(simplify_for_swiftshader(before, constants), after);
}

// The block after `constant && value` takes its value from the block that it comes from.
TEST(SwiftShader, BranchesPastAPhiStay) {
  const auto module = module_of({{spec_false, 1, 10},
                                 {selection_merge, 21, 0},
                                 {branch_conditional, 10, 21, 20},
                                 {label, 20},
                                 {branch, 21},
                                 {label, 21},
                                 {phi, 1, 30, 10, 5, 31, 20}});
  EXPECT_EQ(simplified(module), module);
}

TEST(SwiftShader, BrokenModulesStayUnchanged) {
  for (const auto& broken :
       {std::vector<uint32_t>{}, std::vector<uint32_t>{1, 2},
        std::vector<uint32_t>{1, 2, 3, 4, 5, 0},
        std::vector<uint32_t>{1, 2, 3, 4, 5, 9u << 16 | loop_merge, 1, 2, 1},
        module_of({{loop_merge, 1, 1}}), module_of({{branch_conditional, 1}}),
        module_of({{decorate, 1}, {spec_false}, {spec_op, 1, 2, logical_not}})})
    EXPECT_EQ(simplified(broken), broken);
}

TEST(SwiftShader, OtherDriversAreNotSwiftShader) {
  VkPhysicalDeviceProperties device{};
  device.vendorID = 0x1ae0; // Google
  EXPECT_FALSE(is_swiftshader(device));
  device.deviceID = 0xc0de;
  EXPECT_TRUE(is_swiftshader(device));
  device.vendorID = 0x10005; // Mesa
  EXPECT_FALSE(is_swiftshader(device));
}

} // namespace
} // namespace dermis::testing
