// Tests the requirements on a device, and the messages if a requirement is missing.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <cstring>

namespace dermis::abi_test {
namespace {

struct Context : DermisTest {};

TEST_F(Context, RequirementsAreListedWithTheirReasonAndPresence) {
  uint32_t count = 0;
  ASSERT_OK(dermis_query_requirements(vkGetInstanceProcAddr, host->instance, host->physical_device,
                                      &count, nullptr));
  std::vector<dermis_requirement> items(count, dermis_requirement DERMIS_REQUIREMENT_INIT);
  ASSERT_OK(dermis_query_requirements(vkGetInstanceProcAddr, host->instance, host->physical_device,
                                      &count, items.data()));
  ASSERT_EQ(items.size(), count);
  for (const dermis_requirement& item : items) {
    EXPECT_TRUE(item.required == 0 || item.present == 1) << item.name;
    EXPECT_GT(std::strlen(item.why), 10u) << item.name;
  }
  uint32_t capacity = count - 1;
  items.back().name = nullptr;
  EXPECT_EQ(dermis_query_requirements(vkGetInstanceProcAddr, host->instance, host->physical_device,
                                      &capacity, items.data()),
            DERMIS_INCOMPLETE);
  EXPECT_EQ(capacity, count);
  EXPECT_EQ(items.back().name, nullptr) << "no element beyond the capacity is written";
}

// A loader that hides two functions, as by a host's mistake or an old driver.
PFN_vkVoidFunction VKAPI_CALL hiding_device_proc_addr(VkDevice device, const char* name) {
  if (std::strcmp(name, "vkCmdPipelineBarrier2") == 0 ||
      std::strcmp(name, "vkCmdDispatchIndirect") == 0)
    return nullptr;
  return vkGetDeviceProcAddr(device, name);
}
PFN_vkVoidFunction VKAPI_CALL hiding_proc_addr(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&hiding_device_proc_addr);
  return vkGetInstanceProcAddr(instance, name);
}

TEST_F(Context, EveryMissingFunctionIsNamedAtOnce) {
  dermis_context_desc desc = context_desc();
  desc.get_instance_proc_addr = hiding_proc_addr;
  dermis_context other = nullptr;
  EXPECT_EQ(dermis_context_create(&desc, &other), DERMIS_ERROR_UNSUPPORTED);
  EXPECT_EQ(other, nullptr);
  EXPECT_THAT(dermis_last_error(), HasAll("vkCmdPipelineBarrier2", "vkCmdDispatchIndirect"));
  EXPECT_FALSE(logged.empty()) << "the log callback gets the same message";
  EXPECT_EQ(logged.back(), dermis_last_error());
}

void VKAPI_CALL featureless(VkPhysicalDevice, VkPhysicalDeviceFeatures2*) {}
PFN_vkVoidFunction VKAPI_CALL featureless_proc_addr(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkGetPhysicalDeviceFeatures2") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&featureless);
  return vkGetInstanceProcAddr(instance, name);
}

TEST_F(Context, EveryMissingFeatureIsNamedAtOnce) {
  dermis_context_desc desc = context_desc();
  desc.get_instance_proc_addr = featureless_proc_addr;
  dermis_context other = nullptr;
  EXPECT_THAT(dermis_context_create(&desc, &other),
              Fails(DERMIS_ERROR_UNSUPPORTED, "synchronization2", "maintenance4",
                    "shaderStorageImageWriteWithoutFormat"));
}

TEST_F(Context, OutOfRangeFieldsAreNamed) {
  dermis_context other = nullptr;
  const auto rejected = [&](dermis_result result, const char* field, auto change) {
    dermis_context_desc desc = context_desc();
    change(desc);
    EXPECT_EQ(dermis_context_create(&desc, &other), result) << field;
    EXPECT_THAT(dermis_last_error(), HasSubstr(field));
    EXPECT_EQ(other, nullptr);
  };
  rejected(DERMIS_ERROR_VERSION, "abi_version",
           [](auto& desc) { desc.abi_version = DERMIS_ABI_VERSION + 1; });
  rejected(DERMIS_ERROR_VERSION, "abi_version", [](auto& desc) { desc.abi_version = 0; });
  rejected(DERMIS_ERROR_ARGUMENT, "flags", [](auto& desc) { desc.flags = 0x80000000u; });
  rejected(DERMIS_ERROR_ARGUMENT, "frames_in_flight",
           [](auto& desc) { desc.frames_in_flight = 9; });
  rejected(DERMIS_ERROR_ARGUMENT, "queue family", [](auto& desc) { desc.queue_family = 1000; });
  rejected(DERMIS_ERROR_ARGUMENT, "struct_size", [](auto& desc) { desc.struct_size = 0; });
  rejected(DERMIS_ERROR_ARGUMENT, "struct_size", [](auto& desc) { desc.struct_size = 1; });
}

TEST_F(Context, NewerHeader_ZeroNewFieldsAreAccepted) {
  struct Newer {
    dermis_context_desc known;
    uint64_t unknown;
  } newer{context_desc(), 0};
  newer.known.struct_size = sizeof newer;
  dermis_context other = nullptr;
  EXPECT_OK(dermis_context_create(&newer.known, &other));
  dermis_context_destroy(other);
  newer.unknown = 1;
  EXPECT_EQ(dermis_context_create(&newer.known, &other), DERMIS_ERROR_VERSION);
  EXPECT_EQ(other, nullptr);
}

TEST_F(Context, GraphOutlivingItsContext_IsDestroyedAndReported) {
  const dermis_context_desc desc = context_desc();
  dermis_context other = nullptr;
  ASSERT_OK(dermis_context_create(&desc, &other));
  std::swap(other, context);
  dermis_graph graph = nullptr;
  ASSERT_OK(create_graph({}, &graph));
  std::swap(other, context);
  logged.clear();
  dermis_context_destroy(other);
  ASSERT_EQ(logged.size(), 1u);
  EXPECT_THAT(logged[0], HasSubstr("not destroyed"));
}

void DERMIS_CALL throwing_log(void*, const dermis_message*) {
  throw 1;
}

TEST_F(Context, ThrowingLogCallback_IsContained) {
  dermis_context_desc desc = context_desc();
  desc.log = throwing_log;
  desc.frames_in_flight = 9;
  dermis_context other = nullptr;
  EXPECT_EQ(dermis_context_create(&desc, &other), DERMIS_ERROR_ARGUMENT);
}

} // namespace
} // namespace dermis::abi_test
