// Tests what compile_pipelines() reads through VK_KHR_pipeline_executable_properties, from answers
// that no driver gives, because drivers on the CPU lack the extension.
#include "framegraph/vulkan/pipeline_statistics.hpp"
#include "tests/framegraph/vulkan/executor_fixture.hpp"

#include <cstring>
#include <string_view>

namespace dermis::testing {
namespace {

PFN_vkCreateComputePipelines create_compute_pipelines = nullptr;
VkPipelineCreateFlags requested_flags = 0;
bool answers = true; // the driver knows the extension's functions

template <size_t Size> void put(char (&out)[Size], std::string_view text) {
  text.copy(out, Size - 1);
  out[text.size()] = '\0';
}

// Keeps the flags of the extension from the driver, which does not know them.
VKAPI_ATTR VkResult VKAPI_CALL create_without_flags(VkDevice device, VkPipelineCache cache,
                                                    uint32_t count,
                                                    const VkComputePipelineCreateInfo* infos,
                                                    const VkAllocationCallbacks* allocator,
                                                    VkPipeline* pipelines) {
  std::vector<VkComputePipelineCreateInfo> plain(infos, infos + count);
  for (VkComputePipelineCreateInfo& info : plain)
    requested_flags |= std::exchange(info.flags, 0);
  return create_compute_pipelines(device, cache, count, plain.data(), allocator, pipelines);
}

VKAPI_ATTR VkResult VKAPI_CALL properties(VkDevice, const VkPipelineInfoKHR*, uint32_t* count,
                                          VkPipelineExecutablePropertiesKHR* out) {
  *count = 1;
  if (out == nullptr) return VK_SUCCESS;
  put(out->name, "main");
  out->subgroupSize = 64;
  return VK_SUCCESS;
}

VKAPI_ATTR VkResult VKAPI_CALL statistics(VkDevice, const VkPipelineExecutableInfoKHR*,
                                          uint32_t* count, VkPipelineExecutableStatisticKHR* out) {
  *count = 4;
  if (out == nullptr) return VK_SUCCESS;
  put(out[0].name, "uses shared memory");
  out[0].format = VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR;
  out[0].value.b32 = VK_TRUE;
  put(out[1].name, "balance");
  out[1].format = VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR;
  out[1].value.i64 = -3;
  put(out[2].name, "registers");
  out[2].format = VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR;
  out[2].value.u64 = 72;
  put(out[3].name, "occupancy");
  put(out[3].description, "of the most possible");
  out[3].format = VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_FLOAT64_KHR;
  out[3].value.f64 = 0.5;
  return VK_SUCCESS;
}

// Two texts, of which the second is the assembly, and one binary.
VKAPI_ATTR VkResult VKAPI_CALL representations(VkDevice, const VkPipelineExecutableInfoKHR*,
                                               uint32_t* count,
                                               VkPipelineExecutableInternalRepresentationKHR* out) {
  constexpr std::string_view texts[] = {"intermediate", "s_endpgm",
                                        "\x7f"
                                        "ELF"};
  *count = 3;
  for (uint32_t i = 0; out != nullptr && i < 3; ++i) {
    out[i].isText = i < 2 ? VK_TRUE : VK_FALSE;
    if (out[i].pData != nullptr) std::memcpy(out[i].pData, texts[i].data(), texts[i].size() + 1);
    out[i].dataSize = texts[i].size() + 1;
  }
  return VK_SUCCESS;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL function_named(VkDevice, const char* name) {
  const std::string_view wanted = name;
  if (!answers) return nullptr;
  if (wanted == "vkGetPipelineExecutablePropertiesKHR")
    return reinterpret_cast<PFN_vkVoidFunction>(properties);
  if (wanted == "vkGetPipelineExecutableStatisticsKHR")
    return reinterpret_cast<PFN_vkVoidFunction>(statistics);
  return reinterpret_cast<PFN_vkVoidFunction>(representations);
}

class StatisticsTest : public ExecutorTest {
protected:
  std::vector<vulkan::CompiledPipeline> pipelines;
  std::unique_ptr<vulkan::KernelStore> store = std::make_unique<vulkan::KernelStore>();

  void SetUp() override {
    ExecutorTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    answers = true;
    requested_flags = 0;
    create_compute_pipelines =
        std::exchange(dermis_device.vk.vkCreateComputePipelines, create_without_flags);
    dermis_device.vk.vkGetDeviceProcAddr = function_named;
    dermis_device.texel_shape = true; // drivers on the CPU get fewer constants
  }
  void TearDown() override {
    pipelines.clear();
    store.reset();
    ExecutorTest::TearDown();
  }
  vulkan::Error compile(bool with_statistics, bool with_assembly) {
    SmallGraph graph{"export result"};
    graph.set(graph.pass("constant", "test.constant", {}, {{"target", "result"}}), "bias", 1);
    const Plan plan = graph.compile(profile, 8, 8);
    const vulkan::EnvironmentBinding environment[] = {
        {vulkan::EnvironmentType::uniform_buffer, sizeof(SmallFrame), {}},
        {vulkan::EnvironmentType::storage_buffer, 2 * sizeof(float), {}},
        {vulkan::EnvironmentType::linear_sampler, 0, {}}};
    vulkan::PipelinesInput input;
    input.environment = environment;
    input.device = &dermis_device;
    input.pass_types = &small_pass_types();
    input.plan = &plan;
    input.kernels = small_kernels();
    input.statistics = with_statistics;
    input.assembly = with_assembly;
    input.store = store.get();
    return vulkan::compile_pipelines(input, pipelines);
  }
};

TEST_F(StatisticsTest, EachFormatOfAValueIsRead) {
  const vulkan::Error error = compile(true, true);
  ASSERT_FALSE(error) << error.text;
  ASSERT_EQ(pipelines.size(), 1u);
  const vulkan::CompiledPipeline& pipeline = pipelines.front();
  EXPECT_EQ(pipeline.passes, std::vector<uint32_t>{0});
  EXPECT_THAT(pipeline.constants, HasSubstr("mode=mid negate=false more=unbound"));
  ASSERT_EQ(pipeline.executables.size(), 1u);
  const vulkan::PipelineExecutable& program = pipeline.executables.front();
  EXPECT_EQ(program.name, "main");
  EXPECT_EQ(program.subgroup_size, 64u);
  ASSERT_EQ(program.statistics.size(), 4u);
  EXPECT_EQ(program.statistics[0].value, 1);
  EXPECT_EQ(program.statistics[1].value, -3);
  EXPECT_EQ(program.statistics[2].value, 72);
  EXPECT_EQ(program.statistics[2].name, "registers");
  EXPECT_EQ(program.statistics[3].value, 0.5);
  EXPECT_EQ(program.statistics[3].description, "of the most possible");
  EXPECT_EQ(program.assembly, "s_endpgm") << "the last text";
  EXPECT_EQ(requested_flags,
            VkPipelineCreateFlags(VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR |
                                  VK_PIPELINE_CREATE_CAPTURE_INTERNAL_REPRESENTATIONS_BIT_KHR));
}

TEST_F(StatisticsTest, OnlyWhatIsWantedIsCaptured) {
  ASSERT_FALSE(compile(true, false));
  EXPECT_EQ(pipelines.front().executables.front().assembly, "");
  EXPECT_EQ(requested_flags, VkPipelineCreateFlags(VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR));
  pipelines.clear();
  store = std::make_unique<vulkan::KernelStore>();
  requested_flags = 0;
  ASSERT_FALSE(compile(false, false));
  EXPECT_TRUE(pipelines.front().executables.empty());
  EXPECT_EQ(requested_flags, 0u);
}

TEST_F(StatisticsTest, MissingFunctions_AreAnError) {
  answers = false;
  const vulkan::Error error = compile(true, false);
  EXPECT_EQ(error.kind, vulkan::ErrorKind::unsupported);
  EXPECT_THAT(error.text, HasSubstr("VK_KHR_pipeline_executable_properties"));
}

} // namespace
} // namespace dermis::testing
