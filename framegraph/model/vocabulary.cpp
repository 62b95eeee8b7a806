#include "framegraph/model/vocabulary.hpp"

#include <array>

namespace dermis {
namespace {

constexpr auto format_count = static_cast<size_t>(Format::count);
constexpr auto usage_count = static_cast<size_t>(Usage::count);

// VkFormat values from the Vulkan 1.3 specification, "Format Definition".
constexpr std::array<FormatInfo, format_count> formats{{
    {"undefined", 0, 0, false},      {"r8_unorm", 9, 1, false},     {"r8_uint", 13, 1, false},
    {"r16_uint", 74, 2, false},      {"r32_uint", 98, 4, false},    {"r16f", 76, 2, false},
    {"r32f", 100, 4, false},         {"rg8_unorm", 16, 2, false},   {"rg16f", 83, 4, false},
    {"rg32f", 103, 8, false},        {"rg32_uint", 101, 8, false},  {"rgba8_unorm", 37, 4, false},
    {"rgba8_srgb", 43, 4, false},    {"rgba16f", 97, 8, false},     {"rgba32f", 109, 16, false},
    {"rgba32_uint", 107, 16, false}, {"b10g11r11f", 122, 4, false}, {"d16", 124, 2, true},
    {"d24", 125, 4, true},           {"d32f", 126, 4, true},        {"d24s8", 129, 4, true},
    {"d32fs8", 130, 8, true},
}};

// Bits of VkImageUsageFlags and VkBufferUsageFlags.
// the bit has the same value for images and buffers
constexpr uint32_t transfer_destination_usage = 0x2;
constexpr uint32_t sampled_image_usage = 0x4;
constexpr uint32_t storage_image_usage = 0x8;
constexpr uint32_t storage_buffer_usage = 0x20;
constexpr uint32_t indirect_buffer_usage = 0x100;

constexpr Access storage_update = access::shader_storage_read | access::shader_storage_write;

constexpr std::array<UsageInfo, usage_count> usages{{
    {"sampled_image", stage::compute_shader, access::shader_sampled_read, Layout::shader_read_only,
     sampled_image_usage, true, false, true, false},
    {"storage_image_write", stage::compute_shader, access::shader_storage_write, Layout::general,
     storage_image_usage, true, false, false, true},
    {"storage_image_update", stage::compute_shader, storage_update, Layout::general,
     storage_image_usage, true, false, true, true},
    {"storage_buffer_read", stage::compute_shader, access::shader_storage_read, Layout::undefined,
     storage_buffer_usage, false, true, true, false},
    {"storage_buffer_write", stage::compute_shader, access::shader_storage_write, Layout::undefined,
     storage_buffer_usage, false, true, false, true},
    {"storage_buffer_update", stage::compute_shader, storage_update, Layout::undefined,
     storage_buffer_usage, false, true, true, true},
    {"indirect_arguments", stage::draw_indirect, access::indirect_command_read, Layout::undefined,
     indirect_buffer_usage, false, true, true, false},
    // All transfer stages: vkCmdClearColorImage is a clear command, and some validation layers
    // treat vkCmdFillBuffer as a copy. A buffer has no layout, so readers of this table ignore the
    // layout for buffers.
    {"clear", stage::all_transfer, access::transfer_write, Layout::transfer_destination,
     transfer_destination_usage, true, true, false, true},
    {"acceleration_structure", stage::compute_shader, access::acceleration_structure_read,
     Layout::undefined, 0, false, false, true, false, true},
}};

constexpr std::array<std::string_view, static_cast<size_t>(Feature::count)> features{"ray_query"};

} // namespace

const FormatInfo& format_info(Format format) {
  return formats[static_cast<size_t>(format < Format::count ? format : Format::undefined)];
}

bool has_unsigned_components(Format format) {
  return format_info(format).name.find("_uint") != std::string_view::npos;
}

std::optional<Format> format_from_name(std::string_view name) {
  for (size_t i = 1; i < formats.size(); ++i)
    if (formats[i].name == name) return static_cast<Format>(i);
  return std::nullopt;
}

std::optional<Format> format_from_vulkan(uint32_t vk_format) {
  for (size_t i = 1; i < formats.size(); ++i)
    if (formats[i].vulkan == vk_format) return static_cast<Format>(i);
  return std::nullopt;
}

const UsageInfo& usage_info(Usage usage) {
  return usages[static_cast<size_t>(usage)];
}

std::string_view feature_name(Feature feature) {
  return features[static_cast<size_t>(feature)];
}

std::optional<Feature> feature_from_name(std::string_view name) {
  for (size_t i = 0; i < features.size(); ++i)
    if (features[i] == name) return static_cast<Feature>(i);
  return std::nullopt;
}

} // namespace dermis
