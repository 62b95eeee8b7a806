// If any driver call fails, creation names the call, frees everything, and can be tried again.
#include "tests/framegraph/vulkan/executor_fixture.hpp"

namespace dermis::testing {
namespace {

using vulkan::FunctionTable;

// Vulkan functions have no user pointer, so their state is static; tests of this file run
// sequentially.
struct Faults {
  FunctionTable driver;
  uint32_t calls = 0, fail_at = 0;
};
Faults faults;

template <auto member> struct Failing;
template <class... Arguments, VkResult (VKAPI_PTR* FunctionTable::*member)(Arguments...)>
struct Failing<member> {
  static VKAPI_ATTR VkResult VKAPI_CALL call(Arguments... arguments) {
    if (++faults.calls == faults.fail_at) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return (faults.driver.*member)(arguments...);
  }
};

void make_failing(FunctionTable& table) {
  table.vkCreateImage = Failing<&FunctionTable::vkCreateImage>::call;
  table.vkCreateImageView = Failing<&FunctionTable::vkCreateImageView>::call;
  table.vkCreateBuffer = Failing<&FunctionTable::vkCreateBuffer>::call;
  table.vkAllocateMemory = Failing<&FunctionTable::vkAllocateMemory>::call;
  table.vkBindImageMemory2 = Failing<&FunctionTable::vkBindImageMemory2>::call;
  table.vkBindBufferMemory2 = Failing<&FunctionTable::vkBindBufferMemory2>::call;
  table.vkMapMemory = Failing<&FunctionTable::vkMapMemory>::call;
  table.vkCreateSampler = Failing<&FunctionTable::vkCreateSampler>::call;
  table.vkCreateDescriptorSetLayout = Failing<&FunctionTable::vkCreateDescriptorSetLayout>::call;
  table.vkCreateDescriptorPool = Failing<&FunctionTable::vkCreateDescriptorPool>::call;
  table.vkAllocateDescriptorSets = Failing<&FunctionTable::vkAllocateDescriptorSets>::call;
  table.vkCreatePipelineLayout = Failing<&FunctionTable::vkCreatePipelineLayout>::call;
  table.vkCreateShaderModule = Failing<&FunctionTable::vkCreateShaderModule>::call;
  table.vkCreateComputePipelines = Failing<&FunctionTable::vkCreateComputePipelines>::call;
  table.vkCreateQueryPool = Failing<&FunctionTable::vkCreateQueryPool>::call;
}

class FailureTest : public ExecutorTest {
protected:
  SmallGraph graph() const {
    SmallGraph g{"export result", "history count"};
    g.buffer("weights", 1);
    g.pass("clear", "test.clear", {}, {{"buffer", "weights"}});
    g.pass("step", "test.add", {{"a", "count@-1"}, {"weights", "weights"}}, {{"target", "count"}});
    g.pass("show", "test.add", {{"a", "count"}}, {{"target", "result"}});
    return g;
  }
};

TEST_F(FailureTest, EveryFailingCallIsNamed_NothingLeaks) {
  const SmallGraph g = graph();
  const Plan plan = g.compile(profile, 16, 16);
  faults = {dermis_device.vk, 0, 0};
  vulkan::Device failing = dermis_device;
  make_failing(failing.vk);
  uint32_t failures = 0;
  constexpr uint32_t more_than_enough = 1000;
  for (faults.fail_at = 1; faults.fail_at < more_than_enough; ++faults.fail_at) {
    faults.calls = 0;
    std::unique_ptr<vulkan::Executor> made;
    const vulkan::Error error = try_executor(g, plan, failing, made);
    if (!error) break;
    ++failures;
    EXPECT_EQ(made, nullptr);
    EXPECT_EQ(error.kind, vulkan::ErrorKind::device_memory) << error.text;
    EXPECT_EQ(error.result, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    EXPECT_THAT(error.text, HasSubstr("failed (VK_ERROR_OUT_OF_DEVICE_MEMORY, -2): "));
  }
  EXPECT_GT(failures, 20u) << "images, memory, pipelines, sets need at least that many calls";
  EXPECT_LT(faults.fail_at, more_than_enough);
  // Validation reports leaked objects when the fixture destroys the device.
}

TEST_F(FailureTest, AMissingKernelIsNamed) {
  const SmallGraph g = graph();
  const Plan plan = g.compile(profile, 16, 16);
  vulkan::ExecutorInput input;
  input.device = &dermis_device;
  input.graph = &g.graph;
  input.pass_types = &small_pass_types();
  input.plan = &plan;
  std::unique_ptr<vulkan::Executor> made;
  vulkan::Error error = vulkan::Executor::create(input, made);
  EXPECT_EQ(error.kind, vulkan::ErrorKind::shader);
  EXPECT_THAT(
      error.text,
      HasSubstr("kernel 'test_add' of type 'test.add' is not among the 0 provided kernels"));
  input.kernels = small_kernels();
  error = vulkan::Executor::create(input, made);
  EXPECT_EQ(error.kind, vulkan::ErrorKind::shader) << "the kernels read a missing environment";
  EXPECT_THAT(error.text, HasSubstr("set 1 binding 0, but the environment has only 0 bindings"));
}

TEST_F(FailureTest, APlanOfAnotherDeviceIsRejected) {
  const SmallGraph g = graph();
  Plan plan = g.compile(profile, 16, 16);
  for (Placement& placement : plan.placements)
    placement.size = 1;
  std::unique_ptr<vulkan::Executor> made;
  const vulkan::Error error = try_executor(g, plan, dermis_device, made);
  EXPECT_EQ(error.kind, vulkan::ErrorKind::argument);
  EXPECT_THAT(error.text, HasSubstr("compile it with the profile of this device"));
}

TEST_F(FailureTest, BadInputsAreRejected) {
  const SmallGraph g = graph();
  const Plan plan = g.compile(profile, 16, 16);
  std::unique_ptr<vulkan::Executor> made;
  vulkan::ExecutorInput input;
  EXPECT_EQ(vulkan::Executor::create(input, made).kind, vulkan::ErrorKind::argument);
  input.device = &dermis_device;
  input.graph = &g.graph;
  input.pass_types = &small_pass_types();
  input.plan = &plan;
  input.frames_in_flight = vulkan::max_frames_in_flight + 1;
  EXPECT_THAT(vulkan::Executor::create(input, made).text,
              HasSubstr("9 frames in flight; expected 1 to 8"));
}

TEST_F(ExecutorTest, APlanOfTwoQueuesIsRejected) {
  SmallGraph g{"export result"};
  for (const char* name : {"first", "second"})
    g.image(name);
  g.pass("fill", "test.fill", {}, {{"target", "first"}});
  g.pass("aside", "test.add", {{"a", "first"}}, {{"target", "second"}});
  g.pass("show", "test.add", {{"a", "second"}}, {{"target", "result"}});
  Plan plan = g.compile(profile, 16, 16);
  plan.passes[1].queue = Queue::async;
  const vulkan::Error error = try_executor(g, plan, dermis_device, executor);
  EXPECT_EQ(error.kind, vulkan::ErrorKind::unsupported);
  EXPECT_THAT(error.text, HasAll("'aside'", "single queue"));
}

} // namespace
} // namespace dermis::testing
