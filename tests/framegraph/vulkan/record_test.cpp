// Tests that an executor rejects wrong frames and environments with the reason, and then runs the
// next correct frame.
#include "tests/framegraph/vulkan/executor_fixture.hpp"

#include <functional>
#include <optional>

namespace dermis::testing {
namespace {

// The inputs of a frame, each of which a test can make wrong.
struct Frame {
  vulkan::FrameInput input;
  std::vector<vulkan::HostImage> images;
  std::vector<SettingValue> settings;
  std::vector<std::byte> constants;
};

struct RejectedFrames : ExecutorTest {
  static constexpr uint32_t side = 16;
  SmallGraph graph;
  TestImage result;

  void SetUp() override {
    ExecutorTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    graph.setting("bias", 1);
    graph.import("light", Format::r32f);
    graph.exported("result");
    graph.follow(graph.pass("add", "test.add", {{"a", "light"}}, {{"target", "result"}}), "bias",
                 "bias");
    make_executor(graph, side, side);
    bind(graph, "light", std::vector<float>(side * side, 2.0f));
    result = bind(graph, "result", {});
  }
  // Records and submits a correct frame after `change` has made it wrong.
  vulkan::RecordResult record(const std::function<void(Frame&)>& change) {
    Frame one;
    one.images = images;
    one.settings = {{SettingType::real, 0, 7.0}};
    const SmallFrame values{{0, 0, side, side}, 0, {}};
    const auto bytes = std::as_bytes(std::span(&values, 1));
    one.constants.assign(bytes.begin(), bytes.end());
    one.input.command_buffer = begin_commands();
    one.input.rectangle = {0, 0, side, side};
    one.input.frame_index = frame_index + 1;
    change(one);
    one.input.images = one.images;
    one.input.settings = one.settings;
    one.input.frame_constants = one.constants;
    const vulkan::RecordResult recorded = executor->record(one.input);
    if (one.input.command_buffer != VK_NULL_HANDLE) submit(one.input.command_buffer);
    return recorded;
  }
};

TEST_F(RejectedFrames, ReasonIsGiven_ExecutorIsUnchanged) {
  frame_index = 4;
  ASSERT_FALSE(frame());
  const auto light = static_cast<size_t>(graph.slot("light")),
             out = static_cast<size_t>(graph.slot("result"));
  struct Case {
    const char* said;
    std::function<void(Frame&)> change;
    std::optional<size_t> slot = {};
  };
  const Case changes[] = {
      {"command buffer is null", [](Frame& f) { f.input.command_buffer = VK_NULL_HANDLE; }},
      {"frame_index must increase", [](Frame& f) { f.input.frame_index = 5; }},
      {"frame_index must increase", [](Frame& f) { f.input.frame_index = 0; }},
      {"render rectangle",
       [](Frame& f) {
         f.input.rectangle = {0, 0, side, 0};
       }},
      {"render rectangle",
       [](Frame& f) {
         f.input.rectangle = {1, 0, side, side};
       }},
      {"render rectangle",
       [](Frame& f) {
         f.input.rectangle = {0, UINT32_MAX, 1, 2};
       }},
      {"frame_constants has more bytes",
       [](Frame& f) { f.constants.resize(sizeof(SmallFrame) + 1); }},
      {"the slot is not bound", [=](Frame& f) { f.images[light].image = VK_NULL_HANDLE; }, light},
      {"the slot is not bound", [](Frame& f) { f.images.clear(); }},
      {"the binding has no view", [=](Frame& f) { f.images[light].view = VK_NULL_HANDLE; }, light},
      {"after.layout", [=](Frame& f) { f.images[out].after.layout = VK_IMAGE_LAYOUT_UNDEFINED; },
       out},
      {"after.layout",
       [=](Frame& f) { f.images[out].after.layout = VK_IMAGE_LAYOUT_PREINITIALIZED; }},
  };
  for (const auto& [said, change, slot] : changes) {
    const vulkan::RecordResult rejected = record(change);
    EXPECT_EQ(rejected.kind, vulkan::ErrorKind::argument) << said;
    EXPECT_THAT(rejected.text, HasSubstr(said));
    if (slot) {
      EXPECT_EQ(rejected.slot, static_cast<int32_t>(*slot)) << said;
    }
  }
  wait();
  EXPECT_THAT(read(result), Each(FloatEq(3.0f))) << "nothing was recorded";
  settings.clear();
  ASSERT_FALSE(frame()) << "the next right frame runs";
  EXPECT_THAT(read(result), Each(FloatEq(3.0f)));
}

// The host passes one value for each setting of the graph, or none.
TEST_F(RejectedFrames, TooFewSettings_AreRejected) {
  SmallGraph two;
  two.setting("bias", 1);
  two.setting("other", 2);
  two.exported("result");
  two.pass("fill", "test.fill", {}, {{"target", "result"}});
  executor.reset();
  images.clear();
  start(two, side, side);
  const vulkan::RecordResult rejected = record([](Frame&) {});
  EXPECT_EQ(rejected.kind, vulkan::ErrorKind::argument);
  EXPECT_THAT(rejected.text, HasSubstr("settings has fewer values"));
}

TEST_F(RejectedFrames, WrongHostBuffer_IsRejectedWithSizeAndPlace) {
  SmallGraph with;
  ResourceDeclaration& weights = with.buffer("weights", 1);
  weights.origin = Origin::imported;
  with.exported("result");
  with.image("black");
  with.pass("fill", "test.fill", {}, {{"target", "black"}});
  with.pass("add", "test.add", {{"a", "black"}, {"weights", "weights"}}, {{"target", "result"}});
  executor.reset();
  images.clear();
  start(with, side, side);
  const auto slot = static_cast<size_t>(with.slot("weights"));
  const PlanResource* planned = nullptr;
  for (const PlanResource& one : executor->plan().resources)
    if (one.type == ResourceType::buffer) planned = &one;
  ASSERT_NE(planned, nullptr);
  const uint64_t bytes = planned->bytes;
  const VkPhysicalDeviceLimits& limits = dermis_device.properties.limits;
  // Rejected before the buffer is used.
  const auto some_buffer = reinterpret_cast<VkBuffer>(uintptr_t{8});
  std::vector<vulkan::HostBuffer> buffers(slot + 1);
  const auto rejected = [&](const vulkan::HostBuffer& binding) {
    buffers[slot] = binding;
    return record([&](Frame& f) {
      f.settings.clear();
      f.input.buffers = buffers;
    });
  };
  EXPECT_THAT(rejected({}).text, HasSubstr("the slot is not bound"));
  EXPECT_THAT(rejected({some_buffer, 0, bytes - 1, {}, {}}).text, HasSubstr("fewer bytes"));
  EXPECT_THAT(rejected({some_buffer, 0, uint64_t{limits.maxStorageBufferRange} + 1, {}, {}}).text,
              HasSubstr("more than the device can bind"));
  const vulkan::RecordResult aside = rejected({some_buffer, 1, bytes, {}, {}});
  if (limits.minStorageBufferOffsetAlignment > 1) {
    EXPECT_THAT(aside.text, HasSubstr("minStorageBufferOffsetAlignment"));
    EXPECT_EQ(aside.slot, static_cast<int32_t>(slot));
  }
  EXPECT_THAT(record([](Frame& f) { f.settings.clear(); }).text,
              HasSubstr("the slot is not bound"));
}

TEST_F(ExecutorTest, EnvironmentsThatNoDeviceCanBindAreRejected) {
  SmallGraph g{"export result"};
  g.pass("fill", "test.fill", {}, {{"target", "result"}});
  const Plan plan = g.compile(profile, 16, 16);
  static const std::byte table[8]{};
  const uint64_t too_many = uint64_t{dermis_device.properties.limits.maxUniformBufferRange} + 1;
  using enum vulkan::EnvironmentType;
  const std::pair<const char*, std::vector<vulkan::EnvironmentBinding>> wrong[] = {
      {"binding 0 has 0 bytes", {{storage_buffer, 0, {}}}},
      {"bytes; expected 1 to", {{uniform_buffer, too_many, {}}}},
      {"binding 1: counters need a size", {{uniform_buffer, 16, {}}, {counters, 6, {}}}},
      {"one binding can hold counters", {{counters, 4, {}}, {counters, 4, {}}}},
      {"binding 0 has 4 bytes, but its contents have 8", {{storage_buffer, 4, table}}},
  };
  for (const auto& [said, environment] : wrong) {
    vulkan::ExecutorInput input;
    input.device = &dermis_device;
    input.graph = &g.graph;
    input.pass_types = &small_pass_types();
    input.plan = &plan;
    input.kernels = small_kernels();
    input.environment = environment;
    const vulkan::Error error = vulkan::Executor::create(input, executor);
    EXPECT_EQ(error.kind, vulkan::ErrorKind::argument) << said;
    EXPECT_THAT(error.text, HasSubstr(said));
    EXPECT_EQ(executor, nullptr);
  }
}

} // namespace
} // namespace dermis::testing
