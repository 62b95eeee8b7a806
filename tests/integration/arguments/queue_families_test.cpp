// Tests queue families of states: zeroed memory causes no transfer, and special families have
// names.

#include "tests/integration/embedding/null_host.hpp"

#include <cstring>
#include <functional>

namespace dermis::abi_test {
namespace {

constexpr uint32_t own_family = 1, family_count = 3;
// Vulkan functions have no user pointer; tests of this file run sequentially.
bool foreign_queues = false;

VKAPI_ATTR void VKAPI_CALL three_families(VkPhysicalDevice, uint32_t* count,
                                          VkQueueFamilyProperties* out) {
  for (uint32_t i = 0; out != nullptr && i < *count; ++i)
    out[i] = {VK_QUEUE_COMPUTE_BIT, 1, 64, {1, 1, 1}};
  *count = family_count;
}
VKAPI_ATTR VkResult VKAPI_CALL extensions(VkPhysicalDevice, const char*, uint32_t* count,
                                          VkExtensionProperties* out) {
  if (out != nullptr && foreign_queues)
    std::strcpy(out->extensionName, VK_EXT_QUEUE_FAMILY_FOREIGN_EXTENSION_NAME);
  *count = foreign_queues ? 1 : 0;
  return VK_SUCCESS;
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL load(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkGetPhysicalDeviceQueueFamilyProperties") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&three_families);
  if (std::strcmp(name, "vkEnumerateDeviceExtensionProperties") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&extensions);
  return NullDevice::loader()(instance, name);
}

struct QueueFamilies : ::testing::Test {
  NullHost host;
  std::vector<dermis_image_binding> bindings;
  dermis_frame frame = DERMIS_FRAME_INIT;

  void make(bool with_foreign_queues) {
    foreign_queues = with_foreign_queues;
    dermis_context_desc desc = host.context_desc();
    desc.get_instance_proc_addr = load;
    desc.queue_family = own_family;
    ASSERT_OK(host.make_context(desc));
    ASSERT_OK(host.make_graph());
    host.make_bindings();
    frame = host.frame_at(1);
    bindings.assign(frame.bindings, frame.bindings + frame.binding_count);
    frame.bindings = bindings.data();
  }

  // Returns the source and destination families of each ownership transfer, in order.
  std::vector<std::pair<uint32_t, uint32_t>> transfers() {
    std::vector<std::pair<uint32_t, uint32_t>> found;
    uint32_t count = 0;
    const dermis_command* commands = nullptr;
    EXPECT_OK(dermis_view_commands(dermis_graph_view(host.graph), &frame, &count, &commands));
    for (uint32_t i = 0; i < count; ++i) {
      if (commands[i].type != DERMIS_COMMAND_BARRIER) continue;
      const VkDependencyInfo& info = *commands[i].dependency;
      for (uint32_t b = 0; b < info.imageMemoryBarrierCount; ++b)
        if (const VkImageMemoryBarrier2& barrier = info.pImageMemoryBarriers[b];
            barrier.srcQueueFamilyIndex != barrier.dstQueueFamilyIndex)
          found.emplace_back(barrier.srcQueueFamilyIndex, barrier.dstQueueFamilyIndex);
    }
    ++frame.frame_index;
    ++frame.completed_frame_index;
    return found;
  }
};

TEST_F(QueueFamilies, ZeroedMemoryTransfersNothing) {
  make(false);
  for (dermis_image_binding& binding : bindings) {
    std::memset(&binding.before, 0, sizeof binding.before);
    std::memset(&binding.after, 0, sizeof binding.after);
    binding.before.layout = binding.after.layout = VK_IMAGE_LAYOUT_GENERAL;
  }
  EXPECT_TRUE(transfers().empty());
  bindings[0].before.queue_family = bindings[0].after.queue_family = VK_QUEUE_FAMILY_IGNORED;
  EXPECT_TRUE(transfers().empty());
  bindings[0].before.queue_family = bindings[0].after.queue_family = own_family;
  EXPECT_TRUE(transfers().empty());
}

TEST_F(QueueFamilies, TransfersReachFamilyZeroAndSpecialFamilies) {
  make(true);
  for (const uint32_t family : {0u, 2u, VK_QUEUE_FAMILY_EXTERNAL, VK_QUEUE_FAMILY_FOREIGN_EXT}) {
    bindings[0].before.queue_family = bindings[0].after.queue_family = family;
    bindings[0].before.transfer = bindings[0].after.transfer = 1;
    EXPECT_THAT(transfers(),
                ElementsAre(std::pair{family, own_family}, std::pair{own_family, family}));
  }
  bindings[0].before.queue_family = bindings[0].after.queue_family = own_family;
  EXPECT_TRUE(transfers().empty()) << "no transfer within one family";
}

TEST_F(QueueFamilies, InvalidFamilies_AreRejectedByName) {
  make(false);
  const std::tuple<const char*, uint32_t, uint32_t> wrong[] = {
      {"bindings[0].after ('lighting'): queue_family is 2 and transfer 0; set transfer to 1", 2, 0},
      {"queue_family is VK_QUEUE_FAMILY_EXTERNAL and transfer 0", VK_QUEUE_FAMILY_EXTERNAL, 0},
      {"queue_family is VK_QUEUE_FAMILY_IGNORED and transfer 1", VK_QUEUE_FAMILY_IGNORED, 1},
      {"queue_family is 3, the device has 3 families", 3, 1},
      {"queue_family is VK_QUEUE_FAMILY_FOREIGN_EXT, which needs VK_EXT_queue_family_foreign",
       VK_QUEUE_FAMILY_FOREIGN_EXT, 1},
      {"transfer is 2, expected 0 or 1", 0, 2},
  };
  for (const auto& [text, family, transfer] : wrong) {
    bindings[0].after.queue_family = family;
    bindings[0].after.transfer = transfer;
    EXPECT_THAT(dermis_view_record(dermis_graph_view(host.graph), &frame),
                Fails(DERMIS_ERROR_ARGUMENT, text))
        << text;
  }
}

TEST_F(QueueFamilies, TransferOfNoContents_IsRejected) {
  make(false);
  bindings[0].before.queue_family = 2;
  bindings[0].before.transfer = 1;
  bindings[0].before.layout = VK_IMAGE_LAYOUT_PREINITIALIZED;
  EXPECT_THAT(dermis_view_record(dermis_graph_view(host.graph), &frame),
              Fails(DERMIS_ERROR_ARGUMENT, "bindings[0].before ('lighting') transfers an image",
                    "PREINITIALIZED"));
}

} // namespace
} // namespace dermis::abi_test
