#include "tests/support/vulkan_fixture.hpp"

#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <mutex>

namespace dermis::testing {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

// clang-format off
#define TEST_INSTANCE_FUNCTIONS(X) \
  X(vkDestroyInstance) X(vkCreateDebugUtilsMessengerEXT) X(vkDestroyDebugUtilsMessengerEXT) \
  X(vkEnumeratePhysicalDevices) X(vkGetPhysicalDeviceQueueFamilyProperties) X(vkGetPhysicalDeviceMemoryProperties) \
  X(vkCreateDevice) X(vkGetDeviceProcAddr) X(vkGetPhysicalDeviceProperties)
#define TEST_DEVICE_FUNCTIONS(X) \
  X(vkDestroyDevice) X(vkGetDeviceQueue) X(vkCreateCommandPool) X(vkDestroyCommandPool) X(vkAllocateCommandBuffers) \
  X(vkBeginCommandBuffer) X(vkEndCommandBuffer) X(vkQueueSubmit2) X(vkDeviceWaitIdle) X(vkCreateImage) \
  X(vkDestroyImage) X(vkGetImageMemoryRequirements) X(vkAllocateMemory) X(vkFreeMemory) X(vkBindImageMemory) \
  X(vkCreateImageView) X(vkDestroyImageView) X(vkCreateBuffer) X(vkDestroyBuffer) X(vkGetBufferMemoryRequirements) \
  X(vkBindBufferMemory) X(vkMapMemory) X(vkCmdPipelineBarrier2) X(vkCmdCopyBufferToImage) X(vkCmdCopyImageToBuffer)
// clang-format on

struct Staging {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  std::byte* mapped = nullptr;
};

uint32_t texel_bytes(VkFormat format) {
  switch (format) {
  case VK_FORMAT_R8_UINT:
    return 1;
  case VK_FORMAT_R16_SFLOAT:
    return 2;
  case VK_FORMAT_R32_SFLOAT:
  case VK_FORMAT_R32_UINT:
  case VK_FORMAT_D32_SFLOAT:
  case VK_FORMAT_R16G16_SFLOAT:
  case VK_FORMAT_R8G8B8A8_UNORM:
  case VK_FORMAT_R8G8B8A8_SRGB:
    return 4;
  case VK_FORMAT_R16G16B16A16_SFLOAT:
    return 8;
  case VK_FORMAT_R32G32B32A32_SFLOAT:
  case VK_FORMAT_R32G32B32A32_UINT:
    return 16;
  default:
    return 0;
  }
}

} // namespace

struct VulkanTest::Parts {
  void* loader = nullptr;
#define TEST_FUNCTION(name) PFN_##name name = nullptr;
  TEST_INSTANCE_FUNCTIONS(TEST_FUNCTION)
  TEST_DEVICE_FUNCTIONS(TEST_FUNCTION)
#undef TEST_FUNCTION
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  VkCommandPool pool = VK_NULL_HANDLE;
  VkPhysicalDeviceMemoryProperties memory{};
  std::vector<TestImage> images;
  std::vector<Staging> buffers;
  std::mutex mutex;
  std::vector<std::string> messages;

  static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                   VkDebugUtilsMessageTypeFlagsEXT,
                                                   const VkDebugUtilsMessengerCallbackDataEXT* data,
                                                   void* user) {
    auto& self = *static_cast<Parts*>(user);
    const std::lock_guard lock(self.mutex);
    self.messages.emplace_back(data->pMessage != nullptr ? data->pMessage : "message without text");
    return VK_FALSE;
  }

  uint32_t memory_type(uint32_t bits, VkMemoryPropertyFlags required_flags) const {
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i)
      if ((bits >> i & 1u) != 0 &&
          (memory.memoryTypes[i].propertyFlags & required_flags) == required_flags)
        return i;
    return 0;
  }
};

VulkanTest::VulkanTest() : parts_(std::make_unique<Parts>()) {}
VulkanTest::~VulkanTest() = default;

void VulkanTest::SetUp() {
  Parts& p = *parts_;
  p.loader = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  if (p.loader == nullptr) GTEST_SKIP() << "there is no Vulkan loader (libvulkan.so.1)";
  get_instance_proc_addr =
      reinterpret_cast<PFN_vkGetInstanceProcAddr>(dlsym(p.loader, "vkGetInstanceProcAddr"));
  const auto global = [&](const char* name) {
    return get_instance_proc_addr(VK_NULL_HANDLE, name);
  };

  const auto enumerate_layers = reinterpret_cast<PFN_vkEnumerateInstanceLayerProperties>(
      global("vkEnumerateInstanceLayerProperties"));
  uint32_t count = 0;
  enumerate_layers(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  enumerate_layers(&count, layers.data());
  bool layer_there = false;
  for (const VkLayerProperties& layer : layers)
    layer_there |= std::strcmp(layer.layerName, validation_layer) == 0;
  if (!layer_there) GTEST_SKIP() << "the layer " << validation_layer << " is not installed";

  // Only the environment can request synchronization validation across submissions (layer 1.3.239).
  setenv("VK_LAYER_ENABLES",
         "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT:"
         "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT",
         0);
  VkDebugUtilsMessengerCreateInfoEXT messenger{};
  messenger.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
  messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                              VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = Parts::on_message;
  messenger.pUserData = &p;
  const VkValidationFeatureEnableEXT enables[] = {
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT features{};
  features.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
  features.pNext = &messenger;
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enables;
  const char* extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                              VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  VkApplicationInfo application{};
  application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
  application.apiVersion = VK_API_VERSION_1_3;
  VkInstanceCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
  info.pNext = &features;
  info.pApplicationInfo = &application;
  info.enabledLayerCount = 1;
  info.ppEnabledLayerNames = &validation_layer;
  info.enabledExtensionCount = 2;
  info.ppEnabledExtensionNames = extensions;
  const auto create_instance = reinterpret_cast<PFN_vkCreateInstance>(global("vkCreateInstance"));
  const VkResult made = create_instance(&info, nullptr, &instance);
  if (made != VK_SUCCESS) {
    instance = VK_NULL_HANDLE;
    GTEST_SKIP() << "no Vulkan driver: vkCreateInstance gave " << made;
  }
  // A driver that stays loaded keeps its name in sanitizer reports, which identifies its own leaks.
  dlopen("libvulkan_lvp.so", RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE);
#define TEST_LOAD(name)                                                                            \
  p.name = reinterpret_cast<PFN_##name>(get_instance_proc_addr(instance, #name));
  TEST_INSTANCE_FUNCTIONS(TEST_LOAD)
#undef TEST_LOAD
  p.vkCreateDebugUtilsMessengerEXT(instance, &messenger, nullptr, &p.messenger);

  p.vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  p.vkEnumeratePhysicalDevices(instance, &count, devices.data());
  for (const VkPhysicalDevice candidate : devices) {
    VkPhysicalDeviceProperties properties{};
    p.vkGetPhysicalDeviceProperties(candidate, &properties);
    uint32_t families = 0;
    p.vkGetPhysicalDeviceQueueFamilyProperties(candidate, &families, nullptr);
    std::vector<VkQueueFamilyProperties> family(families);
    p.vkGetPhysicalDeviceQueueFamilyProperties(candidate, &families, family.data());
    for (uint32_t i = 0; i < families && physical == VK_NULL_HANDLE; ++i)
      if (properties.apiVersion >= VK_API_VERSION_1_3 &&
          (family[i].queueFlags & VK_QUEUE_COMPUTE_BIT) != 0) {
        physical = candidate;
        queue_family = i;
      }
  }
  if (physical == VK_NULL_HANDLE)
    GTEST_SKIP() << "no device with Vulkan 1.3 and compute among " << devices.size();
  p.vkGetPhysicalDeviceMemoryProperties(physical, &p.memory);

  const float priority = 1.0f;
  VkDeviceQueueCreateInfo queues{};
  queues.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
  queues.queueFamilyIndex = queue_family;
  queues.queueCount = 1;
  queues.pQueuePriorities = &priority;
  VkPhysicalDeviceVulkan13Features features13{};
  features13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
  features13.synchronization2 = VK_TRUE;
  features13.maintenance4 = VK_TRUE;
  VkPhysicalDeviceFeatures2 features2{};
  features2.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  features2.pNext = &features13;
  features2.features.shaderStorageImageWriteWithoutFormat = VK_TRUE;
  VkDeviceCreateInfo device_info{};
  device_info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
  device_info.pNext = &features2;
  device_info.queueCreateInfoCount = 1;
  device_info.pQueueCreateInfos = &queues;
  ASSERT_EQ(p.vkCreateDevice(physical, &device_info, nullptr, &device), VK_SUCCESS);
#define TEST_LOAD(name) p.name = reinterpret_cast<PFN_##name>(p.vkGetDeviceProcAddr(device, #name));
  TEST_DEVICE_FUNCTIONS(TEST_LOAD)
#undef TEST_LOAD
  p.vkGetDeviceQueue(device, queue_family, 0, &queue);
  VkCommandPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.queueFamilyIndex = queue_family;
  ASSERT_EQ(p.vkCreateCommandPool(device, &pool, nullptr, &p.pool), VK_SUCCESS);
}

void VulkanTest::TearDown() {
  Parts& p = *parts_;
  if (device != VK_NULL_HANDLE) {
    p.vkDeviceWaitIdle(device);
    for (const TestImage& image : p.images) {
      p.vkDestroyImageView(device, image.view, nullptr);
      p.vkDestroyImage(device, image.image, nullptr);
      p.vkFreeMemory(device, image.memory, nullptr);
    }
    for (const Staging& buffer : p.buffers) {
      p.vkDestroyBuffer(device, buffer.buffer, nullptr);
      p.vkFreeMemory(device, buffer.memory, nullptr);
    }
    p.vkDestroyCommandPool(device, p.pool, nullptr);
    p.vkDestroyDevice(device, nullptr); // Validation reports everything that still exists.
  }
  if (instance != VK_NULL_HANDLE) {
    p.vkDestroyDebugUtilsMessengerEXT(instance, p.messenger, nullptr);
    p.vkDestroyInstance(instance, nullptr);
  }
  // The loader stays loaded, because drivers start threads that outlive an unload.
  for (const std::string& message : take_messages())
    ADD_FAILURE() << message;
}

TestImage VulkanTest::make_image(VkFormat format, uint32_t width, uint32_t height,
                                 VkImageUsageFlags usage) {
  Parts& p = *parts_;
  TestImage result;
  result.format = format;
  result.width = width;
  result.height = height;
  result.texel_bytes = texel_bytes(format);
  EXPECT_GT(result.texel_bytes, 0u) << "the fixture does not know format " << format;
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = format;
  info.extent = {width, height, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage = usage | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  EXPECT_EQ(p.vkCreateImage(device, &info, nullptr, &result.image), VK_SUCCESS);
  VkMemoryRequirements needs{};
  p.vkGetImageMemoryRequirements(device, result.image, &needs);
  VkMemoryAllocateInfo memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  memory.allocationSize = needs.size;
  memory.memoryTypeIndex = p.memory_type(needs.memoryTypeBits, 0);
  EXPECT_EQ(p.vkAllocateMemory(device, &memory, nullptr, &result.memory), VK_SUCCESS);
  EXPECT_EQ(p.vkBindImageMemory(device, result.image, result.memory, 0), VK_SUCCESS);
  VkImageViewCreateInfo view{};
  view.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  view.image = result.image;
  view.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view.format = format;
  const bool depth = format == VK_FORMAT_D32_SFLOAT;
  view.subresourceRange = {
      VkImageAspectFlags(depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT), 0, 1, 0,
      1};
  EXPECT_EQ(p.vkCreateImageView(device, &view, nullptr, &result.view), VK_SUCCESS);
  p.images.push_back(result);
  return result;
}

namespace {

VkImageMemoryBarrier2 full_barrier(const TestImage& image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.image;
  const bool depth = image.format == VK_FORMAT_D32_SFLOAT;
  barrier.subresourceRange = {
      VkImageAspectFlags(depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT), 0, 1, 0,
      1};
  return barrier;
}

VkBufferImageCopy whole_copy(const TestImage& image) {
  VkBufferImageCopy copy{};
  const bool depth = image.format == VK_FORMAT_D32_SFLOAT;
  copy.imageSubresource = {
      VkImageAspectFlags(depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT), 0, 0, 1};
  copy.imageExtent = {image.width, image.height, 1};
  return copy;
}

constexpr VkBufferUsageFlags transfers =
    VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;

template <class Parts>
Staging make_staging(Parts& p, VkDevice device, uint64_t bytes,
                     VkBufferUsageFlags usage = transfers) {
  Staging staging;
  VkBufferCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
  info.size = bytes;
  info.usage = usage;
  EXPECT_EQ(p.vkCreateBuffer(device, &info, nullptr, &staging.buffer), VK_SUCCESS);
  VkMemoryRequirements needs{};
  p.vkGetBufferMemoryRequirements(device, staging.buffer, &needs);
  VkMemoryAllocateInfo memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  memory.allocationSize = needs.size;
  memory.memoryTypeIndex =
      p.memory_type(needs.memoryTypeBits,
                    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
  EXPECT_EQ(p.vkAllocateMemory(device, &memory, nullptr, &staging.memory), VK_SUCCESS);
  EXPECT_EQ(p.vkBindBufferMemory(device, staging.buffer, staging.memory, 0), VK_SUCCESS);
  void* mapped = nullptr;
  EXPECT_EQ(p.vkMapMemory(device, staging.memory, 0, VK_WHOLE_SIZE, 0, &mapped), VK_SUCCESS);
  staging.mapped = static_cast<std::byte*>(mapped);
  return staging;
}

template <class Parts> void free_staging(Parts& p, VkDevice device, const Staging& staging) {
  p.vkDestroyBuffer(device, staging.buffer, nullptr);
  p.vkFreeMemory(device, staging.memory, nullptr);
}

template <class Parts>
void record_barrier(Parts& p, VkCommandBuffer commands, const TestImage& image, VkImageLayout from,
                    VkImageLayout to) {
  const VkImageMemoryBarrier2 barrier = full_barrier(image, from, to);
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  p.vkCmdPipelineBarrier2(commands, &info);
}

} // namespace

VkBuffer VulkanTest::make_buffer(std::span<const std::byte> contents, VkBufferUsageFlags usage) {
  Parts& p = *parts_;
  const Staging made = make_staging(p, device, contents.size(), usage);
  std::memcpy(made.mapped, contents.data(), contents.size());
  p.buffers.push_back(made);
  return made.buffer;
}

void VulkanTest::upload(const TestImage& image, std::span<const std::byte> texels,
                        VkImageLayout layout) {
  Parts& p = *parts_;
  ASSERT_EQ(texels.size(), uint64_t{image.width} * image.height * image.texel_bytes);
  const Staging staging = make_staging(p, device, texels.size());
  std::memcpy(staging.mapped, texels.data(), texels.size());
  const VkCommandBuffer commands = begin_commands();
  record_barrier(p, commands, image, VK_IMAGE_LAYOUT_UNDEFINED,
                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  const VkBufferImageCopy copy = whole_copy(image);
  p.vkCmdCopyBufferToImage(commands, staging.buffer, image.image,
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
  record_barrier(p, commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, layout);
  submit(commands);
  wait();
  free_staging(p, device, staging);
}

void VulkanTest::transition(const TestImage& image, VkImageLayout layout) {
  const VkCommandBuffer commands = begin_commands();
  record_barrier(*parts_, commands, image, VK_IMAGE_LAYOUT_UNDEFINED, layout);
  submit(commands);
  wait();
}

std::vector<std::byte> VulkanTest::download(const TestImage& image, VkImageLayout layout) {
  Parts& p = *parts_;
  std::vector<std::byte> texels(uint64_t{image.width} * image.height * image.texel_bytes);
  const Staging staging = make_staging(p, device, texels.size());
  const VkCommandBuffer commands = begin_commands();
  record_barrier(p, commands, image, layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  const VkBufferImageCopy copy = whole_copy(image);
  p.vkCmdCopyImageToBuffer(commands, image.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           staging.buffer, 1, &copy);
  record_barrier(p, commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, layout);
  VkMemoryBarrier2 to_host{};
  to_host.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
  to_host.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
  to_host.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  to_host.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
  to_host.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &to_host;
  p.vkCmdPipelineBarrier2(commands, &info);
  submit(commands);
  wait();
  std::memcpy(texels.data(), staging.mapped, texels.size());
  free_staging(p, device, staging);
  return texels;
}

VkCommandBuffer VulkanTest::begin_commands() {
  Parts& p = *parts_;
  VkCommandBufferAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  info.commandPool = p.pool;
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  EXPECT_EQ(p.vkAllocateCommandBuffers(device, &info, &commands), VK_SUCCESS);
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  EXPECT_EQ(p.vkBeginCommandBuffer(commands, &begin), VK_SUCCESS);
  return commands;
}

void VulkanTest::submit(VkCommandBuffer commands) {
  Parts& p = *parts_;
  EXPECT_EQ(p.vkEndCommandBuffer(commands), VK_SUCCESS);
  VkCommandBufferSubmitInfo buffer{};
  buffer.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
  buffer.commandBuffer = commands;
  VkSubmitInfo2 info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &buffer;
  EXPECT_EQ(p.vkQueueSubmit2(queue, 1, &info, VK_NULL_HANDLE), VK_SUCCESS);
}

void VulkanTest::wait() {
  EXPECT_EQ(parts_->vkDeviceWaitIdle(device), VK_SUCCESS);
}

std::vector<std::string> VulkanTest::take_messages() {
  const std::lock_guard lock(parts_->mutex);
  return std::exchange(parts_->messages, {});
}

} // namespace dermis::testing
