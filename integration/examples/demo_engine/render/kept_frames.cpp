#include "integration/examples/demo_engine/render/kept_frames.hpp"

namespace demo {
namespace {

constexpr uint64_t max_bytes = uint64_t{1} << 30;

// All targets of the scene except `shading`, which only lighting reads.
constexpr std::array kept_targets = {
    Target::depth,    Target::normal,   Target::albedo,   Target::material,  Target::finish,
    Target::velocity, Target::lighting, Target::specular, Target::thickness, Target::back_lighting};

constexpr ImageState source = {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                               VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
constexpr ImageState destination = {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                    VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                    VK_ACCESS_2_TRANSFER_WRITE_BIT};

// Parts are consecutive in a frame's buffer, each at a multiple of the largest texel.
struct KeptPart {
  Target target;
  VkBufferImageCopy region;
};

struct Layout {
  std::vector<KeptPart> parts;
  uint64_t bytes = 0;
};

Layout layout_of(const Renderer& renderer) {
  constexpr uint64_t alignment = 16;
  Layout layout;
  for (const Target target : kept_targets) {
    const Image& image = renderer[target];
    VkBufferImageCopy region{};
    region.bufferOffset = layout.bytes;
    region.imageSubresource = {image.aspect, 0, 0, 1};
    region.imageExtent = {image.width, image.height, 1};
    layout.parts.push_back({target, region});
    const uint64_t size =
        uint64_t{image.width} * image.height * find_pixel_format(image.format)->bytes;
    layout.bytes += (size + alignment - 1) / alignment * alignment;
  }
  return layout;
}

} // namespace

std::array<VkImageUsageFlags, target_count> usage_for_keeping() {
  std::array<VkImageUsageFlags, target_count> usage{};
  for (const Target target : kept_targets)
    usage[static_cast<size_t>(target)] =
        VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  return usage;
}

Result<> keep_frame(KeptFrames& kept, const Renderer& renderer, uint32_t frame) {
  VulkanHost& host = *renderer.host;
  const Layout layout = layout_of(renderer);
  if (kept.bytes + layout.bytes > max_bytes) return success();
  auto buffer =
      create_buffer(host, layout.bytes,
                    VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, false);
  if (!buffer) return buffer.error();
  const auto done = run_commands(host, [&](VkCommandBuffer commands) {
    for (const KeptPart& part : layout.parts) {
      const Image& image = renderer[part.target];
      transition(host, commands, image, resting, source);
      host.vk.vkCmdCopyImageToBuffer(commands, image.image, source.layout, buffer->buffer, 1,
                                     &part.region);
      transition(host, commands, image, source, resting);
    }
    // makes the copies visible to later copies back
    memory_barrier(host, commands, destination, source);
    return success();
  });
  if (!done) return done.error();
  kept.frames[frame] = buffer.take();
  kept.bytes += layout.bytes;
  return success();
}

void record_kept(const KeptFrames& kept, const Renderer& renderer, VkCommandBuffer commands,
                 uint32_t frame) {
  const VulkanHost& host = *renderer.host;
  const VkBuffer buffer = kept.frames.at(frame).buffer;
  for (const KeptPart& part : layout_of(renderer).parts) {
    const Image& image = renderer[part.target];
    transition(host, commands, image, resting, destination);
    host.vk.vkCmdCopyBufferToImage(commands, buffer, image.image, destination.layout, 1,
                                   &part.region);
    transition(host, commands, image, destination, resting);
  }
}

} // namespace demo
