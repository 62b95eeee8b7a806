// For each NULL pointer argument a function returns a documented code and a message that names the
// argument, and never crashes.

#include <dermis/dermis.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

namespace {

using testing::HasSubstr;

PFN_vkVoidFunction VKAPI_CALL no_function(VkInstance, const char*) {
  return nullptr;
}
template <class Handle> Handle any_handle() {
  return reinterpret_cast<Handle>(uintptr_t{8});
}

void expect_argument_error(dermis_result result, const char* named) {
  EXPECT_EQ(result, DERMIS_ERROR_ARGUMENT) << named;
  ASSERT_NE(dermis_last_error(), nullptr);
  EXPECT_THAT(dermis_last_error(), HasSubstr(named));
}

TEST(NullArguments, AreNamedByRequirements) {
  uint32_t count = 0;
  const auto instance = any_handle<VkInstance>();
  const auto device = any_handle<VkPhysicalDevice>();
  expect_argument_error(dermis_query_requirements(nullptr, instance, device, &count, nullptr),
                        "get_instance_proc_addr");
  expect_argument_error(dermis_query_requirements(no_function, nullptr, device, &count, nullptr),
                        "instance");
  expect_argument_error(dermis_query_requirements(no_function, instance, nullptr, &count, nullptr),
                        "physical_device");
  expect_argument_error(dermis_query_requirements(no_function, instance, device, nullptr, nullptr),
                        "count");
}

TEST(NullArguments, AreNamedByContextCreationFieldByField) {
  dermis_context context = any_handle<dermis_context>();
  dermis_context_desc desc = DERMIS_CONTEXT_DESC_INIT;
  expect_argument_error(dermis_context_create(nullptr, &context), "desc");
  EXPECT_EQ(context, nullptr) << "a failed creation writes NULL";
  expect_argument_error(dermis_context_create(&desc, nullptr), "context");
  expect_argument_error(dermis_context_create(&desc, &context), "get_instance_proc_addr");
  desc.get_instance_proc_addr = no_function;
  expect_argument_error(dermis_context_create(&desc, &context), "instance");
  desc.instance = any_handle<VkInstance>();
  expect_argument_error(dermis_context_create(&desc, &context), "physical_device");
  desc.physical_device = any_handle<VkPhysicalDevice>();
  expect_argument_error(dermis_context_create(&desc, &context), "device");
}

TEST(NullArguments, AreNamedByGraphFunctions) {
  dermis_report report = any_handle<dermis_report>();
  dermis_graph graph = any_handle<dermis_graph>();
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  expect_argument_error(dermis_validate(nullptr, &report), "source");
  EXPECT_EQ(report, nullptr) << "a report that was not made is NULL";
  expect_argument_error(dermis_graph_create(nullptr, &desc, &graph, &report), "context");
  EXPECT_EQ(graph, nullptr);
  expect_argument_error(dermis_graph_reload(nullptr, &desc, &report), "graph");
  expect_argument_error(dermis_graph_reload_shaders(nullptr, nullptr, nullptr, &report), "graph");
  expect_argument_error(dermis_graph_resize(nullptr, 1, 1, &report), "graph");
  expect_argument_error(dermis_graph_set_setting(nullptr, "a", "1", &report), "graph");
  uint32_t count = 0;
  size_t size = 0;
  dermis_memory memory = DERMIS_MEMORY_INIT;
  dermis_frame frame = DERMIS_FRAME_INIT;
  expect_argument_error(dermis_graph_slots(nullptr, &count, nullptr), "graph");
  expect_argument_error(dermis_view_settings(dermis_graph_view(nullptr), &count, nullptr), "view");
  expect_argument_error(dermis_graph_describe(nullptr, DERMIS_DESCRIBE_JSON, &size, nullptr),
                        "graph");
  expect_argument_error(dermis_graph_memory(nullptr, &memory), "graph");
  dermis_outcome outcome = DERMIS_OUTCOME_INIT;
  expect_argument_error(dermis_graph_frontier(nullptr, nullptr, &count, nullptr), "graph");
  expect_argument_error(dermis_graph_predict(nullptr, nullptr, &outcome), "graph");
  expect_argument_error(dermis_view_timings(dermis_graph_view(nullptr), 0, &count, nullptr),
                        "view");
  expect_argument_error(dermis_view_histories(nullptr, &count, nullptr), "view");
  expect_argument_error(dermis_view_record(dermis_graph_view(nullptr), &frame), "view");
  expect_argument_error(dermis_view_discard(dermis_graph_view(nullptr), 1), "view");
  dermis_view view = nullptr;
  expect_argument_error(dermis_view_create(nullptr, nullptr, &view, nullptr), "graph");
  const dermis_command* commands = nullptr;
  expect_argument_error(dermis_view_commands(nullptr, &frame, &count, &commands), "view");
  dermis_frame_report taken = DERMIS_FRAME_REPORT_INIT;
  expect_argument_error(dermis_view_report(nullptr, 0, &taken), "view");
  dermis_frame_statistics statistics = DERMIS_FRAME_STATISTICS_INIT;
  expect_argument_error(dermis_view_statistics(nullptr, 0, &statistics), "view");
}

TEST(NullArguments, AreHarmlessToReportsAndDestruction) {
  dermis_message message = DERMIS_MESSAGE_INIT;
  expect_argument_error(dermis_report_message(nullptr, 0, &message), "report");
  EXPECT_EQ(dermis_report_count(nullptr), 0u);
  EXPECT_STREQ(dermis_report_text(nullptr), "");
  EXPECT_STREQ(dermis_report_json(nullptr), "[]");
  dermis_report_destroy(nullptr);
  dermis_graph_destroy(nullptr);
  dermis_context_destroy(nullptr);
}

TEST(LastError, IsKeptPerThread) {
  expect_argument_error(dermis_validate(nullptr, nullptr), "source");
  std::thread([] { EXPECT_EQ(dermis_last_error(), nullptr); }).join();
  EXPECT_NE(dermis_last_error(), nullptr);
}

TEST(Names, EveryResultHasAName) {
  for (int value = DERMIS_ERROR_INTERNAL; value <= DERMIS_NOT_READY; ++value)
    EXPECT_STRNE(dermis_result_name(static_cast<dermis_result>(value)), "DERMIS_UNKNOWN") << value;
  EXPECT_STREQ(dermis_result_name(static_cast<dermis_result>(1234)), "DERMIS_UNKNOWN");
  EXPECT_STREQ(dermis_result_name(DERMIS_ERROR_CONFIG), "DERMIS_ERROR_CONFIG");
}

TEST(Version, MatchesTheHeader) {
  EXPECT_EQ(dermis_version(),
            (DERMIS_VERSION_MAJOR << 22u) | (DERMIS_VERSION_MINOR << 12u) | DERMIS_VERSION_PATCH);
}

} // namespace
