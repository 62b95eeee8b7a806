#include "framegraph/vulkan/shader/loop_hints.hpp"

#include "framegraph/vulkan/shader/spirv.hpp"

namespace dermis::vulkan {
namespace {

constexpr uint32_t google = 0x1ae0, swiftshader = 0xc0de; // PCI ids that SwiftShader reports

// OpLoopMerge: the control mask follows the two labels (SPIR-V specification).
constexpr uint32_t control_word = 3, control_unroll = 0x1, control_dont_unroll = 0x2;

} // namespace

bool unrolls_without_end(const VkPhysicalDeviceProperties& device) {
  return device.vendorID == google && device.deviceID == swiftshader;
}

std::vector<uint32_t> without_unrolling(std::span<const uint32_t> spirv) {
  std::vector<uint32_t> out(spirv.begin(), spirv.end());
  for (size_t at = spirv::header_words; at < out.size();) {
    const uint32_t words = out[at] >> 16u, operation = out[at] & 0xffffu;
    if (words == 0 || words > out.size() - at) break;
    if (operation == spirv::op_loop_merge && words > control_word &&
        (out[at + control_word] & control_unroll) != 0)
      out[at + control_word] = (out[at + control_word] & ~control_unroll) | control_dont_unroll;
    at += words;
  }
  return out;
}

} // namespace dermis::vulkan
