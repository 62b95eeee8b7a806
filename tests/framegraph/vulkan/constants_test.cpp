// Tests specialisation constants: kernels see settings and the presence of ports, and pipelines
// exist before a frame needs them.
#include "framegraph/vulkan/executor/kernels.hpp"
#include "framegraph/vulkan/kernel_store.hpp"
#include "tests/framegraph/vulkan/executor_fixture.hpp"

namespace dermis::testing {
namespace {

constexpr uint32_t constants_side = 8;
constexpr SettingValue mode_low{SettingType::enumeration, 0, 0},
    mode_mid{SettingType::enumeration, 1, 0}, mode_high{SettingType::enumeration, 2, 0};

class ConstantsTest : public ExecutorTest {
protected:
  SmallGraph graph{"export result"};

  void SetUp() override {
    ExecutorTest::SetUp();
    dermis_device.texel_shape = true; // drivers on the CPU get fewer constants
  }
  // Lets the setting "mode" of a pass follow a graph setting of that name.
  void make(const SmallGraph::Ports& reads = {}) {
    SettingDeclaration& mode = graph.setting("mode", 0);
    mode.type = SettingType::enumeration;
    mode.options = {"low", "mid", "high"};
    mode.default_value = mode_low;
    PassDeclaration& pass = graph.pass("constant", "test.constant", reads, {{"target", "result"}});
    graph.follow(pass, "mode", "mode");
    graph.set(pass, "bias", 1);
  }
  void expect_frame(const TestImage& image, float value) {
    ASSERT_FALSE(frame());
    EXPECT_THAT(read(image), Each(FloatEq(value)));
  }
  std::shared_ptr<const vulkan::PlanPipelines>
  pipelines_for(const std::vector<std::vector<SettingValue>>& values, vulkan::KernelStore* store) {
    vulkan::ExecutorInput input;
    input.pass_types = &small_pass_types();
    input.kernels = small_kernels();
    input.kernel_store = store;
    input.settings = values;
    std::shared_ptr<const vulkan::PlanPipelines> made;
    const vulkan::Error error = executor->make_pipelines(input, made);
    EXPECT_FALSE(error) << error.text;
    return made;
  }
};

TEST_F(ConstantsTest, FollowTheSettingsOfTheFrame) {
  make();
  prepared = {{mode_low}, {mode_high}};
  const TestImage result = start(graph, constants_side, constants_side);
  settings = {mode_high};
  expect_frame(result, 121);
  settings = {mode_low};
  expect_frame(result, 101);
  settings.clear();
  expect_frame(result, 101);
}

TEST_F(ConstantsTest, BooleanIsAConstant) {
  make();
  graph.set(graph.graph.passes.front(), "negate", 1);
  const TestImage result = start(graph, constants_side, constants_side);
  expect_frame(result, 99);
}

TEST_F(ConstantsTest, UnpreparedValue_IsRejectedUntilPrepared) {
  make();
  const TestImage result = start(graph, constants_side, constants_side);
  expect_frame(result, 101);
  settings = {mode_mid};
  const vulkan::RecordResult rejected = frame();
  EXPECT_EQ(rejected.kind, vulkan::ErrorKind::argument);
  EXPECT_THAT(rejected.text, HasSubstr("no pipelines were created for these values"));
  executor->set_pipelines(pipelines_for({{mode_mid}}, nullptr));
  expect_frame(result, 111);
  executor->release_pipelines(frame_index);
  expect_frame(result, 111);
  settings = {mode_low};
  EXPECT_TRUE(frame()) << "only the prepared values have pipelines";
}

TEST_F(ConstantsTest, BoundPort_IsKnownToTheKernel) {
  graph.import("light", Format::r32f, true);
  make({{"more", "light"}});
  make_executor(graph, constants_side, constants_side);
  bind(graph, "light", std::vector<float>(constants_side * constants_side, 2.0f));
  const TestImage result = bind(graph, "result", {});
  expect_frame(result, 2101);
}

TEST_F(ConstantsTest, UnboundPort_IsKnownToTheKernel) {
  graph.import("light", Format::r32f, true);
  make({{"more", "light"}});
  make_executor(graph, constants_side, constants_side, {"light"});
  const TestImage result = bind(graph, "result", {});
  expect_frame(result, 101);
}

TEST_F(ConstantsTest, DriverOnTheCpu_ReadsPresenceAtRunTime) {
  dermis_device.texel_shape = false;
  graph.import("light", Format::r32f, true);
  make({{"more", "light"}});
  make_executor(graph, constants_side, constants_side, {"light"});
  const TestImage result = bind(graph, "result", {});
  expect_frame(result, 1);
}

TEST_F(ConstantsTest, PortOfAHistory_ChangesBetweenFrames) {
  graph.history("before");
  make({{"more", "before@-1?"}});
  graph.set(graph.pass("keep", "test.fill", {}, {{"target", "before"}}), "value", 3);
  const TestImage result = start(graph, constants_side, constants_side);
  for (const float value : {1.0f, 3001.0f, 3001.0f})
    expect_frame(result, value);
  ASSERT_FALSE(frame(0, {}, true));
  EXPECT_THAT(read(result), Each(FloatEq(1))) << "the camera cuts";
}

TEST_F(ConstantsTest, Store_FindsPipelinesByTheirConstants) {
  make();
  make_executor(graph, constants_side, constants_side);
  vulkan::KernelStore store;
  const PassTypeId type = small_pass_types().find("test.constant");
  const auto stored = [&](uint32_t mode) {
    const uint32_t constants[] = {0, 0, mode, 0};
    return store.find(type, 0, constants).get();
  };
  pipelines_for({{mode_low}}, &store);
  const vulkan::Pipeline* const first = stored(0);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(stored(1), nullptr);
  pipelines_for({{mode_mid}, {mode_low}, {mode_mid}}, &store);
  EXPECT_NE(stored(1), nullptr);
  EXPECT_EQ(stored(0), first) << "it is not compiled again";
}

TEST_F(ConstantsTest, Store_DropsTheOldestUnusedPipelines) {
  const auto pipeline_of = [&](const char* name, uint32_t constant) {
    const auto kernel = std::make_shared<vulkan::Kernel>(dermis_device);
    kernel->type = small_pass_types().find(name);
    const auto made = std::make_shared<vulkan::Pipeline>(kernel);
    made->constants = {constant};
    return made;
  };
  constexpr uint32_t count = vulkan::KernelStore::max_unused + 3;
  vulkan::KernelStore shared, of_graph(shared);
  const auto used = pipeline_of("test.constant", 0);
  of_graph.add(used);
  of_graph.add(pipeline_of("test.fill", 0));
  for (uint32_t i = 1; i < count; ++i)
    of_graph.add(pipeline_of("test.constant", i));
  of_graph.hand_over();
  const auto is_stored = [&](const char* name, uint32_t constant) {
    const uint32_t constants[] = {constant};
    return shared.find(small_pass_types().find(name), 0, constants) != nullptr;
  };
  EXPECT_TRUE(is_stored("test.constant", 0)) << "an executor uses it";
  EXPECT_TRUE(is_stored("test.fill", 0)) << "each kernel has its own limit";
  for (uint32_t i = 1; i < count; ++i)
    EXPECT_EQ(is_stored("test.constant", i), i > 2) << i;
}

} // namespace
} // namespace dermis::testing
