// Tests every field of a description that can be wrong: the message names the field, and nothing is
// created.

#include "framegraph/text/limits.hpp"
#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <cmath>
#include <functional>

namespace dermis::abi_test {
namespace {

// A complete description and its arrays.
struct Description {
  std::string graph = read_text("configs/graphs/burley.json"),
              skin = read_text("configs/profiles/skin.json"),
              overlay = read_text("configs/overlays/accumulate.json");
  std::vector<dermis_profile> profiles{2, dermis_profile DERMIS_PROFILE_INIT};
  std::vector<dermis_slot_format> formats{1, dermis_slot_format DERMIS_SLOT_FORMAT_INIT};
  std::vector<dermis_source> overlays{1, dermis_source DERMIS_SOURCE_INIT};
  std::vector<const char*> unbound{"albedo", "scatter_scale"};
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;

  Description() {
    for (uint32_t i = 0; i < 2; ++i) {
      profiles[i].id = i + 1;
      profiles[i].source = source_of(skin, nullptr);
    }
    formats[0].name = "depth";
    formats[0].format = VK_FORMAT_R32_SFLOAT;
    overlays[0] = source_of(overlay, nullptr);
    desc.source = source_of(graph, nullptr);
    desc.width = desc.height = 16;
    desc.profiles = profiles.data();
    desc.profile_count = 2;
    desc.unbound = unbound.data();
    desc.unbound_count = 2;
    desc.formats = formats.data();
    desc.format_count = 1;
    desc.overlays = overlays.data();
    desc.overlay_count = 1;
  }
  Description(const Description&) = delete;
  Description& operator=(const Description&) = delete;
};

struct Fields : ::testing::Test {
  NullHost host;
  void SetUp() override { ASSERT_OK(host.make_context(host.context_desc())); }
};

TEST_F(Fields, GraphDesc_WrongFieldsAreNamed) {
  using Change = std::function<void(Description&)>;
  const std::pair<const char*, Change> changes[] = {
      {"desc.keep is 0x1, expected 0", [](auto& d) { d.desc.keep = DERMIS_KEEP_SOURCE; }},
      {"desc.pixel_aspect is -1", [](auto& d) { d.desc.pixel_aspect = -1; }},
      {"desc.pixel_aspect is nan", [](auto& d) { d.desc.pixel_aspect = NAN; }},
      {"desc.pixel_aspect is 1e-07", [](auto& d) { d.desc.pixel_aspect = 1e-7f; }},
      {"desc.source.text is NULL", [](auto& d) { d.desc.source.text = nullptr; }},
      {"desc.source.length is 0", [](auto& d) { d.desc.source.length = 0; }},
      {"at most", [](auto& d) { d.desc.source.length = limits::file_bytes + 1; }},
      {"the size is 0x16", [](auto& d) { d.desc.width = 0; }},
      {"the size is 16x0", [](auto& d) { d.desc.height = 0; }},
      {"the size is 16385x16", [](auto& d) { d.desc.width = 16385; }},
      {"the size is 16x16385", [](auto& d) { d.desc.height = 16385; }},
      {"the size is 16x4294967295", [](auto& d) { d.desc.height = ~0u; }},
      {"desc.profiles is NULL and its count is 2", [](auto& d) { d.desc.profiles = nullptr; }},
      {"desc.profiles[1].id is 0", [](auto& d) { d.profiles[1].id = 0; }},
      {"desc.profiles[1].id is 256", [](auto& d) { d.profiles[1].id = 256; }},
      {"desc.profiles[1].id is 1, which an earlier entry has",
       [](auto& d) { d.profiles[1].id = 1; }},
      {"desc.profiles[0].source.text is NULL",
       [](auto& d) { d.profiles[0].source.text = nullptr; }},
      {"desc.profiles[1].struct_size", [](auto& d) { d.profiles[1].struct_size += 8; }},
      {"desc.unbound is NULL and its count is 2", [](auto& d) { d.desc.unbound = nullptr; }},
      {"desc.unbound[1] is NULL", [](auto& d) { d.unbound[1] = nullptr; }},
      {"desc.formats is NULL and its count is 1", [](auto& d) { d.desc.formats = nullptr; }},
      {"desc.formats[0].name is NULL", [](auto& d) { d.formats[0].name = nullptr; }},
      {"desc.formats[1] names the slot 'depth' again",
       [](auto& d) {
         d.formats.push_back(d.formats[0]);
         d.desc.formats = d.formats.data();
         d.desc.format_count = 2;
       }},
      {"which no graph can declare (slot 'depth')",
       [](auto& d) { d.formats[0].format = VK_FORMAT_UNDEFINED; }},
      {"which no graph can declare",
       [](auto& d) { d.formats[0].format = VK_FORMAT_ASTC_4x4_SRGB_BLOCK; }},
      {"desc.overlays is NULL and its count is 1", [](auto& d) { d.desc.overlays = nullptr; }},
      {"desc.overlays[0].text is NULL", [](auto& d) { d.overlays[0].text = nullptr; }},
      {"desc.overlays[0].struct_size", [](auto& d) { d.overlays[0].struct_size = 1; }},
  };
  for (const auto& [said, change] : changes) {
    Description wrong;
    change(wrong);
    auto made = reinterpret_cast<dermis_graph>(uintptr_t{8});
    EXPECT_THAT(dermis_graph_create(host.context, &wrong.desc, &made, nullptr),
                Fails(DERMIS_ERROR_ARGUMENT, said))
        << said;
    EXPECT_EQ(made, nullptr) << said;
    EXPECT_EQ(host.device.alive(), 0u) << said;
  }
  const Description right;
  EXPECT_OK(dermis_graph_create(host.context, &right.desc, &host.graph, nullptr));
  EXPECT_THAT(dermis_graph_create(host.context, nullptr, &host.graph, nullptr),
              Fails(DERMIS_ERROR_ARGUMENT, "desc is NULL"));
  EXPECT_THAT(dermis_graph_create(host.context, &right.desc, nullptr, nullptr),
              Fails(DERMIS_ERROR_ARGUMENT, "graph is NULL"));
}

// Sources without a name are named by their role.
TEST_F(Fields, Texts_WrongFieldsAreLocated) {
  const std::string broken = "{ \"dermis\": 2, }", not_a_profile = "{ \"scale\": 1 }";
  const std::pair<const char*, std::function<void(Description&)>> changes[] = {
      {"profile 2:1:", [&](auto& d) { d.profiles[1].source = source_of(broken, nullptr); }},
      {"profile 1:1:", [&](auto& d) { d.profiles[0].source = source_of(not_a_profile, nullptr); }},
      {"mine.json:1:",
       [&](auto& d) { d.profiles[0].source = source_of(not_a_profile, "mine.json"); }},
      {"overlay 0:1:", [&](auto& d) { d.overlays[0] = source_of(broken, nullptr); }},
      {"graph.json:1:", [&](auto& d) { d.desc.source = source_of(broken, "graph.json"); }},
  };
  for (const auto& [place, change] : changes) {
    Description wrong;
    change(wrong);
    dermis_report report = nullptr;
    EXPECT_EQ(dermis_graph_create(host.context, &wrong.desc, &host.graph, &report),
              DERMIS_ERROR_CONFIG)
        << place;
    EXPECT_THAT(dermis_report_text(report), HasSubstr(place));
    EXPECT_GT(dermis_report_count(report), 0u);
    dermis_report_destroy(report);
    EXPECT_EQ(host.graph, nullptr);
  }
}

TEST_F(Fields, Forecast_WrongFieldsAreNamed) {
  ASSERT_OK(host.make_graph(64));
  NullHost other;
  ASSERT_OK(other.make_context(other.context_desc()));
  ASSERT_OK(other.make_graph());
  using Change = std::function<void(dermis_forecast_desc&)>;
  const std::pair<const char*, Change> changes[] = {
      {"desc.view belongs to another graph",
       [&](auto& d) { d.view = dermis_graph_view(other.graph); }},
      {"desc.width is 8 and desc.height is 0, expected both or neither",
       [](auto& d) { d.width = 8; }},
      {"the rectangle is 65x64, larger than the allocated size 64x64",
       [](auto& d) {
         d.width = 65;
         d.height = 64;
       }},
      {"desc.milliseconds is -1", [](auto& d) { d.milliseconds = -1; }},
      {"desc.milliseconds is nan", [](auto& d) { d.milliseconds = NAN; }},
  };
  for (const auto& [said, change] : changes) {
    dermis_forecast_desc wrong = DERMIS_FORECAST_DESC_INIT;
    change(wrong);
    dermis_outcome outcome = DERMIS_OUTCOME_INIT;
    uint32_t count = 0;
    EXPECT_THAT(dermis_graph_predict(host.graph, &wrong, &outcome),
                Fails(DERMIS_ERROR_ARGUMENT, said));
    EXPECT_THAT(dermis_graph_frontier(host.graph, &wrong, &count, nullptr),
                Fails(DERMIS_ERROR_ARGUMENT, said));
  }
}

TEST_F(Fields, GraphCalls_NullArgumentsAreNamed) {
  ASSERT_OK(host.make_graph());
  const auto rejected = [](dermis_result result, const char* said) {
    EXPECT_THAT(result, Fails(DERMIS_ERROR_ARGUMENT, said)) << said;
  };
  rejected(dermis_graph_reload(host.graph, nullptr, nullptr), "dermis_graph_reload: desc is NULL");
  dermis_graph_desc empty = DERMIS_GRAPH_DESC_INIT;
  rejected(dermis_graph_reload(host.graph, &empty, nullptr),
           "dermis_graph_reload: desc.source.text is NULL");
  empty.keep = DERMIS_KEEP_SOURCE;
  rejected(dermis_graph_reload(host.graph, &empty, nullptr),
           "dermis_graph_reload: the size is 0x0");
  empty.keep = DERMIS_KEEP_ALL + 1;
  rejected(dermis_graph_reload(host.graph, &empty, nullptr),
           "desc.keep is 0x100, known bits are 0xff");
  rejected(dermis_graph_resize(host.graph, 0, 1, nullptr), "dermis_graph_resize: the size is 0x1");
  rejected(dermis_graph_set_setting(host.graph, nullptr, "1", nullptr), "name is NULL");
  rejected(dermis_graph_set_budget(host.graph, nullptr, nullptr), "budget is NULL");
  rejected(dermis_graph_set_budget(nullptr, nullptr, nullptr), "graph is NULL");
  rejected(dermis_graph_memory(host.graph, nullptr), "memory is NULL");
  rejected(dermis_graph_predict(host.graph, nullptr, nullptr), "outcome is NULL");
  rejected(dermis_graph_frontier(host.graph, nullptr, nullptr, nullptr), "count is NULL");
  const dermis_view view = dermis_graph_view(host.graph);
  rejected(dermis_view_create(host.graph, nullptr, nullptr, nullptr), "view is NULL");
  rejected(dermis_view_record(view, nullptr), "dermis_view_record: frame is NULL");
  const dermis_frame frame = host.frame_at(1);
  uint32_t count = 0;
  const dermis_command* commands = nullptr;
  rejected(dermis_view_commands(view, nullptr, &count, &commands), "frame is NULL");
  rejected(dermis_view_commands(view, &frame, nullptr, &commands), "count is NULL");
  rejected(dermis_view_commands(view, &frame, &count, nullptr), "commands is NULL");
  dermis_frame wrong = frame;
  wrong.bindings = nullptr;
  rejected(dermis_view_commands(view, &wrong, &count, &commands),
           "dermis_view_commands: nothing is bound");
  rejected(dermis_view_record(view, &wrong), "dermis_view_record: nothing is bound");
  wrong.exposure = -1;
  rejected(dermis_view_commands(view, &wrong, &count, &commands), "dermis_view_commands: exposure");
  rejected(dermis_view_report(view, 0, nullptr), "report is NULL");
  rejected(dermis_view_statistics(view, 0, nullptr), "statistics is NULL");
  EXPECT_EQ(dermis_graph_view(nullptr), nullptr);
  rejected(dermis_graph_calibration(nullptr, nullptr, nullptr), "graph is NULL");
  rejected(dermis_graph_heaps(nullptr, nullptr, nullptr), "graph is NULL");
  rejected(dermis_register_pass_type(host.context, nullptr), "type is NULL");
  dermis_report report = nullptr;
  ASSERT_EQ(dermis_graph_set_setting(host.graph, "samples", "{}", &report), DERMIS_ERROR_CONFIG);
  rejected(dermis_report_message(report, 0, nullptr), "message is NULL");
  dermis_message message = DERMIS_MESSAGE_INIT;
  rejected(dermis_report_message(report, dermis_report_count(report), &message), "index is 1");
  dermis_report_destroy(report);
  demo::ReportedFrame choice;
  EXPECT_EQ(demo::read_reported(dermis_graph_view(host.graph), 0, choice), DERMIS_NOT_READY)
      << "no frame was recorded";
  rejected(dermis_view_discard(dermis_graph_view(host.graph), 0), "no frame can be discarded");
}

TEST_F(Fields, Budget_WrongTablesChangeNothing) {
  ASSERT_OK(host.make_graph());
  const std::string broken = "{ \"dermis_errors\": 2, }";
  const dermis_source bad = source_of(broken, nullptr);
  const dermis_source empty = DERMIS_SOURCE_INIT;
  for (const dermis_source* dermis_budget::*table :
       {&dermis_budget::errors, &dermis_budget::calibration}) {
    const std::string name = table == &dermis_budget::errors ? "errors" : "calibration";
    dermis_budget budget = DERMIS_BUDGET_INIT;
    budget.milliseconds = 1;
    budget.*table = &empty;
    EXPECT_THAT(dermis_graph_set_budget(host.graph, &budget, nullptr),
                Fails(DERMIS_ERROR_ARGUMENT, "dermis_graph_set_budget: " + name + ".text is NULL"));
    budget.*table = &bad;
    EXPECT_THAT(dermis_graph_set_budget(host.graph, &budget, nullptr),
                Fails(DERMIS_ERROR_CONFIG, name + ":1:"));
  }
}

// Gives each setting of a graph with all types of settings a value of a wrong type or range.
TEST_F(Fields, Settings_OnlyTypeAndRangeAreAccepted) {
  const std::string text = R"({ "dermis": 2, "name": "settings",
    "settings": { "on": { "bool": true }, "count": { "int": 4, "min": 1, "max": 9 },
                  "share": { "real": 0.5, "min": 0, "max": 1 },
                  "how": { "enum": ["fast", "good"], "default": "fast" } },
    "imports": { "light": { "format": "rgba16f", "size": "view" } }, "passes": [], "exports": ["light"] })";
  dermis_graph_desc desc = graph_desc(text, "settings.json", 16);
  dermis_report report = nullptr;
  ASSERT_OK(dermis_graph_create(host.context, &desc, &host.graph, &report))
      << dermis_report_text(report);
  dermis_report_destroy(report);
  struct Case {
    const char *name, *json, *said; // `said` is null if the value is accepted.
  };
  const Case cases[] = {
      {"on", "false", nullptr},
      {"on", "0", "expects true or false, found 0"},
      {"count", "9", nullptr},
      {"count", "10", "expects an integer in 1..9, found 10"},
      {"count", "0", "expects an integer in 1..9, found 0"},
      {"count", "2.5", "expects an integer, found 2.5"},
      {"count", "\"4\"", "expects an integer"},
      {"count", "4,", "setting count:1:2"},
      {"share", "1", nullptr},
      {"share", "0.25", nullptr},
      {"share", "1.5", "expects a number in 0..1, found 1.5"},
      {"share", "-1e-3", "expects a number in 0..1, found -1e-3"},
      {"share", "true", "expects a number, found true"},
      {"how", "\"good\"", nullptr},
      {"how", "\"best\"", "expects one of \"fast\", \"good\", found \"best\""},
      {"how", "1", "expects a string, found 1"},
      {"how", "", "setting how:1:1"},
      {"on", "[", "setting on:1:"},
  };
  for (const Case& one : cases) {
    const dermis_result result = dermis_graph_set_setting(host.graph, one.name, one.json, nullptr);
    EXPECT_EQ(result, one.said == nullptr ? DERMIS_OK : DERMIS_ERROR_CONFIG)
        << one.name << " = " << one.json;
    if (one.said != nullptr) {
      EXPECT_THAT(dermis_last_error(), HasSubstr(one.said));
    }
  }
  EXPECT_THAT(dermis_graph_set_setting(host.graph, "hwo", "1", nullptr),
              Fails(DERMIS_ERROR_ARGUMENT, "it has 'on', 'count', 'share', 'how'"));
}

} // namespace
} // namespace dermis::abi_test
