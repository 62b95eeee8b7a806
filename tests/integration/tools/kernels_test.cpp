// Tests `dermis kernels`: on the software driver, and on Mesa's driver for AMD GPUs without a GPU.
#include "framegraph/vulkan/device_profile.hpp"
#include "framegraph/vulkan/pipeline_statistics.hpp"
#include "integration/abi/kernel_environment.hpp"
#include "integration/abi/shaders/runtime_shaders.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/null_device/null_device.hpp"
#include "tests/integration/tools/command_fixture.hpp"
#include "tests/support/null_hardware.hpp"

#include <nlohmann/json.hpp>

#include <map>
#include <set>

namespace dermis::test {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class KernelsVerb : public CommandTest {};

class KernelsOnNullHardware : public CommandTest {
protected:
  void SetUp() override {
    if (testing::radeon_driver().empty())
      GTEST_SKIP()
          << "no driver for AMD GPUs in /usr/share/vulkan/icd.d: install mesa-vulkan-drivers";
  }
  static Outcome run_on(const std::string& family, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "kernels");
    return run(arguments, {testing::null_hardware(family), "", ""});
  }
};

json kernel_of(const json& document, const std::string& name) {
  for (const json& one : document.at("kernels"))
    if (one.at("kernel") == name) return one;
  ADD_FAILURE() << "no kernel " << name;
  return {};
}

TEST_F(KernelsVerb, WithoutStatisticsCountsRemain) {
  const Outcome text = run({"kernels", "burley", "--unbound", "scattered_light"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("burley/subsurface_burley"), HasSubstr("barrier calls")));
  if (text.out.find("has no VK_KHR_pipeline") == std::string::npos)
    GTEST_SKIP() << "a driver with statistics";
  const Outcome limited = run({"kernels", "burley", "--limits",
                               write("limits.json", R"({ "dermis_kernel_limits": 1, "rules": [
                                       { "kernel": "*", "max": { "vgprs": 1000 } } ] })")});
  EXPECT_EQ(limited.exit_code, 1);
  EXPECT_THAT(limited.err, HasSubstr("does not report vgprs"));
}

TEST_F(KernelsVerb, PlansAreCountedAsTheyAreRecorded) {
  const Outcome outcome = run({"kernels", "burley", "--json", "--unbound", "scattered_light",
                               "--unbound", "albedo,scatter_scale", "--size", "640x360"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json graph = json::parse(outcome.out).at("graphs").at(0);
  EXPECT_EQ(graph.at("graph"), "burley");
  EXPECT_EQ(graph.at("dispatches"), 5); // classify, list, setup, scatter, combine
  EXPECT_EQ(graph.at("passes").size(), 5u);
  EXPECT_EQ(graph.at("barriers"), 6); // one call before each pass, one after the last
  double sum = 0;
  for (const json& pass : graph.at("passes"))
    sum += pass.at("read").get<double>() + pass.at("written").get<double>();
  EXPECT_NEAR(graph.at("bytes_per_pixel").get<double>(), sum, 1e-9);
  // classify reads the material (1 B) of two pixels per covered pixel, and the depth of one
  EXPECT_NEAR(graph.at("passes").at(0).at("read").get<double>(), 2 * 1 + 4, 1e-9);
}

TEST_F(KernelsVerb, PassesNameTheirPipelines) {
  const Outcome outcome = run({"kernels", "sap", "--json", "--size", "64x64"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json report = json::parse(outcome.out);
  const auto pipeline_of = [](const json& one) {
    return std::pair(one.at("kernel").get<std::string>(), one.value("constants", ""));
  };
  std::set<std::pair<std::string, std::string>> compiled;
  for (const json& row : report.at("kernels"))
    compiled.insert(pipeline_of(row));
  std::map<std::string, std::string> constants; // by pass
  for (const json& pass : report.at("graphs").at(0).at("passes")) {
    EXPECT_TRUE(pass.at("kernel") == "" || compiled.contains(pipeline_of(pass))) << pass;
    constants[pass.at("pass").get<std::string>()] = pass.value("constants", "");
  }
  EXPECT_THAT(constants.at("up_1"), HasSubstr("variant=smooth")); // the default
  EXPECT_EQ(constants.at("clear_children"), "");
}

TEST_F(KernelsVerb, UnknownNamesAreUsageErrors) {
  const struct {
    std::vector<std::string> arguments;
    int exit_code;
    const char* message;
  } cases[] = {
      {{"kernels", "burley", "--set", "tapz=1"}, 2, "no graph has a setting 'tapz'"},
      {{"kernels", "burley", "--unbound", "albdo"}, 2, "no graph has a resource 'albdo'"},
      {{"kernels", "burley", "--device", "no such device"}, 3, "no device fits the name"},
      {{"kernels", "burly"}, 1, "the graph cannot be used"},
      {{"kernels", "burley", "--limits", "missing.json"}, 1, "the limits cannot be used"},
  };
  for (const auto& one : cases) {
    const Outcome outcome = run(one.arguments);
    EXPECT_EQ(outcome.exit_code, one.exit_code) << one.message;
    EXPECT_THAT(outcome.err, HasSubstr(one.message));
  }
}

TEST_F(KernelsOnNullHardware, CompilerValuesAreReported) {
  const Outcome outcome = run_on("navi21", {"sap", "--json", "--assembly", path("assembly")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json document = json::parse(outcome.out);
  EXPECT_THAT(document.at("device").get<std::string>(), HasSubstr("NAVI21"));
  const json kernel = kernel_of(document, "common/subsurface_combine");
  const json& values = kernel.at("values");
  for (const char* key :
       {"vgprs", "sgprs", "spilled_vgprs", "spilled_sgprs", "scratch_bytes", "shared_bytes",
        "occupancy", "subgroup_size", "code_bytes", "instructions"})
    EXPECT_TRUE(values.contains(key)) << key;
  EXPECT_GT(values.at("code_bytes"), 0);
  EXPECT_EQ(values.at("spilled_vgprs"), 0);
  EXPECT_TRUE(kernel.at("statistics").contains("VGPRs"));
  EXPECT_THAT(kernel.at("constants").get<std::string>(),
              HasSubstr("texturing=post result=color copied=unscattered scattered=bound"));
  EXPECT_THAT(read("assembly/common_subsurface_combine.txt"), HasSubstr("s_endpgm"));
  EXPECT_EQ(kernel.at("assembly"), "common_subsurface_combine.txt");
  EXPECT_THAT(read("assembly/sap_subsurface_sap_gather_2.txt"), HasSubstr("s_endpgm"));
}

TEST_F(KernelsOnNullHardware, AnExceededLimitFails) {
  const std::string limits = write("limits.json", R"({ "dermis_kernel_limits": 1, "rules": [
    { "device": "*NAVI21*", "kernel": "common/*", "max": { "code_bytes": 8 }, "min": { "occupancy": 1 } } ] })");
  const Outcome text = run_on("navi21", {"burley", "--limits", limits});
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_THAT(text.err, AllOf(HasSubstr("common/subsurface_combine (texturing=post "),
                              HasSubstr("): code_bytes is "), HasSubstr("at most 8 is allowed"),
                              HasSubstr("limits.json:2"), Not(HasSubstr("burley/"))));
  const Outcome answer = run_on("navi21", {"burley", "--limits", limits, "--json"});
  EXPECT_EQ(answer.exit_code, 1);
  ASSERT_TRUE(is_json(answer.out));
  const json document = json::parse(answer.out);
  EXPECT_FALSE(document.at("ok"));
  EXPECT_EQ(document.at("limits").at("exceeded").at(0).at("value"), "code_bytes");
  const Outcome other = run_on("vega10", {"burley", "--limits", limits});
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.err, HasSubstr("has no rule for"));
  // A rule for kernels that were not asked for checks nothing.
  const std::string about_sap = write("sap.json", R"({ "dermis_kernel_limits": 1, "rules": [
    { "device": "*NAVI21*", "kernel": "sap/*", "max": { "code_bytes": 99999 } } ] })");
  for (const auto& [device, file] : {std::pair("navi21", about_sap), std::pair("vega10", limits)}) {
    const Outcome nothing = run_on(device, {"burley", "--limits", file, "--json"});
    EXPECT_EQ(nothing.exit_code, 1);
    ASSERT_TRUE(is_json(nothing.out));
    EXPECT_FALSE(json::parse(nothing.out).at("ok")) << device;
  }
}

TEST_F(KernelsOnNullHardware, GraphsThatNeedRaysAreSkippedByName) {
  const Outcome outcome = run_on("vega10", {"restir", "burley"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(
      outcome.out,
      HasSubstr("restir: skipped, its default 'restir' needs ray_query, which the device lacks"));
  EXPECT_THAT(outcome.out, HasSubstr("burley/subsurface_burley"));
}

TEST(CompilePipelines, NeedNoMemory) {
  Diagnostics diagnostics;
  const auto loaded =
      tools::load_graph(DERMIS_SOURCE_DIR "/configs/graphs/burley.json", {}, diagnostics);
  ASSERT_TRUE(loaded);
  NullDevice null;
  vulkan::DeviceInput input;
  input.get_instance_proc_addr = NullDevice::loader();
  input.instance = null.instance();
  input.physical = null.physical();
  input.device = null.device();
  vulkan::Device device;
  ASSERT_FALSE(vulkan::make_device(input, device));
  const DeviceProfile profile = vulkan::device_profile(device);
  const auto compiled = compile(
      tools::compile_input(*loaded, profile, {640, 360}, tools::read_choices(loaded->graph)),
      diagnostics);
  ASSERT_TRUE(compiled);
  const auto tables =
      subsurface::make_kernel_tables(subsurface::table_use(loaded->graph, loaded->pass_types), {});
  const auto environment = abi::kernel_environment(tables);
  const auto codes = abi::kernel_codes({});
  vulkan::KernelStore store;
  vulkan::PipelinesInput request{.device = &device,
                                 .pass_types = &loaded->pass_types,
                                 .plan = &compiled->plan,
                                 .kernels = codes,
                                 .environment = environment,
                                 .store = &store};
  std::vector<vulkan::CompiledPipeline> pipelines;
  const uint64_t before = null.creations();
  ASSERT_FALSE(vulkan::compile_pipelines(request, pipelines));
  EXPECT_EQ(null.memory_bytes(), 0u);
  ASSERT_EQ(pipelines.size(), 6u); // one per pass: no two passes share a kernel
  for (const vulkan::CompiledPipeline& pipeline : pipelines)
    EXPECT_EQ(pipeline.passes.size(), 1u);
  // per pipeline: layouts of set and pipeline, module and pipeline; and the layout of set 1
  EXPECT_EQ(null.creations() - before, 6 * 4 + 1);
  ASSERT_FALSE(vulkan::compile_pipelines(request, pipelines));
  ASSERT_EQ(pipelines.size(), 12u);
  EXPECT_EQ(pipelines[6].pipeline, pipelines[0].pipeline) << "the store keeps the pipeline";
  EXPECT_EQ(null.creations() - before, 6 * 4 + 2);
}

} // namespace
} // namespace dermis::test
