// Tests when pipelines are created: with a graph and with new values of settings, but never while
// recording.
#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <set>

namespace dermis::abi_test {
namespace {

struct Pipelines : ::testing::Test {
  NullHost host;

  void SetUp() override {
    ASSERT_OK(host.start());
    ASSERT_OK(host.record());
  }
  // Returns the number of pipelines that the call creates, and records a frame, which creates
  // nothing.
  uint64_t pipelines_of(const char* name, const char* json) {
    const uint64_t before = host.device.pipelines();
    EXPECT_OK(dermis_graph_set_setting(host.graph, name, json, nullptr));
    const uint64_t after = host.device.pipelines(), creations = host.device.creations();
    EXPECT_OK(host.record());
    EXPECT_EQ(host.device.creations(), creations) << "recording created an object";
    return after - before;
  }
};

TEST_F(Pipelines, NewValueOfASetting_CreatesPipelinesOnce) {
  const uint64_t before = host.device.alive();
  const uint64_t created = pipelines_of("texturing", "\"pre\"");
  EXPECT_GT(created, 0u);
  EXPECT_EQ(host.device.alive(), before + created) << "layouts are shared";
  EXPECT_EQ(pipelines_of("texturing", "\"post\""), 0u);
  EXPECT_EQ(pipelines_of("texturing", "\"pre\""), 0u);
}

TEST_F(Pipelines, Numbers_CreateNone) {
  EXPECT_EQ(pipelines_of("samples", "8"), 0u);
  EXPECT_EQ(pipelines_of("accumulate_weight", "0.5"), 0u);
}

TEST_F(Pipelines, FailedCreation_KeepsTheValue) {
  const uint64_t alive = host.device.alive();
  for (const uint64_t creation : {1, 2, 3, 4}) {
    host.device.fail_creation(creation, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    EXPECT_EQ(dermis_graph_set_setting(host.graph, "texturing", "\"pre\"", nullptr),
              DERMIS_ERROR_DEVICE_MEMORY);
    host.device.fail_creation(0, VK_SUCCESS);
    EXPECT_EQ(host.device.alive(), alive);
    EXPECT_OK(host.record());
  }
  EXPECT_GT(pipelines_of("texturing", "\"pre\""), 0u);
}

TEST_F(Pipelines, NewValue_CreatesPipelinesForAllViews) {
  dermis_view view = nullptr;
  ASSERT_OK(dermis_view_create(host.graph, nullptr, &view, nullptr));
  NullHost single;
  ASSERT_OK(single.start());
  const uint64_t of_graph = single.device.pipelines();
  ASSERT_OK(dermis_graph_set_setting(single.graph, "texturing", "\"pre\"", nullptr));
  EXPECT_EQ(pipelines_of("texturing", "\"pre\""), single.device.pipelines() - of_graph)
      << "views share pipelines";
  const uint64_t before = host.device.creations();
  EXPECT_OK(host.record(view, 1));
  EXPECT_EQ(host.device.creations(), before);
}

TEST_F(Pipelines, LaterGraph_SharesPipelinesOfNewValues) {
  EXPECT_GT(pipelines_of("texturing", "\"pre\""), 0u);
  const dermis_graph first = host.graph;
  const uint64_t pipelines = host.device.pipelines();
  ASSERT_OK(host.make_graph());
  EXPECT_OK(dermis_graph_set_setting(host.graph, "texturing", "\"pre\"", nullptr));
  EXPECT_EQ(host.device.pipelines(), pipelines);
  dermis_graph_destroy(first);
}

TEST_F(Pipelines, Choices_AreCreatedWithTheGraph) {
  const std::string text = read_text("configs/graphs/skin.json");
  dermis_graph_desc desc = graph_desc(text, "skin.json", 512);
  dermis_profile profile = skin_profile();
  desc.profiles = &profile;
  desc.profile_count = 1;
  std::set<std::vector<double>> recorded; // values of the settings
  for (const float milliseconds : {0.0f, 100.0f, 50.0f, 20.0f, 10.0f, 5.0f, 2.0f, 1.0f, 0.1f}) {
    dermis_graph_destroy(host.graph);
    host.graph = nullptr;
    ASSERT_OK(dermis_graph_create(host.context, &desc, &host.graph, nullptr));
    host.make_bindings();
    dermis_budget budget = DERMIS_BUDGET_INIT;
    budget.flags = DERMIS_BUDGET_DETERMINISTIC;
    budget.milliseconds = milliseconds;
    ASSERT_OK(dermis_graph_set_budget(host.graph, &budget, nullptr));
    const uint64_t creations = host.device.creations();
    ASSERT_OK(host.record());
    EXPECT_EQ(host.device.creations(), creations) << milliseconds;
    std::vector<double> values;
    for (const dermis_setting& setting :
         list_of(dermis_setting DERMIS_SETTING_INIT, dermis_view_settings,
                 dermis_graph_view(host.graph)))
      values.push_back(setting.value);
    recorded.insert(values);
  }
  EXPECT_GT(recorded.size(), 2u) << "the budgets choose too few configurations";
}

} // namespace
} // namespace dermis::abi_test
