// Tests the messages for devices with missing features, failing calls, or unusable memory.

#include "framegraph/vulkan/function_table.hpp"
#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <cstring>
#include <set>
#include <string_view>

namespace dermis::abi_test {
namespace {

// The null device with missing features. Vulkan functions have no user pointer, so the state is
// static; tests of this file run sequentially.
struct Lack {
  std::set<std::string_view> functions; // Unknown to the loader.
  const char* renamed = ""; // A device function that is only known with the suffix "KHR".
  uint32_t api_version = VK_API_VERSION_1_3;
  // The device gives only functions of this version.
  uint32_t instance_version = VK_API_VERSION_1_3;
  bool extensions_enabled = false; // The device gives functions under their "KHR" names.
  bool features_unknown = false;   // A 1.0 instance without properties2.
  std::vector<const char*> extensions;
  VkQueueFlags queue_flags = VK_QUEUE_COMPUTE_BIT;
  VkResult enumeration = VK_SUCCESS;
};
Lack lack;

template <class Function> Function full(const char* name) {
  return reinterpret_cast<Function>(NullDevice::loader()(nullptr, name));
}

VKAPI_ATTR void VKAPI_CALL less_properties(VkPhysicalDevice device,
                                           VkPhysicalDeviceProperties* out) {
  full<PFN_vkGetPhysicalDeviceProperties>("vkGetPhysicalDeviceProperties")(device, out);
  out->apiVersion = lack.api_version;
}
VKAPI_ATTR void VKAPI_CALL less_families(VkPhysicalDevice device, uint32_t* count,
                                         VkQueueFamilyProperties* out) {
  full<PFN_vkGetPhysicalDeviceQueueFamilyProperties>("vkGetPhysicalDeviceQueueFamilyProperties")(
      device, count, out);
  if (out != nullptr) out->queueFlags = lack.queue_flags;
}
VKAPI_ATTR VkResult VKAPI_CALL some_extensions(VkPhysicalDevice, const char*, uint32_t* count,
                                               VkExtensionProperties* out) {
  if (lack.enumeration != VK_SUCCESS) return lack.enumeration;
  if (out != nullptr)
    for (uint32_t i = 0; i < lack.extensions.size(); ++i)
      std::strcpy(out[i].extensionName, lack.extensions[i]);
  *count = static_cast<uint32_t>(lack.extensions.size());
  return VK_SUCCESS;
}
VKAPI_ATTR void VKAPI_CALL no_features(VkPhysicalDevice, VkPhysicalDeviceFeatures2*) {}

// Returns the Vulkan version that added a function to the core.
uint32_t core_version_of(std::string_view name) {
  if (name.starts_with("vkBind") && name.ends_with("2")) return VK_API_VERSION_1_1;
  if (name == "vkResetQueryPool") return VK_API_VERSION_1_2;
  for (const char* added :
       {"vkCmdPipelineBarrier2", "vkCmdWriteTimestamp2", "vkGetDeviceImageMemoryRequirements",
        "vkGetDeviceBufferMemoryRequirements"})
    if (name == added) return VK_API_VERSION_1_3;
  return VK_API_VERSION_1_0;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL less_of_device(VkDevice device, const char* name) {
  const std::string_view requested = name;
  const bool khr = requested.ends_with("KHR");
  const std::string core(requested.substr(0, requested.size() - (khr ? 3 : 0)));
  if (core_version_of(core) > lack.instance_version) {
    if (!khr || !lack.extensions_enabled) return nullptr;
    return full<PFN_vkGetDeviceProcAddr>("vkGetDeviceProcAddr")(device, core.c_str());
  }
  if (lack.functions.contains(requested)) return nullptr;
  const bool extended =
      requested.ends_with("KHR") && requested.substr(0, requested.size() - 3) == lack.renamed;
  if (requested == lack.renamed) return nullptr;
  return full<PFN_vkGetDeviceProcAddr>("vkGetDeviceProcAddr")(device,
                                                              extended ? lack.renamed : name);
}
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL less(VkInstance instance, const char* name) {
  if (lack.functions.contains(name)) return nullptr;
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&less_of_device);
  if (std::strcmp(name, "vkGetPhysicalDeviceProperties") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&less_properties);
  if (std::strcmp(name, "vkGetPhysicalDeviceQueueFamilyProperties") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&less_families);
  if (lack.features_unknown && std::strcmp(name, "vkGetPhysicalDeviceFeatures2") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&no_features);
  if (std::strcmp(name, "vkEnumerateDeviceExtensionProperties") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&some_extensions);
  return NullDevice::loader()(instance, name);
}

struct PoorDevice : ::testing::Test {
  NullHost host;
  void SetUp() override { lack = {}; }
  dermis_result create() {
    dermis_context_desc desc = host.context_desc();
    desc.get_instance_proc_addr = less;
    return host.make_context(desc);
  }
  std::vector<dermis_requirement> requirements() const {
    uint32_t count = 0;
    EXPECT_OK(dermis_query_requirements(less, host.device.instance(), host.device.physical(),
                                        &count, nullptr));
    std::vector<dermis_requirement> items(count, dermis_requirement DERMIS_REQUIREMENT_INIT);
    EXPECT_OK(dermis_query_requirements(less, host.device.instance(), host.device.physical(),
                                        &count, items.data()));
    return items;
  }
};

TEST_F(PoorDevice, OlderVulkan_IsRejectedWithoutNewerQueries) {
  lack.api_version = VK_API_VERSION_1_1;
  EXPECT_THAT(create(), Fails(DERMIS_ERROR_UNSUPPORTED, "VK_API_VERSION_1_2", "synchronization2"));
  EXPECT_EQ(host.context, nullptr);
  for (const dermis_requirement& item : requirements())
    EXPECT_EQ(item.present, 0u) << item.name;
}

TEST_F(PoorDevice, Vulkan12_NeedsTwoExtensions) {
  lack.api_version = VK_API_VERSION_1_2;
  EXPECT_THAT(create(), Fails(DERMIS_ERROR_UNSUPPORTED, VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME,
                              VK_KHR_MAINTENANCE_4_EXTENSION_NAME));
  lack.extensions = {VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME};
  EXPECT_THAT(create(), Fails(DERMIS_ERROR_UNSUPPORTED, VK_KHR_MAINTENANCE_4_EXTENSION_NAME,
                              Not(HasSubstr(VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME))));
  lack.enumeration = VK_ERROR_OUT_OF_HOST_MEMORY;
  EXPECT_EQ(create(), DERMIS_ERROR_UNSUPPORTED) << "unqueryable features count as missing";
  lack.enumeration = VK_SUCCESS;
  lack.extensions.push_back(VK_KHR_MAINTENANCE_4_EXTENSION_NAME);
  for (const dermis_requirement& item : requirements())
    EXPECT_TRUE(item.present == 1 || item.required == 0) << item.name;
}

TEST_F(PoorDevice, NoFeatureQuery_EverythingIsMissing) {
  for (const char* function : {"vkGetPhysicalDeviceProperties", "vkGetPhysicalDeviceFeatures2"}) {
    lack.functions = {function};
    EXPECT_THAT(create(), Fails(DERMIS_ERROR_UNSUPPORTED, "synchronization2")) << function;
  }
  lack.functions = {"vkEnumerateDeviceExtensionProperties"};
  EXPECT_OK(create()) << "Vulkan 1.3 has all that is needed: ";
}

TEST_F(PoorDevice, EveryMissingFeatureIsNamedAtOnce) {
  lack.features_unknown = true;
  EXPECT_THAT(create(), Fails(DERMIS_ERROR_UNSUPPORTED, "synchronization2", "maintenance4",
                              "shaderStorageImageWriteWithoutFormat"));
}

#define DERMIS_NAME(name) #name,
constexpr const char* instance_functions[] = {DERMIS_INSTANCE_FUNCTIONS(DERMIS_NAME)};
constexpr const char* device_functions[] = {DERMIS_DEVICE_FUNCTIONS(DERMIS_NAME)};
constexpr const char* label_functions[] = {DERMIS_LABEL_FUNCTIONS(DERMIS_NAME)};
#undef DERMIS_NAME

TEST_F(PoorDevice, MissingFunction_IsNamed) {
  for (const char* name : instance_functions) {
    if (std::string_view(name) == "vkGetPhysicalDeviceProperties")
      continue; // Without this function no feature is queried, as above.
    lack.functions = {name};
    EXPECT_THAT(create(), Fails(DERMIS_ERROR_UNSUPPORTED, name)) << name;
  }
  for (const char* name : device_functions) {
    lack.functions = {name};
    EXPECT_THAT(create(), Fails(DERMIS_ERROR_UNSUPPORTED, "1 required function:", name)) << name;
    lack.functions = {};
    lack.renamed = name;
    EXPECT_OK(create()) << name << " of an extension: ";
    host.destroy();
    lack.renamed = "";
  }
}

TEST_F(PoorDevice, EveryMissingFunctionIsNamedAtOnce) {
  lack.functions = {"vkCmdDispatch", "vkCmdPipelineBarrier2",
                    "vkGetPhysicalDeviceFormatProperties2"};
  EXPECT_THAT(create(),
              Fails(DERMIS_ERROR_UNSUPPORTED, "3 required functions", "vkCmdDispatch",
                    "vkCmdPipelineBarrier2", "vkGetPhysicalDeviceFormatProperties2",
                    Not(HasSubstr("vkSetDebugUtilsObjectNameEXT")))); // labels are not requested
  EXPECT_EQ(host.context, nullptr);
}

TEST_F(PoorDevice, OlderInstance_IsNamedAsTheCause) {
  for (const uint32_t version : {VK_API_VERSION_1_0, VK_API_VERSION_1_1, VK_API_VERSION_1_2})
    for (const bool features_unknown : {false, true}) {
      lack.instance_version = version;
      lack.features_unknown = features_unknown && version == VK_API_VERSION_1_0;
      EXPECT_THAT(create(), Fails(DERMIS_ERROR_UNSUPPORTED, "VkApplicationInfo.apiVersion",
                                  "VK_API_VERSION_1_3", VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME,
                                  VK_KHR_MAINTENANCE_4_EXTENSION_NAME,
                                  Not(HasSubstr("physical device lacks")),
                                  Not(HasSubstr("device does not provide"))));
    }
}

TEST_F(PoorDevice, OlderInstanceWithExtensions_IsAccepted) {
  lack.instance_version = VK_API_VERSION_1_2;
  lack.extensions_enabled = true;
  EXPECT_OK(create());
}

TEST_F(PoorDevice, Instance11WithExtensions_IsNamedAsTheCause) {
  for (const uint32_t version : {VK_API_VERSION_1_0, VK_API_VERSION_1_1}) {
    lack.instance_version = version;
    lack.extensions_enabled = true;
    EXPECT_THAT(create(), Fails(DERMIS_ERROR_UNSUPPORTED, "VkApplicationInfo.apiVersion",
                                "VK_API_VERSION_1_2", Not(HasSubstr("device lacks"))));
  }
}

TEST_F(PoorDevice, Vulkan12WithoutEnabledExtension_NamesIt) {
  lack.api_version = lack.instance_version = VK_API_VERSION_1_2;
  lack.extensions = {VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME, VK_KHR_MAINTENANCE_4_EXTENSION_NAME};
  EXPECT_THAT(create(), Fails(DERMIS_ERROR_UNSUPPORTED, "ppEnabledExtensionNames",
                              VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME,
                              VK_KHR_MAINTENANCE_4_EXTENSION_NAME, Not(HasSubstr("apiVersion"))));
}

TEST_F(PoorDevice, MissingLabels_AreAnErrorOnlyIfRequested) {
  for (const char* name : label_functions) {
    lack.functions = {name};
    EXPECT_OK(create());
    host.destroy();
    dermis_context_desc desc = host.context_desc();
    desc.get_instance_proc_addr = less;
    desc.flags |= DERMIS_CONTEXT_LABELS;
    EXPECT_THAT(host.make_context(desc),
                Fails(DERMIS_ERROR_UNSUPPORTED, name, VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                      "VkInstanceCreateInfo.ppEnabledExtensionNames", Not(HasSubstr("device"))))
        << name;
  }
}

TEST_F(PoorDevice, QueueWithoutCompute_IsRejected) {
  lack.queue_flags = VK_QUEUE_GRAPHICS_BIT;
  EXPECT_THAT(create(), Fails(DERMIS_ERROR_ARGUMENT, "queue family 0 does not support compute"));
  EXPECT_EQ(host.context, nullptr);
}

TEST_F(PoorDevice, RayExtensions_FeaturesAreQueried) {
  lack.extensions = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME, VK_KHR_RAY_QUERY_EXTENSION_NAME};
  for (const dermis_requirement& item : requirements()) {
    if (item.type == DERMIS_REQUIREMENT_DEVICE_EXTENSION && item.required == 0) {
      EXPECT_EQ(item.present, 1u) << item.name;
    }
    if (std::strcmp(item.name, "rayQuery") == 0) {
      EXPECT_EQ(item.present, 0u) << "the device does not say so";
    }
  }
}

// ---- Results of Vulkan

TEST(VulkanResults, MapToTheDocumentedResults) {
  struct Case {
    VkResult given;
    dermis_result expected;
    const char* said;
  };
  const Case cases[] = {
      {VK_ERROR_OUT_OF_HOST_MEMORY, DERMIS_ERROR_MEMORY, "VK_ERROR_OUT_OF_HOST_MEMORY"},
      {VK_ERROR_OUT_OF_DEVICE_MEMORY, DERMIS_ERROR_DEVICE_MEMORY, "VK_ERROR_OUT_OF_DEVICE_MEMORY"},
      {VK_ERROR_OUT_OF_POOL_MEMORY, DERMIS_ERROR_DEVICE_MEMORY, "VK_ERROR_OUT_OF_POOL_MEMORY"},
      {VK_ERROR_FRAGMENTED_POOL, DERMIS_ERROR_DEVICE_MEMORY, "VK_ERROR_FRAGMENTED_POOL"},
      {VK_ERROR_FRAGMENTATION, DERMIS_ERROR_DEVICE_MEMORY, "VK_ERROR_FRAGMENTATION"},
      {VK_ERROR_FEATURE_NOT_PRESENT, DERMIS_ERROR_UNSUPPORTED, "VK_ERROR_FEATURE_NOT_PRESENT"},
      {VK_ERROR_FORMAT_NOT_SUPPORTED, DERMIS_ERROR_UNSUPPORTED, "VK_ERROR_FORMAT_NOT_SUPPORTED"},
      {VK_ERROR_MEMORY_MAP_FAILED, DERMIS_ERROR_VULKAN, "VK_ERROR_MEMORY_MAP_FAILED"},
      {VK_ERROR_TOO_MANY_OBJECTS, DERMIS_ERROR_VULKAN, "VK_ERROR_TOO_MANY_OBJECTS"},
      {VK_ERROR_INITIALIZATION_FAILED, DERMIS_ERROR_VULKAN, "VK_ERROR_INITIALIZATION_FAILED"},
      {VK_ERROR_INVALID_SHADER_NV, DERMIS_ERROR_VULKAN, "VK_ERROR_INVALID_SHADER_NV"},
      {VK_ERROR_UNKNOWN, DERMIS_ERROR_VULKAN, "VK_ERROR_UNKNOWN"},
      {VK_NOT_READY, DERMIS_ERROR_VULKAN, "VK_NOT_READY"},
      {VK_TIMEOUT, DERMIS_ERROR_VULKAN, "VK_TIMEOUT"},
      {VK_INCOMPLETE, DERMIS_ERROR_VULKAN, "VK_INCOMPLETE"},
      {VK_ERROR_SURFACE_LOST_KHR, DERMIS_ERROR_VULKAN, "-1000000000"},
      {VK_ERROR_DEVICE_LOST, DERMIS_ERROR_DEVICE_LOST, "VK_ERROR_DEVICE_LOST"},
  };
  for (const Case& one : cases) {
    NullHost host;
    ASSERT_OK(host.make_context(host.context_desc()));
    host.device.fail_creation(3, one.given);
    EXPECT_EQ(host.make_graph(), one.expected) << one.said;
    EXPECT_THAT(dermis_last_error(), HasAll(one.said, "failed (")) << one.said;
    EXPECT_EQ(host.device.alive(), 0u) << one.said;
    EXPECT_EQ(host.graph, nullptr);
  }
}

TEST(VulkanResults, FailedViewCreation_FrameCanBeRecordedAgain) {
  NullHost host;
  ASSERT_OK(host.start());
  host.give_up_views();
  for (uint64_t nth = 1; nth <= 2; ++nth) {
    host.device.fail_creation(nth, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    EXPECT_THAT(host.record(), Fails(DERMIS_ERROR_DEVICE_MEMORY, "vkCreateImageView", "bindings["));
    host.device.fail_creation(0, VK_SUCCESS);
  }
  EXPECT_OK(host.record());
  NullHost lost;
  ASSERT_OK(lost.start());
  lost.give_up_views();
  lost.device.fail_creation(1, VK_ERROR_DEVICE_LOST);
  EXPECT_EQ(lost.record(), DERMIS_ERROR_DEVICE_LOST);
  EXPECT_EQ(lost.record(), DERMIS_ERROR_DEVICE_LOST) << "the loss is kept";
}

// ---- Memory of the host

struct BadBlocks {
  enum class Fault { none, no_memory, misaligned, unmapped } fault = Fault::none;
  uint64_t alive = 0;
  uint64_t taken = 0, bad_at = 0; // Number of the block, from 1.

  static VkResult DERMIS_CALL take(void* user, const dermis_memory_request* request,
                                   dermis_memory_block* block) {
    BadBlocks& blocks = *static_cast<BadBlocks*>(user);
    static std::vector<std::byte> mapped(size_t{1} << 24);
    const bool bad = ++blocks.taken == blocks.bad_at;
    ++blocks.alive;
    block->memory = bad && blocks.fault == Fault::no_memory ? VK_NULL_HANDLE
                                                            : reinterpret_cast<VkDeviceMemory>(8);
    block->offset = bad && blocks.fault == Fault::misaligned ? request->alignment / 2 : 0;
    block->mapped = bad && blocks.fault == Fault::unmapped ? nullptr : mapped.data();
    return VK_SUCCESS;
  }
  static void DERMIS_CALL give_back(void* user, const dermis_memory_block*) {
    --static_cast<BadBlocks*>(user)->alive;
  }
};

TEST(HostsDeviceMemory, UnusableBlock_IsRejectedAndFreed) {
  const std::pair<BadBlocks::Fault, const char*> faults[] = {
      {BadBlocks::Fault::no_memory, "returned no memory"},
      {BadBlocks::Fault::misaligned, "not a multiple of"},
      {BadBlocks::Fault::unmapped, "returned memory that is not mapped"},
  };
  for (const auto& [fault, said] : faults) {
    uint32_t refusals = 0;
    for (uint64_t nth = 1;; ++nth) {
      BadBlocks blocks;
      blocks.fault = fault;
      blocks.bad_at = nth;
      dermis_device_allocator allocator = DERMIS_DEVICE_ALLOCATOR_INIT;
      allocator.allocate = BadBlocks::take;
      allocator.free = BadBlocks::give_back;
      allocator.user = &blocks;
      NullHost host;
      dermis_context_desc desc = host.context_desc();
      desc.device_allocator = &allocator;
      ASSERT_OK(host.make_context(desc));
      const dermis_result result = host.make_graph();
      if (result == DERMIS_ERROR_ARGUMENT) {
        ++refusals;
        EXPECT_THAT(dermis_last_error(), HasSubstr(said)) << nth;
        // A block without memory is not freed.
        EXPECT_EQ(blocks.alive, fault == BadBlocks::Fault::no_memory ? 1u : 0u) << nth;
      } else {
        EXPECT_OK(result);
        host.destroy();
        EXPECT_EQ(blocks.alive, 0u) << nth;
      }
      if (nth > blocks.taken) break;
    }
    EXPECT_GE(refusals, 1u) << said;
  }
}

TEST(HostsDeviceMemory, HalfAnAllocatorIsRejected) {
  NullHost host;
  dermis_context_desc desc = host.context_desc();
  dermis_device_allocator allocator = DERMIS_DEVICE_ALLOCATOR_INIT;
  desc.device_allocator = &allocator;
  EXPECT_THAT(host.make_context(desc),
              Fails(DERMIS_ERROR_ARGUMENT, "desc.device_allocator.allocate is NULL"));
  allocator.allocate = BadBlocks::take;
  EXPECT_THAT(host.make_context(desc),
              Fails(DERMIS_ERROR_ARGUMENT, "desc.device_allocator.free is NULL"));
}

} // namespace
} // namespace dermis::abi_test
