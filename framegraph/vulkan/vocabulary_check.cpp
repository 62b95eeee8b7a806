// Checks the framegraph's copies of Vulkan constants against the Vulkan headers, which the
// framegraph does not include.
#include "framegraph/model/vocabulary.hpp"

#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

static_assert(stage::none == VK_PIPELINE_STAGE_2_NONE);
static_assert(stage::draw_indirect == VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT);
static_assert(stage::compute_shader == VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
static_assert(stage::all_transfer == VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT);
static_assert(stage::host == VK_PIPELINE_STAGE_2_HOST_BIT);
static_assert(stage::all_commands == VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT);
static_assert(stage::copy == VK_PIPELINE_STAGE_2_COPY_BIT);
static_assert(stage::clear == VK_PIPELINE_STAGE_2_CLEAR_BIT);

static_assert(access::none == VK_ACCESS_2_NONE);
static_assert(access::indirect_command_read == VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
static_assert(access::uniform_read == VK_ACCESS_2_UNIFORM_READ_BIT);
static_assert(access::transfer_read == VK_ACCESS_2_TRANSFER_READ_BIT);
static_assert(access::transfer_write == VK_ACCESS_2_TRANSFER_WRITE_BIT);
static_assert(access::memory_read == VK_ACCESS_2_MEMORY_READ_BIT);
static_assert(access::memory_write == VK_ACCESS_2_MEMORY_WRITE_BIT);
static_assert(access::acceleration_structure_read ==
              VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR);
static_assert(access::shader_sampled_read == VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
static_assert(access::shader_storage_read == VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
static_assert(access::shader_storage_write == VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
static_assert(all_write_access ==
              (VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT |
               VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_SHADER_WRITE_BIT |
               VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
               VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT | VK_ACCESS_2_HOST_WRITE_BIT));

static_assert(static_cast<int>(Layout::undefined) == VK_IMAGE_LAYOUT_UNDEFINED);
static_assert(static_cast<int>(Layout::general) == VK_IMAGE_LAYOUT_GENERAL);
static_assert(static_cast<int>(Layout::depth_stencil_attachment) ==
              VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
static_assert(static_cast<int>(Layout::depth_stencil_read_only) ==
              VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL);
static_assert(static_cast<int>(Layout::shader_read_only) ==
              VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
static_assert(static_cast<int>(Layout::transfer_source) == VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
static_assert(static_cast<int>(Layout::transfer_destination) ==
              VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);

} // namespace dermis::vulkan
