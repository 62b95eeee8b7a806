// Tests the life of a graph: creation, its errors, slots, reload, resize, settings.

#include "tests/integration/abi/dermis_fixture.hpp"

#include "integration/abi/graph.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace dermis::abi_test {
namespace {

struct GraphLife : DermisTest {
  std::string burley = read_text("configs/graphs/burley.json");

  std::string with(const std::string& from, const std::string& to) const {
    return replaced(burley, from, to);
  }
  std::string described(dermis_graph graph, dermis_describe_format format) {
    size_t size = 0;
    EXPECT_OK(dermis_graph_describe(graph, format, &size, nullptr));
    std::string text(size, '\0');
    EXPECT_OK(dermis_graph_describe(graph, format, &size, text.data()));
    text.resize(size - 1);
    return text;
  }
};

TEST(Validate, AcceptsTheShippedGraphsWithoutADevice) {
  for (const char* path :
       {"configs/graphs/burley.json", "configs/graphs/separable.json", "configs/graphs/sap.json"}) {
    const std::string text = read_text(path);
    const dermis_source source = source_of(text, path);
    dermis_report report = nullptr;
    EXPECT_OK(dermis_validate(&source, &report)) << dermis_report_text(report);
    dermis_report_destroy(report);
  }
}

TEST(Validate, NamesFileLineAndColumnOfAnError) {
  std::string text = read_text("configs/graphs/burley.json");
  const size_t at = text.find("\"exports\"");
  ASSERT_NE(at, std::string::npos);
  text.replace(at, 9, "\"exprots\"");
  const auto line = static_cast<uint32_t>(
      std::count(text.begin(), text.begin() + static_cast<ptrdiff_t>(at), '\n') + 1);
  const auto column = static_cast<uint32_t>(at - text.rfind('\n', at));
  const dermis_source source = source_of(text, "typo.json");
  dermis_report report = nullptr;
  EXPECT_EQ(dermis_validate(&source, &report), DERMIS_ERROR_CONFIG);
  EXPECT_TRUE(nlohmann::json::accept(dermis_report_json(report)));
  const Said said = take(report);
  const auto found = std::find(said.names.begin(), said.names.end(), "unknown_key");
  ASSERT_NE(found, said.names.end()) << said.all;
  EXPECT_EQ(said.places[static_cast<size_t>(found - said.names.begin())],
            std::make_pair(line, column));
  EXPECT_THAT(said.all, HasAll(fmt::format("typo.json:{}:{}", line, column), "'exports'"));
  EXPECT_THAT(dermis_last_error(), HasSubstr("typo.json:"));
}

TEST(Validate, RejectsASourceWithoutTextOrLength) {
  dermis_source source = DERMIS_SOURCE_INIT;
  EXPECT_EQ(dermis_validate(&source, nullptr), DERMIS_ERROR_ARGUMENT);
  source.text = "{}";
  EXPECT_EQ(dermis_validate(&source, nullptr), DERMIS_ERROR_ARGUMENT);
  source.length = size_t{1} << 30;
  EXPECT_THAT(dermis_validate(&source, nullptr), Fails(DERMIS_ERROR_ARGUMENT, "length"));
}

TEST_F(GraphLife, SlotsDescribeTheBindings) {
  const dermis_graph graph = make_graph();
  std::map<std::string, dermis_slot> slots;
  uint32_t id = 0;
  for (const dermis_slot& slot : slots_of(graph)) {
    EXPECT_EQ(slot.id, id++);
    slots[slot.name] = slot;
  }
  ASSERT_EQ(slots.size(), 6u);
  EXPECT_EQ(slots["lighting"].format, VK_FORMAT_R16G16B16A16_SFLOAT);
  EXPECT_EQ(slots["lighting"].usage, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT);
  EXPECT_EQ(slots["lighting"].read + slots["lighting"].written + slots["lighting"].required, 3u);
  EXPECT_EQ(slots["depth"].format, VK_FORMAT_R32_SFLOAT) << "in the format of the host";
  EXPECT_EQ(slots["depth"].written, 0u);
  EXPECT_EQ(slots["depth"].best_layout, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  EXPECT_EQ(slots["material"].width, 64u);
  EXPECT_EQ(slots["albedo"].bound, 0u);
  EXPECT_EQ(slots["albedo"].required, 0u);
  EXPECT_EQ(slots["scattered_light"].bound, 0u);
}

TEST_F(GraphLife, ErrorsOfGraphAndProfilesAreInOneReport) {
  GraphOptions options;
  options.text = with("\"subsurface.burley\"", "\"subsurface.burly\"");
  dermis_graph graph = nullptr;
  dermis_report report = nullptr;
  EXPECT_EQ(create_graph(options, &graph, &report), DERMIS_ERROR_CONFIG);
  EXPECT_EQ(graph, nullptr);
  const Said said = take(report);
  EXPECT_THAT(said.all, HasAll("graph.json:", "subsurface.burley"));
}

TEST_F(GraphLife, WrongSlotsOfTheHostAreReported) {
  GraphOptions options;
  dermis_graph graph = nullptr;
  dermis_report report = nullptr;
  options.unbound.push_back("depth");
  EXPECT_EQ(create_graph(options, &graph, &report), DERMIS_ERROR_CONFIG);
  EXPECT_THAT(take(report).names, Contains("host_required_slot"));

  options = {};
  options.formats.emplace_back("lighting", VK_FORMAT_R8_UNORM);
  EXPECT_EQ(create_graph(options, &graph, &report), DERMIS_ERROR_CONFIG);
  EXPECT_THAT(take(report).all, HasAll("lighting", "r8_unorm"));

  options = {};
  options.formats.emplace_back("lighting", VK_FORMAT_ASTC_4x4_SRGB_BLOCK);
  EXPECT_EQ(create_graph(options, &graph, &report), DERMIS_ERROR_ARGUMENT);
  EXPECT_EQ(report, nullptr);

  options = {};
  options.unbound.push_back("velocity");
  EXPECT_OK(create_graph(options, &graph, &report));
  EXPECT_THAT(take(report).names, Contains("host_names_other_slots"))
      << "hosts may list names that this graph does not have";
  graphs.push_back(graph);
}

TEST_F(GraphLife, DescriptionsHaveTheirFormat) {
  const dermis_graph graph = make_graph();
  EXPECT_TRUE(nlohmann::json::accept(described(graph, DERMIS_DESCRIBE_JSON)));
  EXPECT_THAT(described(graph, DERMIS_DESCRIBE_DOT), HasSubstr("digraph"));
  EXPECT_THAT(described(graph, DERMIS_DESCRIBE_TEXT), HasSubstr("scatter"));
  size_t size = 0;
  EXPECT_EQ(dermis_graph_describe(graph, static_cast<dermis_describe_format>(3), &size, nullptr),
            DERMIS_ERROR_ARGUMENT);
}

TEST_F(GraphLife, OverlaysApplyAtCreationAndAtEachReload) {
  GraphOptions options;
  options.overlays = {read_text("configs/overlays/full_precision.json")};
  const dermis_graph wide = make_graph(options), narrow = make_graph();
  const auto transient_bytes = [](dermis_graph graph) {
    const dermis_memory memory = memory_of(graph);
    return memory.transient_bytes;
  };
  EXPECT_GT(transient_bytes(wide), transient_bytes(narrow));
  EXPECT_THAT(described(wide, DERMIS_DESCRIBE_TEXT),
              HasSubstr("set      /resources/light/format  (overlay.json:8:14)"));
  EXPECT_OK(reload_text(wide, source_of(burley, "graph.json")));
  EXPECT_GT(transient_bytes(wide), transient_bytes(narrow));

  options.overlays = {"{ \"dermis_overlay\": 2, \"edits\": [ { \"remove\": \"/passes/none\" } ] }"};
  dermis_graph graph = nullptr;
  dermis_report report = nullptr;
  EXPECT_EQ(create_graph(options, &graph, &report), DERMIS_ERROR_CONFIG);
  EXPECT_THAT(take(report).all, HasAll("overlay.json:1:", "'none'"));
}

struct Delivery {
  std::string text;
  uint32_t calls = 0;
};
uint32_t DERMIS_CALL deliver(void* user, const char* name, dermis_source* source) {
  auto& delivery = *static_cast<Delivery*>(user);
  ++delivery.calls;
  if (std::string(name) != "parts/classify.json") return 0;
  source->text = delivery.text.data();
  source->length = delivery.text.size();
  return 1;
}

TEST_F(GraphLife, IncludedFilesAreOpenedOncePerCreationAndReload) {
  const size_t begin = burley.find("{ \"pass\": \"classify\"");
  const size_t end = burley.find("} }", begin) + 3;
  ASSERT_LT(end, burley.size());
  Delivery delivery{"{ \"dermis_fragment\": 2, \"passes\": [ " + burley.substr(begin, end - begin) +
                    " ] }"};
  std::string including = burley;
  including.replace(begin, end - begin, "{ \"include\": \"parts/classify.json\" }");
  GraphOptions options;
  options.text = including;
  dermis_graph graph = nullptr;
  dermis_report report = nullptr;
  EXPECT_EQ(create_graph(options, &graph, &report), DERMIS_ERROR_CONFIG);
  EXPECT_THAT(take(report).all, HasAll("graph.json:", "no include function"));
  options.include = deliver;
  options.include_user = &delivery;
  graph = make_graph(options);
  EXPECT_EQ(delivery.calls, 1u);
  EXPECT_OK(dermis_graph_resize(graph, 32, 32, nullptr));
  EXPECT_EQ(delivery.calls, 1u) << "no file is opened again";
  const dermis_source source = source_of(including, "graph.json");
  EXPECT_OK(reload_text(graph, source));
  EXPECT_EQ(delivery.calls, 2u);
  delivery.text.clear();
  EXPECT_EQ(reload_text(graph, source, &report), DERMIS_ERROR_CONFIG);
  EXPECT_THAT(take(report).all, HasSubstr("parts/classify.json"));
  EXPECT_OK(dermis_graph_resize(graph, 64, 64, nullptr)) << "the running graph kept its own";
}

TEST_F(GraphLife, MemoryMatchesThePlan) {
  const dermis_graph graph = make_graph();
  dermis_memory memory = memory_of(graph);
  EXPECT_GT(memory.transient_bytes, 64u * 64u * 8u) << "at least one rgba16f image";
  EXPECT_GE(memory.transient_unaliased_bytes, memory.transient_bytes);
  EXPECT_EQ(memory.history_bytes, 0u);
  EXPECT_GT(memory.constant_bytes, 256u * 32u) << "at least the profile table";
  memory.struct_size = 8;
  EXPECT_EQ(dermis_graph_memory(graph, &memory), DERMIS_ERROR_ARGUMENT);
}

TEST_F(GraphLife, FailedReload_KeepsTheGraphBitIdentical) {
  const auto run = [&](bool reload) {
    last_frame = 0;
    const dermis_graph graph = make_bound_graph();
    const auto bound = bindings(graph);
    for (int i = 0; i < 3; ++i) {
      dermis_frame one = frame(bound);
      EXPECT_OK(record(graph, one));
      if (!reload) continue;
      const std::string broken = with("\"subsurface.burley\"", "\"subsurface.nothing\"");
      const dermis_source source = source_of(broken, "broken.json");
      EXPECT_EQ(reload_text(graph, source), DERMIS_ERROR_CONFIG);
      const std::string cut = burley.substr(0, burley.size() / 2);
      EXPECT_EQ(reload_text(graph, source_of(cut, "half.json")), DERMIS_ERROR_CONFIG);
      EXPECT_EQ(dermis_graph_resize(graph, 0, 0, nullptr), DERMIS_ERROR_ARGUMENT);
      EXPECT_EQ(dermis_graph_set_setting(graph, "samples", "1e9", nullptr), DERMIS_ERROR_CONFIG);
    }
    return texels("lighting");
  };
  EXPECT_EQ(run(false), run(true));
}

TEST_F(GraphLife, Reload_StartsAtTheNextRecordAndKeepsSettings) {
  const dermis_graph graph = make_bound_graph();
  const auto bound = bindings(graph);
  dermis_frame one = frame(bound);
  ASSERT_OK(record(graph, one));
  ASSERT_OK(dermis_graph_set_setting(graph, "samples", "64", nullptr));

  const std::string renamed = with("\"pass\": \"scatter\"", "\"pass\": \"walk\"");
  const dermis_source source = source_of(renamed, "renamed.json");
  dermis_report report = nullptr;
  ASSERT_OK(reload_text(graph, source, &report));
  dermis_report_destroy(report);
  for (int i = 0; i < 3; ++i) {
    dermis_frame next = frame(bound);
    ASSERT_OK(record(graph, next));
  }
  EXPECT_THAT(described(graph, DERMIS_DESCRIBE_TEXT), HasSubstr("walk"));

  const std::string poorer = with("\"min\": 4, \"max\": 4096", "\"min\": 4, \"max\": 32");
  ASSERT_OK(reload_text(graph, source_of(poorer, "poorer.json"), &report));
  EXPECT_THAT(take(report).names, Contains("setting_not_carried")) << "64 is beyond the new range";
}

TEST_F(GraphLife, NoShaderCompiler_IsReported) {
  const dermis_graph graph = make_graph();
  dermis_report report = nullptr;
  const dermis_include_fn never = [](void*, const char*, dermis_source*) -> uint32_t {
    ADD_FAILURE() << "a library without a shader compiler opens no file";
    return 0;
  };
  EXPECT_EQ(dermis_graph_reload_shaders(graph, never, nullptr, &report), DERMIS_ERROR_UNSUPPORTED);
  const Said said = take(report);
  EXPECT_THAT(said.names, ElementsAre("no_shader_compiler"));
  EXPECT_THAT(said.all, HasSubstr("DERMIS_RUNTIME_SHADERS"));
  EXPECT_OK(dermis_graph_reload_shaders(graph, nullptr, nullptr, nullptr))
      << "the library's own kernels always exist";
  make_images(graph);
  dermis_frame one = bound_frame(graph);
  EXPECT_OK(record(graph, one));
}

TEST_F(GraphLife, Resize_StartsAtTheNextRecord) {
  const dermis_graph graph = make_bound_graph();
  auto bound = bindings(graph);
  dermis_frame one = frame(bound);
  ASSERT_OK(record(graph, one));
  ASSERT_OK(dermis_graph_resize(graph, 96, 40, nullptr));
  dermis_frame small = frame(bound, 96, 40);
  EXPECT_THAT(record(graph, small), Fails(DERMIS_ERROR_ARGUMENT, "96x40"))
      << "images of the old size";
  make_images(graph);
  bound = bindings(graph);
  dermis_frame large = frame(bound, 96, 40);
  EXPECT_OK(record(graph, large));
  EXPECT_EQ(texels("lighting").size(), 96u * 40u * 4u);
}

// Reads internals, because the interface does not show whether a plan was cached or compiled again.
TEST_F(GraphLife, SettingFlippedBack_ReusesItsPlan) {
  GraphOptions options;
  options.text =
      replaced(with("\"settings\": {", "\"settings\": { \"combined\": { \"bool\": true },"),
               "\"pass\": \"combine\",", "\"pass\": \"combine\", \"when\": \"combined\",");
  const dermis_graph graph = make_graph(options);
  make_images(graph);
  const auto bound = bindings(graph);
  const PlanCache& plans = graph->plans;
  EXPECT_EQ(plans.misses, 1u);
  constexpr uint32_t flips = 6;
  for (uint32_t i = 0; i < flips; ++i) {
    ASSERT_OK(dermis_graph_set_setting(graph, "combined", i % 2 == 0 ? "false" : "true", nullptr));
    EXPECT_EQ(plans.misses, 2u) << "one plan per value, for any number of flips";
    EXPECT_EQ(plans.hits, i);
    dermis_frame one = frame(bound);
    EXPECT_OK(record(graph, one));
  }
  ASSERT_OK(dermis_graph_set_setting(graph, "samples", "64", nullptr));
  EXPECT_EQ(plans.hits + plans.misses, 1u + flips)
      << "a setting without a `when` needs no new plan";
}

TEST_F(GraphLife, SettingIsInEffectAtTheNextRecord) {
  const auto run = [&](const char* samples) {
    last_frame = 0;
    const dermis_graph graph = make_bound_graph();
    const auto bound = bindings(graph);
    EXPECT_OK(dermis_graph_set_setting(graph, "samples", samples, nullptr));
    dermis_frame one = frame(bound);
    EXPECT_OK(record(graph, one));
    return texels("lighting");
  };
  EXPECT_EQ(run("16"), run("16")) << "the same frame gives the same bits";
  EXPECT_NE(run("16"), run("64"));
}

} // namespace
} // namespace dermis::abi_test
