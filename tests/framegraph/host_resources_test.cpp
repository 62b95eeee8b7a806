// Tests buffers and acceleration structures that the host binds, and options that need features a
// device may lack.

#include "framegraph/compile/availability.hpp"
#include "framegraph/compile/compile.hpp"
#include "framegraph/explain/plan_text.hpp"
#include "framegraph/serialize/plan_file.hpp"
#include "framegraph/verify/verify.hpp"
#include "tests/framegraph/damaged_graph.hpp"
#include "tests/support/text_file.hpp"

#include "framegraph/model/read_graph.hpp"

#include <algorithm>

namespace dermis {
namespace {

using namespace dermis::testing;
using Id = DiagnosticId;

constexpr Port trace_ports[] = {
    {"scene", Usage::acceleration_structure, false, "accelerationStructureEXT", "what rays meet"},
    {"vertices", Usage::storage_buffer_read, false, "vec4", "of its triangles"},
    {"light", Usage::sampled_image, false, "texture2D", "light"},
    {"target", Usage::storage_image_write, false, "image2D", "the result"},
};
constexpr Port copy_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "light"},
    {"target", Usage::storage_image_write, false, "image2D", "the result"},
};

const PassTypeRegistry& pass_types_of_host() {
  static const PassTypeRegistry registry = [] {
    PassTypeRegistry out;
    PassType trace{"test.trace", "trace", "traces", trace_ports, {}};
    trace.features = bit_of(Feature::ray_query);
    out.add(trace);
    out.add({"test.copy", "copy", "copies", copy_ports, {}});
    return out;
  }();
  return registry;
}

constexpr std::string_view traced = R"({ "dermis": 2, "name": "traced",
  "settings": { "how": { "choice": ["trace", "copy"], "default": "trace", "requires": { "trace": ["ray_query", "scene"] } } },
  "imports": {
    "light": { "format": "rgba16f", "size": "view" },
    "scene": { "acceleration_structure": "top_level", "optional": true },
    "vertices": { "buffer": { "stride": 32, "count": 3 }, "optional": true },
    "lights": { "buffer": { "stride": 16 }, "optional": true } },
  "resources": { "out": { "format": "rgba16f", "size": "view" } },
  "passes": [
    { "pass": "trace", "type": "test.trace", "when": "how == 'trace'",
      "read": { "scene": "scene", "vertices": "vertices", "light": "light" }, "write": { "target": "out" } },
    { "pass": "copy", "type": "test.copy", "when": "how == 'copy'",
      "read": { "light": "light" }, "write": { "target": "out" } } ],
  "exports": ["out"] })";

Read read_with_host(std::string text) {
  Read out;
  const auto document = parse_document("graph.json", std::move(text), out.diagnostics);
  if (document) out.graph = read_graph(*document, pass_types_of_host(), out.diagnostics);
  return out;
}

std::string with(std::string_view from, std::string_view to) {
  return test::replaced(std::string(traced), from, to);
}

class DamagedHostResources : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedHostResources, GiveOneDiagnosticAtTheDamage) {
  const std::string text = with(GetParam().from, GetParam().to);
  const Read result = read_with_host(text);
  EXPECT_FALSE(result.graph);
  expect_damage(GetParam(), text, result.diagnostics);
}

INSTANTIATE_TEST_SUITE_P(
    Graph, DamagedHostResources,
    ::testing::Values(
        damage("AnAccelerationStructureIsOfTheTopLevel", R"("top_level")", R"("bottom_level")",
               Id::invalid_value, R"("bottom_level")", {"top_level"}),
        damage("NoGraphBuildsAnAccelerationStructure",
               R"("out": { "format": "rgba16f", "size": "view" } })",
               R"("out": { "format": "rgba16f", "size": "view" }, "own": { )"
               R"("acceleration_structure": "top_level" } })",
               Id::not_imported, R"("own")", {"'own'", "a graph cannot own"}),
        damage("AnAccelerationStructureIsNoImage", R"({ "light": "light" })",
               R"({ "light": "scene" })", Id::usage_mismatch, R"("scene" }, "write")",
               {"expects an image", "'scene' is an acceleration structure"}),
        damage("ABufferIsNoAccelerationStructure", R"("scene": "scene")", R"("scene": "vertices")",
               Id::usage_mismatch, R"("vertices", "vertices")",
               {"expects an acceleration structure", "'vertices' is a buffer"}),
        damage("AnImportedBufferHasAStride", R"("stride": 16)", R"("count": 16)", Id::missing_key,
               R"({ "count": 16)", {"buffer 'lights'", "'stride'"}),
        damage("AnAccelerationStructureIsNotExported", R"("exports": ["out"])",
               R"("exports": ["scene", "out"])", Id::bad_export, R"("scene", "out")",
               {"'scene' is an acceleration structure"}),
        damage("ARequirementIsAFeatureOrAnImport", R"("ray_query", "scene"])", R"("ray_querry"])",
               Id::bad_option_requires, R"("ray_querry")", {"did you mean 'ray_query'?"}),
        damage("ARequiredImportIsOptional", R"("ray_query", "scene"])", R"("light"])",
               Id::bad_option_requires, R"("light"])", {"not an optional import"}),
        damage("ARequiredImportWithoutABooleanIsReportedOnce", R"("top_level", "optional": true)",
               R"("top_level", "optional": "yes")", Id::wrong_type, R"("yes")",
               {"'scene' must be a boolean"}),
        damage("OptionsThatRequireAreOptions", R"("requires": { "trace")",
               R"("requires": { "trase")", Id::bad_option_requires, R"("trase")",
               {"did you mean 'trace'?"}),
        damage("OneOptionRequiresNothing", R"(["ray_query", "scene"] })",
               R"(["ray_query"], "copy": ["scene"] })", Id::bad_option_requires, R"("requires")",
               {"every option"}),
        damage("AGraphRequiresFeaturesOnly", R"("name": "traced")",
               R"("name": "traced", "requires": ["scene"])", Id::invalid_value, "\"scene\"],\n",
               {"ray_query"})),
    property_of);

struct Compiled {
  Diagnostics diagnostics;
  std::optional<CompiledPlan> plan;
  CompileInput input;
};

Compiled compiled(const Graph& graph, const DeviceProfile& device, std::vector<bool> bound = {}) {
  Compiled out;
  out.input.graph = &graph;
  out.input.pass_types = &pass_types_of_host();
  out.input.device = &device;
  out.input.view_width = 64;
  out.input.view_height = 64;
  out.input.bound = std::move(bound);
  out.plan = compile(out.input, out.diagnostics);
  return out;
}

DeviceProfile without_rays() {
  DeviceProfile device = generic_profile();
  device.features = 0;
  return device;
}

std::string only_pass(const Graph& graph, const CompiledPlan& compiled) {
  EXPECT_EQ(compiled.plan.passes.size(), 1u);
  return graph.passes[compiled.plan.passes.front().declared.value].name;
}

TEST(HostResources, AreAcquiredReadAndReleased) {
  const Read loaded = read_with_host(std::string(traced));
  ASSERT_TRUE(loaded.graph) << all_messages(loaded.diagnostics);
  const DeviceProfile device = generic_profile();
  const Compiled result = compiled(*loaded.graph, device);
  ASSERT_TRUE(result.plan) << all_messages(result.diagnostics);
  const Plan& plan = result.plan->plan;
  EXPECT_TRUE(verify(plan).violations.empty());
  EXPECT_EQ(only_pass(*loaded.graph, *result.plan), "trace");
  const auto barriers_of = [&](ResourceType type, bool from, bool to) {
    return std::count_if(plan.barriers.begin(), plan.barriers.end(),
                         [&](const PlanBarrier& barrier) {
                           return plan.resources[barrier.resource].type == type &&
                                  barrier.from_host == from && barrier.to_host == to;
                         });
  };
  EXPECT_EQ(barriers_of(ResourceType::acceleration_structure, true, false), 1);
  EXPECT_EQ(barriers_of(ResourceType::acceleration_structure, false, true), 1);
  EXPECT_EQ(barriers_of(ResourceType::buffer, true, false), 1) << "the vertices";
  EXPECT_EQ(barriers_of(ResourceType::buffer, false, true), 1);
  EXPECT_EQ(barriers_of(ResourceType::buffer, true, true), 1) << "the lights, which no pass reads";
  for (const PlanBarrier& barrier : plan.barriers) {
    const PlanResource& resource = plan.resources[barrier.resource];
    if (resource.type == ResourceType::image) continue;
    EXPECT_EQ(barrier.old_layout, Layout::undefined);
    EXPECT_EQ(barrier.new_layout, Layout::undefined);
    if (!barrier.from_host || barrier.to_host) continue;
    EXPECT_EQ(barrier.destination_stages, stage::compute_shader);
    EXPECT_EQ(barrier.destination_access, resource.type == ResourceType::buffer
                                              ? access::shader_storage_read
                                              : access::acceleration_structure_read);
  }
  for (const PlanResource& resource : plan.resources)
    if (resource.type != ResourceType::image) {
      EXPECT_EQ(resource.first_instance, no_instance) << "the host's memory";
      const std::string& name = loaded.graph->resources[resource.declared.value].name;
      EXPECT_EQ(resource.bytes, name == "vertices" ? 96u : name == "lights" ? 16u : 0u) << name;
    }
}

TEST(HostResources, ArePartOfASavedPlan) {
  const Read loaded = read_with_host(std::string(traced));
  ASSERT_TRUE(loaded.graph);
  const DeviceProfile device = generic_profile();
  const Compiled result = compiled(*loaded.graph, device);
  ASSERT_TRUE(result.plan);
  const std::string bytes = write_plan(saved_plan(result.input, result.plan->plan));
  Diagnostics diagnostics;
  const auto back = read_plan("plan", bytes, diagnostics);
  ASSERT_TRUE(back) << all_messages(diagnostics);
  EXPECT_EQ(write_plan(*back), bytes);
  EXPECT_EQ(back->key.features, bit_of(Feature::ray_query));
}

TEST(Options, UnavailableOnDevice_FallBack) {
  const Read loaded = read_with_host(std::string(traced));
  ASSERT_TRUE(loaded.graph);
  const DeviceProfile device = without_rays();
  Compiled result = compiled(*loaded.graph, device);
  ASSERT_TRUE(result.plan) << all_messages(result.diagnostics);
  EXPECT_EQ(only_pass(*loaded.graph, *result.plan), "copy");
  EXPECT_EQ(result.plan->plan.setting_values[0].integer, 1);
  const std::string text = plan_text(*loaded.graph, pass_types_of_host(), *result.plan, {});
  EXPECT_NE(
      text.find("'copy' instead of 'trace', which is not available: the device lacks ray_query"),
      std::string::npos)
      << text;
  report_unavailable(*loaded.graph, device, {}, result.diagnostics);
  ASSERT_EQ(result.diagnostics.list.size(), 1u);
  EXPECT_EQ(result.diagnostics.list[0].id, Id::option_unavailable);
}

TEST(Options, UnboundImport_FallBack) {
  const Read loaded = read_with_host(std::string(traced));
  ASSERT_TRUE(loaded.graph);
  const DeviceProfile device = generic_profile();
  std::vector<bool> bound(loaded.graph->resources.size(), true);
  bound[1] = false; // Unbinds the scene.
  const Compiled result = compiled(*loaded.graph, device, bound);
  ASSERT_TRUE(result.plan) << all_messages(result.diagnostics);
  EXPECT_EQ(only_pass(*loaded.graph, *result.plan), "copy");
  const std::string text = plan_text(*loaded.graph, pass_types_of_host(), *result.plan, {});
  EXPECT_NE(text.find("not available: 'scene' is not bound"), std::string::npos) << text;
}

TEST(Features, RequiredByTheGraph_MustBeAvailable) {
  const Read loaded = read_with_host(
      with("\"name\": \"traced\"", "\"name\": \"traced\",\n  \"requires\": [\"ray_query\"]"));
  ASSERT_TRUE(loaded.graph) << all_messages(loaded.diagnostics);
  const DeviceProfile device = without_rays();
  const Compiled result = compiled(*loaded.graph, device);
  EXPECT_FALSE(result.plan);
  expect_only(result.diagnostics, Id::device_feature, 2, 3, {"'traced'", "ray_query"});
}

TEST(Features, RequiredByAKernel_MustBeAvailable) {
  const Read loaded =
      read_with_host(with(", \"requires\": { \"trace\": [\"ray_query\", \"scene\"] }", ""));
  ASSERT_TRUE(loaded.graph) << all_messages(loaded.diagnostics);
  const DeviceProfile device = without_rays();
  const Compiled result = compiled(*loaded.graph, device);
  EXPECT_FALSE(result.plan);
  expect_only(result.diagnostics, Id::device_feature, 10, 15, {"pass 'trace'", "ray_query"});
}

} // namespace
} // namespace dermis
