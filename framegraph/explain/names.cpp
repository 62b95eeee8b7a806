#include "framegraph/explain/names.hpp"

#include "framegraph/model/image_range.hpp"

#include <fmt/format.h>

#include <iterator>

namespace dermis {
namespace {

struct Bit {
  uint64_t mask;
  std::string_view name;
};

constexpr Bit stage_bits[] = {
    {stage::draw_indirect, "draw_indirect"},
    {stage::compute_shader, "compute_shader"},
    {stage::all_transfer, "all_transfer"},
    {stage::host, "host"},
    {stage::all_commands, "all_commands"},
    {stage::copy, "copy"},
    {stage::clear, "clear"},
};

constexpr Bit access_bits[] = {
    {access::indirect_command_read, "indirect_command_read"},
    {access::uniform_read, "uniform_read"},
    {access::transfer_read, "transfer_read"},
    {access::transfer_write, "transfer_write"},
    {access::memory_read, "memory_read"},
    {access::memory_write, "memory_write"},
    {access::acceleration_structure_read, "acceleration_structure_read"},
    {access::shader_sampled_read, "shader_sampled_read"},
    {access::shader_storage_read, "shader_storage_read"},
    {access::shader_storage_write, "shader_storage_write"},
};

// Values of VkImageUsageFlagBits and VkBufferUsageFlagBits.
constexpr Bit image_usage_bits[] = {
    {0x1, "transfer_source"}, {0x2, "transfer_destination"}, {0x4, "sampled"},
    {0x8, "storage"},         {0x10, "color_attachment"},    {0x20, "depth_stencil_attachment"},
};
constexpr Bit buffer_usage_bits[] = {
    {0x1, "transfer_source"}, {0x2, "transfer_destination"}, {0x10, "uniform"},
    {0x20, "storage"},        {0x100, "indirect"},
};

template <size_t count> std::vector<std::string> names_of(uint64_t mask, const Bit (&bits)[count]) {
  std::vector<std::string> names;
  for (uint64_t bit = 1; bit != 0; bit <<= 1) {
    if ((mask & bit) == 0) continue;
    std::string name = fmt::format("{:#x}", bit);
    for (const Bit& known : bits)
      if (known.mask == bit) name = known.name;
    names.push_back(std::move(name));
  }
  return names;
}

std::string joined(const std::vector<std::string>& names) {
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, "|"));
}

} // namespace

std::vector<std::string> stage_names(Stage stages) {
  return names_of(stages, stage_bits);
}
std::vector<std::string> access_names(Access accesses) {
  return names_of(accesses, access_bits);
}
std::string stage_text(Stage stages) {
  return joined(stage_names(stages));
}
std::string access_text(Access accesses) {
  return joined(access_names(accesses));
}
std::string usage_text(ResourceType type, uint32_t vk_usage) {
  return joined(type == ResourceType::image ? names_of(vk_usage, image_usage_bits)
                                            : names_of(vk_usage, buffer_usage_bits));
}

std::string_view layout_name(Layout layout) {
  switch (layout) {
  case Layout::undefined:
    return "undefined";
  case Layout::general:
    return "general";
  case Layout::depth_stencil_attachment:
    return "depth_stencil_attachment";
  case Layout::depth_stencil_read_only:
    return "depth_stencil_read_only";
  case Layout::shader_read_only:
    return "shader_read_only";
  case Layout::transfer_source:
    return "transfer_source";
  case Layout::transfer_destination:
    return "transfer_destination";
  }
  return "unknown";
}

std::string_view why_name(PlanBarrier::ReasonKind why) {
  switch (why) {
  case PlanBarrier::ReasonKind::first_use:
    return "first_use";
  case PlanBarrier::ReasonKind::read_after_write:
    return "read_after_write";
  case PlanBarrier::ReasonKind::write_after_read:
    return "write_after_read";
  case PlanBarrier::ReasonKind::write_after_write:
    return "write_after_write";
  case PlanBarrier::ReasonKind::layout:
    return "layout";
  case PlanBarrier::ReasonKind::alias:
    return "alias";
  case PlanBarrier::ReasonKind::history:
    return "history";
  case PlanBarrier::ReasonKind::host_before:
    return "host_before";
  case PlanBarrier::ReasonKind::host_after:
    return "host_after";
  }
  return "unknown";
}

std::string_view queue_name(Queue queue) {
  return queue == Queue::main ? "main" : "async";
}

std::string_view transfer_name(PlanBarrier::Transfer transfer) {
  switch (transfer) {
  case PlanBarrier::Transfer::none:
    return "none";
  case PlanBarrier::Transfer::release:
    return "release";
  case PlanBarrier::Transfer::acquire:
    return "acquire";
  }
  return "unknown";
}

std::string_view read_when_name(ReadWhen when) {
  switch (when) {
  case ReadWhen::always:
    return "always";
  case ReadWhen::history_valid:
    return "history_valid";
  case ReadWhen::history_invalid:
    return "history_invalid";
  }
  return "unknown";
}

std::string_view read_when_text(ReadWhen when) {
  switch (when) {
  case ReadWhen::always:
    return "";
  case ReadWhen::history_valid:
    return " if valid";
  case ReadWhen::history_invalid:
    return " else";
  }
  return "";
}

std::string range_text(const PlanResource& resource, const SubresourceRange& range) {
  ImageRange image_range;
  const SubresourceRange whole = resource.whole();
  if (range.first_mip != whole.first_mip || range.mips != whole.mips) {
    image_range.first_mip = static_cast<uint8_t>(range.first_mip);
    image_range.mips = static_cast<uint8_t>(range.mips);
  }
  if (range.first_layer != whole.first_layer || range.layers != whole.layers) {
    image_range.first_layer = range.first_layer;
    image_range.layers = range.layers;
  }
  return image_range_text(image_range);
}

std::string shape_text(const PlanResource& resource) {
  std::string text = fmt::format("{}x{}", resource.width, resource.height);
  if (resource.mips > 1) text += fmt::format(", {} mips", resource.mips);
  if (resource.layers > 1) text += fmt::format(", {} layers", resource.layers);
  return text;
}

std::string bytes_text(uint64_t bytes) {
  constexpr std::string_view units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
  if (bytes < 1024) return fmt::format("{} B", bytes);
  auto amount = static_cast<double>(bytes);
  size_t unit = 0;
  for (; amount >= 1024.0 && unit + 1 < std::size(units); ++unit)
    amount /= 1024.0;
  return fmt::format("{:.1f} {}", amount, units[unit]);
}

} // namespace dermis
