// The shipped kernels match the signatures that define descriptor layouts and push constants.
#include "framegraph/vulkan/shader/signature_check.hpp"
#include "passes/common/environment.hpp"
#include "passes/common/kernels.hpp"
#include "passes/common/pass_types.hpp"

#include <gtest/gtest.h>

namespace dermis::subsurface {
namespace {

TEST(Kernels, EveryKernelMatchesItsSignature) {
  using vulkan::EnvironmentType;
  // The separable table ends in an array of the length of the buffer.
  constexpr uint64_t any = 1u << 16;
  const vulkan::EnvironmentBinding environment[] = {
      {EnvironmentType::uniform_buffer, sizeof(FrameConstants), {}},
      {EnvironmentType::storage_buffer, profile_capacity * sizeof(ProfileEntry), {}},
      {EnvironmentType::storage_buffer, any, {}},
      {EnvironmentType::linear_sampler, 0, {}},
      {EnvironmentType::storage_buffer, any, {}},
      {EnvironmentType::storage_buffer, any, {}},
      {EnvironmentType::counters, sizeof(FrameCounters), {}},
  };
  const PassTypeRegistry pass_types = make_pass_types();
  ASSERT_GT(pass_types.size(), 0u);
  for (uint32_t i = 0; i < pass_types.size(); ++i) {
    const PassType& type = pass_types[PassTypeId{i}];
    if (type.shader.empty()) continue;
    std::string error;
    const auto reflection = vulkan::reflect(find_kernel(type.shader), error);
    ASSERT_TRUE(reflection) << type.shader << ": " << error;
    for (const std::string& line : vulkan::check_signature(type, environment, *reflection))
      ADD_FAILURE() << line;
  }
}

// maxComputeWorkGroupInvocations is at least 128 on every device.
TEST(Kernels, EveryKernelFitsTheGuaranteedGroupSize) {
  for (const Kernel& kernel : embedded_kernels()) {
    std::string error;
    const auto reflection = vulkan::reflect(kernel.spirv, error);
    ASSERT_TRUE(reflection) << kernel.shader << ": " << error;
    const auto [x, y, z] = reflection->local_size;
    EXPECT_LE(uint64_t{x} * y * z, 128u) << kernel.shader;
  }
}

TEST(Kernels, TheFrameConstantsOfCppAndGlslHaveOneSize) {
  for (const Kernel& kernel : embedded_kernels()) {
    std::string error;
    const auto reflection = vulkan::reflect(kernel.spirv, error);
    ASSERT_TRUE(reflection) << kernel.shader << ": " << error;
    for (const auto& binding : reflection->bindings) {
      if (binding.set == 1 && binding.binding == static_cast<uint32_t>(EnvironmentSlot::frame)) {
        EXPECT_EQ(binding.bytes, sizeof(FrameConstants)) << kernel.shader;
      }
    }
  }
}

} // namespace
} // namespace dermis::subsurface
