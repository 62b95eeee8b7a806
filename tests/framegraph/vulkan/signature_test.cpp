// Tests reflection: it reads a kernel's interface, survives broken modules, and names every
// mismatch.
#include "framegraph/vulkan/shader/signature_check.hpp"
#include "tests/framegraph/vulkan/small_graph.hpp"
#include "tests/support/matchers.hpp"

#include <algorithm>
#include <random>

namespace dermis::testing {
namespace {

using namespace dermis::vulkan;

std::span<const uint32_t> spirv(std::string_view shader) {
  for (const KernelCode& kernel : small_kernels())
    if (kernel.shader == shader) return kernel.spirv;
  ADD_FAILURE() << shader;
  return {};
}

Reflection reflected(std::string_view shader) {
  std::string error;
  const auto result = reflect(spirv(shader), error);
  EXPECT_TRUE(result) << error;
  return result.value_or(Reflection{});
}

const EnvironmentBinding environment[] = {
    {EnvironmentType::uniform_buffer, 32, {}},
    {EnvironmentType::storage_buffer, 8, {}},
    {EnvironmentType::linear_sampler, 0, {}},
    {EnvironmentType::counters, 4, {}},
};

std::string problems(const PassType& type, const Reflection& reflection,
                     std::span<const EnvironmentBinding> bindings = environment) {
  std::string all;
  for (const std::string& line : check_signature(type, bindings, reflection))
    all += line + "\n";
  return all;
}

PassType type(const char* name) {
  return small_pass_types()[small_pass_types().find(name)];
}

TEST(Reflection, ReadsBindingsPushConstantsAndLocalSize) {
  const Reflection add = reflected("test_add");
  ASSERT_EQ(add.bindings.size(), 9u) << "six ports and three environment bindings, used or not";
  EXPECT_EQ(add.bindings[0].type, BindingType::sampled_image);
  EXPECT_EQ(add.bindings[0].numeric, Numeric::real);
  EXPECT_EQ(add.bindings[2].numeric, Numeric::unsigned_integer);
  EXPECT_EQ(add.bindings[4].type, BindingType::storage_image);
  EXPECT_EQ(add.bindings[5].type, BindingType::storage_buffer);
  EXPECT_EQ(add.bindings[6].type, BindingType::uniform_buffer);
  EXPECT_EQ(add.bindings[6].bytes, 20u) << "ivec4 and float";
  EXPECT_EQ(add.bindings[8].type, BindingType::sampler);
  EXPECT_THAT(add.local_size, ElementsAre(8, 8, 1));
  const Reflection fill = reflected("test_fill");
  ASSERT_EQ(fill.push_members.size(), 3u);
  EXPECT_EQ(fill.push_members[1].offset, 4u);
  EXPECT_EQ(fill.push_members[1].numeric, Numeric::real);
  EXPECT_EQ(fill.push_members[2].numeric, Numeric::signed_integer);
  EXPECT_EQ(fill.push_members[2].name, "slope");
  EXPECT_THAT(reflected("test_classes").local_size, ElementsAre(64, 1, 1));
}

TEST(Reflection, TruncatedModule_IsRejectedOrRead) {
  const auto whole = spirv("test_add");
  for (size_t length = 0; length < whole.size(); ++length) {
    const std::vector<uint32_t> cut(whole.begin(),
                                    whole.begin() + static_cast<std::ptrdiff_t>(length));
    std::string error;
    const auto result = reflect(cut, error);
    EXPECT_EQ(result.has_value(), error.empty()) << length;
    // Header, capabilities, import and memory model come first.
    constexpr size_t before_entry_point = 20;
    if (length < before_entry_point) {
      EXPECT_FALSE(result) << length;
    }
  }
}

TEST(Reflection, RandomWords_AreRejectedOrRead) {
  const auto whole = spirv("test_mark");
  std::mt19937 random(1);
  for (int trial = 0; trial < 5000; ++trial) {
    std::vector<uint32_t> broken(whole.begin(), whole.end());
    for (int change = 0; change < 4; ++change) {
      const uint32_t word = random();
      broken[random() % broken.size()] = change % 2 == 0 ? word : word % 128;
    }
    std::string error;
    const auto result = reflect(broken, error);
    if (result) problems(type("test.mark"), *result);
  }
}

TEST(Signature, EveryTestKernelMatchesItsPassType) {
  for (uint32_t i = 0; i < small_pass_types().size(); ++i) {
    const PassType& own = small_pass_types()[PassTypeId{i}];
    if (!own.shader.empty()) {
      EXPECT_THAT(problems(own, reflected(own.shader)), IsEmpty());
    }
  }
}

TEST(Signature, APortOfAnotherTypeIsNamedWithBothSides) {
  PassType changed = type("test.add");
  std::vector<Port> ports(changed.ports.begin(), changed.ports.end());
  ports[1].usage = Usage::storage_buffer_read;
  ports[2].glsl_type = "texture2D";
  ports[4].usage = Usage::clear;
  ports.pop_back();
  changed.ports = ports;
  const std::string text = problems(changed, reflected("test_add"));
  EXPECT_THAT(
      text,
      HasAll(
          "kernel 'test_add' of type 'test.add': port 'b' (set 0 binding 1) is a buffer block in "
          "the signature and a texture ('b') in the shader",
          "port 'ids' (set 0 binding 2) reads as float because of its type texture2D, but as uint",
          "port 'second' (set 0 binding 4) has usage clear and therefore no descriptor",
          "'weights_block' at set 0 binding 5, but the signature has only 5 ports"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 4) << text;
}

TEST(Signature, InternallyOrderedPortIsCoherent) {
  PassType changed = type("test.add");
  std::vector<Port> ports(changed.ports.begin(), changed.ports.end());
  ports[4].internally_ordered = true;
  changed.ports = ports;
  Reflection reflection = reflected("test_add");
  EXPECT_EQ(problems(changed, reflection),
            "kernel 'test_add' of type 'test.add': port 'second' (set 0 binding 4) is internally "
            "ordered in the signature, but 'second' is not coherent in the shader\n");
  reflection.bindings[4].coherent = true;
  EXPECT_EQ(problems(changed, reflection), "");
}

TEST(Signature, PushConstantsMustFollowTheSettings) {
  PassType changed = type("test.fill");
  std::vector<PassTypeSetting> settings(changed.settings.begin(), changed.settings.end());
  std::swap(settings[0], settings[1]);
  changed.settings = settings;
  std::string text = problems(changed, reflected("test_fill"));
  EXPECT_THAT(
      text,
      HasAll("setting 'slope' is int or uint in the signature, but 'value' is float in the shader",
             "setting 'value' is float in the signature, but 'slope' is int in the shader"));
  settings.pop_back();
  changed.settings = settings;
  text = problems(changed, reflected("test_fill"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "the shader has 3 push constants, but the signature has the port mask and 1 settings "
          "that are push constants"));
}

TEST(Reflection, ReadsSpecialisationConstants) {
  const Reflection constant = reflected("test_constant");
  ASSERT_EQ(constant.constants.size(), 4u);
  EXPECT_EQ(constant.constants[0].id, 1u);
  EXPECT_EQ(constant.constants[0].numeric, Numeric::unsigned_integer);
  EXPECT_EQ(constant.constants[2].name, "mode");
  EXPECT_EQ(constant.constants[2].numeric, Numeric::signed_integer);
  EXPECT_EQ(constant.constants[3].id, 18u);
  EXPECT_EQ(constant.constants[3].numeric, Numeric::none);
  EXPECT_THAT(reflected("test_add").constants, IsEmpty());
}

TEST(Signature, ConstantsMustFollowTheSettings) {
  PassType changed = type("test.constant");
  std::vector<PassTypeSetting> settings(changed.settings.begin(), changed.settings.end());
  std::swap(settings[1], settings[2]);
  changed.settings = settings;
  EXPECT_THAT(
      problems(changed, reflected("test_constant")),
      HasSubstr("setting 'mode' is int or uint in the signature, but 'negate' is bool in the "
                "shader"));
  settings[1].per_frame = true;
  changed.settings = settings;
  EXPECT_THAT(problems(changed, reflected("test_constant")),
              HasAll("setting 'negate' is a push constant, but 'mode' is a specialisation constant",
                     "has 2 push constants, but the signature has the port mask and 2 settings"));
  settings.pop_back();
  changed.settings = settings;
  EXPECT_THAT(problems(changed, reflected("test_constant")),
              HasSubstr("the shader has the constant 'negate' with id 18, but the signature has "
                        "only 2 settings, from id 16 on"));
}

TEST(Signature, ConstantsMustHaveFourBytes) {
  Reflection constant = reflected("test_constant");
  constant.constants[0].numeric = Numeric::signed_integer;
  constant.constants[2].bytes = 8;
  EXPECT_THAT(problems(type("test.constant"), constant),
              HasAll("constant 1 is a mask of ports, but 'bound_ports' is int in the shader",
                     "setting 'mode' is int or uint in the signature, but 'mode' is int with 8 "
                     "bytes in the shader"));
}

TEST(Signature, EnvironmentMustHoldAllThatTheShaderReads) {
  const EnvironmentBinding small[] = {
      {EnvironmentType::uniform_buffer, 16, {}},
      {EnvironmentType::uniform_buffer, 8, {}},
  };
  const std::string text = problems(type("test.fill"), reflected("test_fill"), small);
  EXPECT_THAT(
      text, HasAll("environment binding 0 has 16 bytes, but 'frame' in the shader needs 20",
                   "environment binding 1 is a uniform block in the signature and a buffer block",
                   "'linear_sampler' at set 1 binding 2, but the environment has only 2 bindings"));
}

TEST(Signature, TheWorkgroupMustFitTheDispatch) {
  PassType changed = type("test.classes");
  changed.dispatch = DispatchRule{};
  EXPECT_THAT(problems(changed, reflected("test_classes")),
              HasSubstr("its workgroup is 64x1x1, but this dispatch needs 8x8x1"));
  changed = type("test.list");
  changed.dispatch = DispatchRule{.cells_per_group = 64};
  EXPECT_THAT(problems(changed, reflected("test_list")),
              HasSubstr("its workgroup is 1x1x1, but this dispatch needs 64"));
}

} // namespace
} // namespace dermis::testing
