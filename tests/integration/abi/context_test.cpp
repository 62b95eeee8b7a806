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
  ASSERT_FALSE(logged.empty()) << "the log callback gets the same message";
  EXPECT_EQ(logged.back(), dermis_last_error());
  rejected(DERMIS_ERROR_ARGUMENT, "struct_size", [](auto& desc) { desc.struct_size = 0; });
  rejected(DERMIS_ERROR_ARGUMENT, "struct_size", [](auto& desc) { desc.struct_size = 1; });
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
