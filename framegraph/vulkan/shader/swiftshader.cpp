#include "framegraph/vulkan/shader/swiftshader.hpp"

#include "framegraph/vulkan/shader/spirv.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <map>
#include <optional>
#include <set>

namespace dermis::vulkan {
namespace {

constexpr uint32_t google = 0x1ae0, swiftshader = 0xc0de; // PCI ids that SwiftShader reports

// OpLoopMerge: the control mask follows the two labels (SPIR-V specification).
constexpr uint32_t control_word = 3, control_unroll = 0x1, control_dont_unroll = 0x2;
constexpr uint32_t words_of_branch = 2;

using Instruction = std::span<const uint32_t>; // the first word holds length and operation
uint32_t operation_of(Instruction one) {
  return one[0] & 0xffffu;
}

// Values of boolean specialization constants, by id of the module.
class Booleans {
public:
  explicit Booleans(const VkSpecializationInfo& constants) : constants_(constants) {}

  // Learns from an instruction of the module; decorations come before constants.
  void add(Instruction one) {
    switch (operation_of(one)) {
    case spirv::op_decorate:
      if (one.size() > 3 && one[2] == spirv::decoration_spec_id) spec_ids_[one[1]] = one[3];
      break;
    case spirv::op_spec_constant_true:
    case spirv::op_spec_constant_false:
      if (one.size() > 2)
        values_[one[2]] =
            specialized(one[2]).value_or(operation_of(one) == spirv::op_spec_constant_true);
      break;
    case spirv::op_spec_constant_op:
      if (one.size() > 4 && one[3] == spirv::op_logical_not)
        if (const std::optional<bool> value = value_of(one[4])) values_[one[2]] = !*value;
      break;
    default:
      break;
    }
  }
  std::optional<bool> value_of(uint32_t id) const {
    const auto found = values_.find(id);
    return found != values_.end() ? std::optional(found->second) : std::nullopt;
  }

private:
  std::optional<bool> specialized(uint32_t id) const {
    const auto spec_id = spec_ids_.find(id);
    if (spec_id == spec_ids_.end()) return {};
    for (const VkSpecializationMapEntry& entry :
         std::span(constants_.pMapEntries, constants_.mapEntryCount)) {
      VkBool32 value = VK_FALSE;
      if (entry.constantID != spec_id->second || entry.size != sizeof(value)) continue;
      std::memcpy(&value, static_cast<const char*>(constants_.pData) + entry.offset, sizeof(value));
      return value != VK_FALSE;
    }
    return {};
  }

  const VkSpecializationInfo& constants_;
  std::map<uint32_t, uint32_t> spec_ids_;
  std::map<uint32_t, bool> values_;
};

// Calls `visit(instruction)` in order. Returns false if the module is not SPIR-V.
template <class Visit> bool for_each_instruction(std::span<const uint32_t> spirv, Visit visit) {
  for (size_t at = spirv::header_words; at < spirv.size();) {
    const uint32_t words = spirv[at] >> 16u;
    if (words == 0 || words > spirv.size() - at) return false;
    visit(spirv.subspan(at, words));
    at += words;
  }
  return spirv.size() >= spirv::header_words;
}

// Labels of the blocks whose values depend on the block that control comes from.
using Labels = std::set<uint32_t>;

Labels labels_with_phi(std::span<const uint32_t> spirv) {
  Labels labels;
  uint32_t last_label = 0;
  for_each_instruction(spirv, [&](Instruction one) {
    if (operation_of(one) == spirv::op_label && one.size() > 1) last_label = one[1];
    if (operation_of(one) == spirv::op_phi) labels.insert(last_label);
  });
  return labels;
}

// Adds an instruction to a module whose last instruction begins at `last`. Returns its position.
size_t append(Instruction one, const Booleans& booleans, const Labels& with_phi, size_t last,
              std::vector<uint32_t>& out) {
  const bool branches = operation_of(one) == spirv::op_branch_conditional && one.size() > 3;
  const std::optional<bool> value = branches ? booleans.value_of(one[1]) : std::nullopt;
  if (value && !with_phi.contains(*value ? one[3] : one[2])) {
    if (operation_of(std::span(out).subspan(last)) == spirv::op_selection_merge) out.resize(last);
    const size_t at = out.size();
    out.insert(out.end(), {words_of_branch << 16u | spirv::op_branch, *value ? one[2] : one[3]});
    return at;
  }
  const size_t at = out.size();
  out.insert(out.end(), one.begin(), one.end());
  if (operation_of(one) == spirv::op_loop_merge && one.size() > control_word &&
      (one[control_word] & control_unroll) != 0)
    out[at + control_word] = (one[control_word] & ~control_unroll) | control_dont_unroll;
  return at;
}

} // namespace

bool is_swiftshader(const VkPhysicalDeviceProperties& device) {
  return device.vendorID == google && device.deviceID == swiftshader;
}

std::vector<uint32_t> simplify_for_swiftshader(std::span<const uint32_t> spirv,
                                               const VkSpecializationInfo& constants) {
  const Labels with_phi = labels_with_phi(spirv);
  Booleans booleans(constants);
  std::vector<uint32_t> out(spirv.begin(), spirv.begin() + std::ptrdiff_t(std::min<size_t>(
                                                               spirv.size(), spirv::header_words)));
  size_t last = 0;
  const bool read = for_each_instruction(spirv, [&](Instruction one) {
    booleans.add(one);
    last = append(one, booleans, with_phi, last, out);
  });
  return read ? out : std::vector<uint32_t>(spirv.begin(), spirv.end());
}

} // namespace dermis::vulkan
