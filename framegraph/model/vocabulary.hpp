#pragma once
// Defines formats, usages, and the synchronisation scopes that follow from a usage. Stages, access
// flags and layouts have the values of Vulkan 1.3 (VkPipelineStageFlagBits2, VkAccessFlagBits2,
// VkImageLayout) without including its headers; framegraph/vulkan/ asserts that they agree.

#include <cstdint>
#include <optional>
#include <string_view>

namespace dermis {

enum class Format : uint8_t {
  undefined,
  r8_unorm,
  r8_uint,
  r16_uint,
  r32_uint,
  r16f,
  r32f,
  rg8_unorm,
  rg16f,
  rg32f,
  rg32_uint,
  rgba8_unorm,
  rgba8_srgb,
  rgba16f,
  rgba32f,
  rgba32_uint,
  b10g11r11f,
  d16,
  d24,
  d32f,
  d24s8,
  d32fs8,
  count
};

struct FormatInfo {
  std::string_view name; // as written in a graph file
  uint32_t vulkan;       // VkFormat
  // packed size; memory sizes come from the driver's VkMemoryRequirements instead
  uint32_t bytes_per_texel;
  bool depth; // has a depth aspect
};

const FormatInfo& format_info(Format format);
// Returns whether shaders access the format as uint.
bool has_unsigned_components(Format format);
// Returns nullopt for an unknown name. The format class "depth" is not a format; the graph reader
// expands it.
std::optional<Format> format_from_name(std::string_view name);
std::optional<Format> format_from_vulkan(uint32_t vk_format);

using Stage = uint64_t;  // bits of VkPipelineStageFlags2
using Access = uint64_t; // bits of VkAccessFlags2

namespace stage {
inline constexpr Stage none = 0;
inline constexpr Stage draw_indirect = 0x2;
inline constexpr Stage compute_shader = 0x800;
inline constexpr Stage all_transfer = 0x1000;
inline constexpr Stage host = 0x4000;
inline constexpr Stage all_commands = 0x10000;
inline constexpr Stage copy = 0x100000000ull;
inline constexpr Stage clear = 0x800000000ull;
inline constexpr Stage known =
    draw_indirect | compute_shader | all_transfer | host | all_commands | copy | clear;
} // namespace stage

namespace access {
inline constexpr Access none = 0;
inline constexpr Access indirect_command_read = 0x1;
inline constexpr Access uniform_read = 0x8;
inline constexpr Access transfer_read = 0x800;
inline constexpr Access transfer_write = 0x1000;
inline constexpr Access memory_read = 0x8000;
inline constexpr Access memory_write = 0x10000;
inline constexpr Access acceleration_structure_read = 0x200000;
inline constexpr Access shader_sampled_read = 0x100000000ull;
inline constexpr Access shader_storage_read = 0x200000000ull;
inline constexpr Access shader_storage_write = 0x400000000ull;
} // namespace access

enum class Layout : uint32_t { // VkImageLayout
  undefined = 0,
  general = 1,
  depth_stencil_attachment = 3,
  depth_stencil_read_only = 4,
  shader_read_only = 5,
  transfer_source = 6,
  transfer_destination = 7
};

// How a pass uses the resource at a port. Stages, access masks and layouts follow from the usage
// and are never written in files.
enum class Usage : uint8_t {
  sampled_image, // compute shader, texelFetch or texture(); read only
  // compute shader, imageStore; texels that are not stored keep their contents
  storage_image_write,
  storage_image_update, // compute shader, imageLoad and imageStore of the same texels
  storage_buffer_read,
  storage_buffer_write,
  storage_buffer_update,
  indirect_arguments,     // read by vkCmdDispatchIndirect
  clear,                  // vkCmdFillBuffer / vkCmdClearColorImage
  acceleration_structure, // compute shader, ray queries; read only
  count
};

struct UsageInfo {
  std::string_view name;
  Stage stages;
  Access access;
  Layout layout;      // undefined for buffers
  uint32_t vk_usage;  // VkImageUsageFlags for images, VkBufferUsageFlags for buffers
  bool image, buffer; // resource types that may be bound; both for `clear`
  bool reads, writes;
  bool acceleration_structure = false; // may be bound
};

const UsageInfo& usage_info(Usage usage);

// A device capability that graphs, options of choices and pass types may require.
enum class Feature : uint8_t {
  ray_query, // VK_KHR_ray_query and VK_KHR_acceleration_structure
  count
};
using Features = uint32_t; // bit i: Feature i

constexpr Features bit_of(Feature feature) {
  return Features{1} << static_cast<uint32_t>(feature);
}
std::string_view feature_name(Feature feature); // as written in a graph file
std::optional<Feature> feature_from_name(std::string_view name);

inline constexpr Access all_write_access =
    access::transfer_write | access::memory_write | access::shader_storage_write |
    0x40 /* shader write */ | 0x100 /* colour attachment write */ |
    0x400 /* depth stencil write */ | 0x4000 /* host write */;
inline constexpr Access all_known_access =
    all_write_access | access::indirect_command_read | access::uniform_read |
    access::transfer_read | access::memory_read | access::acceleration_structure_read |
    access::shader_sampled_read | access::shader_storage_read;

} // namespace dermis
