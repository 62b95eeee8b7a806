// Tests settings of a host: listed with types, ranges and values, and read back.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <algorithm>
#include <map>

namespace dermis::abi_test {
namespace {

// Stores the settings of the call's pass under its name.
using Calls = std::map<std::string, std::vector<double>>;
void DERMIS_CALL keep(void* user, const dermis_pass_call* call) {
  (*static_cast<Calls*>(user))[call->pass].assign(call->settings,
                                                  call->settings + call->setting_count);
}

// Registers two pass types of the host. Only "weight" of studio.mix can change per frame.
dermis_result register_pass_types(dermis_context context, Calls& calls) {
  dermis_port port = port_of("picture", DERMIS_PORT_STORAGE_IMAGE_UPDATE);
  dermis_pass_setting values[2] = {real_setting("weight", 1), real_setting("radius", 1)};
  values[0].per_frame = 1;
  dermis_pass_type type = pass_type_of("studio.mix", {&port, 1}, keep, &calls);
  type.settings = values;
  type.setting_count = 2;
  return dermis_register_pass_type(context, &type);
}

const std::string graph_text = R"({ "dermis": 2, "name": "settings",
  "settings": {
    "on": { "bool": true },
    "count": { "int": 4, "min": 1, "max": 9, "unit": "samples", "note": "a pixel" },
    "how": { "enum": ["fast", "good", "best"], "default": "good" },
    "weight": { "real": 0.5, "min": 0, "max": 1 },
    "radius": { "real": 0.25, "min": 0, "max": 1 },
    "both": { "real": 0.5, "min": 0, "max": 1 },
    "threshold": { "real": 0.5, "min": 0, "max": 1 } },
  "imports": { "light": { "format": "rgba16f", "size": "view" } },
  "passes": [
    { "pass": "one", "type": "studio.mix", "write": { "picture": "light" },
      "set": { "weight": "$weight", "radius": "$radius" } },
    { "pass": "two", "type": "studio.mix", "write": { "picture": "light" },
      "set": { "weight": "$both", "radius": "$both" } },
    { "pass": "three", "type": "studio.mix", "write": { "picture": "light" }, "when": "threshold > 0.1",
      "set": { "weight": "$threshold" } } ],
  "exports": ["light"] })";

std::vector<dermis_setting> settings_of(dermis_view view) {
  return list_of(dermis_setting DERMIS_SETTING_INIT, dermis_view_settings, view);
}
std::vector<dermis_setting> settings_of(dermis_graph graph) {
  return settings_of(dermis_graph_view(graph));
}

dermis_setting named(const std::vector<dermis_setting>& all, std::string_view name) {
  const auto found =
      std::ranges::find_if(all, [&](const dermis_setting& one) { return one.name == name; });
  EXPECT_NE(found, all.end()) << name;
  return found != all.end() ? *found : dermis_setting DERMIS_SETTING_INIT;
}

struct Settings : ::testing::Test {
  Calls calls;
  NullHost host;
  dermis_view view = nullptr;
  void SetUp() override { ASSERT_OK(host.make_context(host.context_desc())); }
  void make(const std::string& text) {
    ASSERT_OK(register_pass_types(host.context, calls));
    dermis_graph_desc desc = graph_desc(text, "graph.json", 16);
    dermis_profile profile = skin_profile();
    desc.profiles = &profile;
    desc.profile_count = 1;
    dermis_report report = nullptr;
    ASSERT_OK(dermis_graph_create(host.context, &desc, &host.graph, &report))
        << dermis_report_text(report);
    dermis_report_destroy(report);
  }
  void make_with_view() {
    make(graph_text);
    ASSERT_OK(dermis_view_create(host.graph, nullptr, &view, nullptr));
    host.make_bindings();
  }
  // Returns the weight that passes of the next frame receive.
  double weight_of_graph(const char* pass) {
    EXPECT_OK(host.record());
    return calls.at(pass).front();
  }
  double weight_of_view(const char* pass) {
    EXPECT_OK(host.record(view, ++view_frame));
    return calls.at(pass).front();
  }
  void set_for_view(const char* name, const char* json) const {
    ASSERT_OK(dermis_view_set_setting(view, name, json, nullptr));
  }
  uint64_t view_frame = 0;
  void set(const char* name, const char* json) const {
    ASSERT_OK(dermis_graph_set_setting(host.graph, name, json, nullptr));
  }
};

TEST_F(Settings, AreListedWithTypeRangeUnitAndOptions) {
  make(graph_text);
  const auto all = settings_of(host.graph);
  ASSERT_EQ(all.size(), 7u);
  EXPECT_STREQ(all[0].name, "on") << "in the order of the file";
  EXPECT_EQ(all[0].type, DERMIS_SETTING_BOOL);
  EXPECT_EQ(all[0].maximum, 1.0);
  EXPECT_EQ(all[0].default_value, 1.0);
  EXPECT_EQ(all[0].options, nullptr);
  const dermis_setting count = named(all, "count");
  EXPECT_EQ(count.type, DERMIS_SETTING_INT);
  EXPECT_EQ(count.minimum, 1.0);
  EXPECT_EQ(count.maximum, 9.0);
  EXPECT_EQ(count.value, 4.0);
  EXPECT_STREQ(count.unit, "samples");
  EXPECT_STREQ(count.note, "a pixel");
  const dermis_setting how = named(all, "how");
  EXPECT_EQ(how.type, DERMIS_SETTING_OPTION);
  ASSERT_EQ(how.option_count, 3u);
  EXPECT_STREQ(how.options[2], "best");
  EXPECT_EQ(how.maximum, 2.0);
  EXPECT_EQ(how.default_value, 1.0);
  const dermis_setting weight = named(all, "weight");
  EXPECT_EQ(weight.type, DERMIS_SETTING_REAL);
  EXPECT_STREQ(weight.unit, "");
  EXPECT_STREQ(weight.note, "");
}

TEST_F(Settings, OptionThatIsNotOffered_IsReplacedAtOnce) {
  std::string text = graph_text;
  const std::string options = R"("enum": ["fast", "good", "best"], "default": "good")";
  text.replace(text.find(options), options.size(),
               R"("choice": ["fast", "good", "best"], "default": "good",
                  "requires": { "best": ["ray_query"] })");
  make(text);
  set("how", "\"fast\"");
  dermis_report report = nullptr;
  ASSERT_OK(dermis_graph_set_setting(host.graph, "how", "\"best\"", &report));
  EXPECT_THAT(dermis_report_text(report),
              AllOf(HasSubstr("does not offer 'best'"), HasSubstr("'good' runs instead")));
  dermis_report_destroy(report);
  EXPECT_EQ(named(settings_of(host.graph), "how").value, 1.0);
}

TEST_F(Settings, ReadBackAsSet) {
  make(graph_text);
  set("on", "false");
  set("count", "7");
  set("how", "\"best\"");
  set("weight", "0.125");
  EXPECT_EQ(dermis_graph_set_setting(host.graph, "radius", "2", nullptr), DERMIS_ERROR_CONFIG);
  const auto all = settings_of(host.graph);
  EXPECT_EQ(named(all, "on").value, 0.0);
  EXPECT_EQ(named(all, "count").value, 7.0);
  EXPECT_EQ(named(all, "count").default_value, 4.0);
  EXPECT_EQ(named(all, "how").value, 2.0);
  EXPECT_EQ(named(all, "weight").value, 0.125);
  EXPECT_EQ(named(all, "radius").value, 0.25) << "a rejected value is not stored";
  EXPECT_EQ(named(all, "weight").set, 1u);
  EXPECT_EQ(named(all, "radius").set, 0u);
}

TEST_F(Settings, PerFrame_OnlyIfAllUsesArePerFrame) {
  make(graph_text);
  std::vector<std::string> per_frame;
  for (const dermis_setting& one : settings_of(host.graph))
    if (one.per_frame != 0) per_frame.emplace_back(one.name);
  EXPECT_THAT(per_frame, ElementsAre("weight"))
      << "radius and both change the plan, threshold enables passes, the others have no effect";
}

TEST_F(Settings, ShippedGraph_ReportsViewSettings) {
  ASSERT_OK(host.make_graph());
  const auto all = settings_of(host.graph);
  EXPECT_EQ(named(all, "accumulate_weight").per_frame, 1u);
  EXPECT_EQ(named(all, "accumulate_clip").per_frame, 1u);
  EXPECT_EQ(named(all, "samples").per_frame, 0u);
  EXPECT_EQ(named(all, "texturing").per_frame, 0u);
}

TEST_F(Settings, ChosenValues_AreReportedUntilTheHostSetsOne) {
  const std::string text = read_text("configs/graphs/skin.json");
  make(text);
  EXPECT_EQ(named(settings_of(host.graph), "technique").chosen, 1u);
  set("technique", "\"separable\"");
  const dermis_setting technique = named(settings_of(host.graph), "technique");
  EXPECT_EQ(technique.chosen, 0u);
  EXPECT_EQ(technique.set, 1u);
  EXPECT_STREQ(technique.options[static_cast<size_t>(technique.value)], "separable");
}

TEST_F(Settings, WithoutAValue_TheBudgetChoosesAgain) {
  make(read_text("configs/graphs/skin.json"));
  const dermis_setting before = named(settings_of(host.graph), "technique");
  set("technique", "\"separable\"");
  set("technique", nullptr);
  const dermis_setting after = named(settings_of(host.graph), "technique");
  EXPECT_EQ(after.chosen, 1u);
  EXPECT_EQ(after.set, 0u);
  EXPECT_EQ(after.value, before.value);
}

TEST_F(Settings, WithoutAValue_TheDefaultApplies) {
  make(graph_text);
  host.make_bindings();
  set("weight", "0.75");
  EXPECT_EQ(weight_of_graph("one"), 0.75);
  set("weight", nullptr);
  EXPECT_EQ(weight_of_graph("one"), 0.5);
  EXPECT_EQ(named(settings_of(host.graph), "weight").set, 0u);
  set("threshold", "0.05"); // the pass is off
  EXPECT_OK(host.record());
  calls.clear();
  set("threshold", nullptr);
  EXPECT_EQ(weight_of_graph("three"), 0.5);
  EXPECT_THAT(dermis_graph_set_setting(host.graph, "none", nullptr, nullptr),
              Fails(DERMIS_ERROR_ARGUMENT, "has no setting 'none'"));
}

TEST_F(Settings, ValueOfAnEarlierGraph_CanBeRemoved) {
  make(graph_text);
  host.make_bindings();
  set("weight", "0.75");
  ASSERT_OK(
      host.reload(replaced(replaced(graph_text, R"("weight": { "real")", R"("heft": { "real")"),
                           R"("$weight")", R"("$heft")")));
  set("weight", nullptr);
  ASSERT_OK(host.reload(graph_text));
  EXPECT_EQ(weight_of_graph("one"), 0.5);
}

TEST_F(Settings, PerFrame_ViewsHaveSeparateValues) {
  make_with_view();
  set_for_view("weight", "0.75");
  EXPECT_EQ(weight_of_view("one"), 0.75);
  EXPECT_EQ(weight_of_graph("one"), 0.5);
  set("weight", "0.25");
  EXPECT_EQ(weight_of_view("one"), 0.75) << "the view's own value stays";
  EXPECT_EQ(weight_of_graph("one"), 0.25);
  EXPECT_EQ(named(settings_of(view), "weight").value, 0.75);
  EXPECT_EQ(named(settings_of(view), "weight").set, 2u);
  EXPECT_EQ(named(settings_of(host.graph), "weight").value, 0.25);
  EXPECT_EQ(named(settings_of(host.graph), "weight").set, 1u);
  set_for_view("weight", nullptr);
  EXPECT_EQ(weight_of_view("one"), 0.25);
  EXPECT_EQ(named(settings_of(view), "weight").set, 1u);
}

TEST_F(Settings, ViewSettings_SurviveAReloadThatAcceptsThem) {
  make_with_view();
  set_for_view("weight", "0.75");
  ASSERT_OK(host.reload(graph_text));
  EXPECT_EQ(weight_of_view("one"), 0.75);
  set("threshold", "0.05"); // Turns a pass off, so the graph is rebuilt.
  EXPECT_EQ(weight_of_view("one"), 0.75);
  const std::string lower = replaced(graph_text, R"("weight": { "real": 0.5, "min": 0, "max": 1 })",
                                     R"("weight": { "real": 0.5, "min": 0, "max": 0.6 })");
  dermis_report report = nullptr;
  ASSERT_OK(reload_text(host.graph, source_of(lower, "graph.json"), &report));
  EXPECT_THAT(dermis_report_text(report),
              HasSubstr("setting 'weight' = 0.75 of a view is not carried over"));
  dermis_report_destroy(report);
  EXPECT_EQ(weight_of_view("one"), 0.5);
  EXPECT_EQ(named(settings_of(view), "weight").set, 0u);
  set("weight", "0.25"); // the graph's value applies, because the view has none
  EXPECT_EQ(weight_of_view("one"), 0.25);
  EXPECT_EQ(named(settings_of(view), "weight").set, 1u);
  ASSERT_OK(host.reload(graph_text));
  EXPECT_EQ(weight_of_view("one"), 0.75) << "this graph accepts the view's value again";
}

TEST_F(Settings, ValueThatWasNotCarriedOver_CanBeRemoved) {
  make_with_view();
  set_for_view("weight", "0.75");
  const std::string fixed =
      replaced(graph_text, R"("when": "threshold > 0.1")", R"("when": "weight > 0.1")");
  ASSERT_OK(host.reload(fixed));
  EXPECT_EQ(weight_of_view("one"), 0.5);
  set_for_view("weight", nullptr);
  EXPECT_THAT(dermis_view_set_setting(view, "weight", nullptr, nullptr),
              Fails(DERMIS_ERROR_ARGUMENT, "belongs to the graph"));
  ASSERT_OK(host.reload(graph_text));
  EXPECT_EQ(weight_of_view("one"), 0.5);
}

TEST_F(Settings, OwnValueOfTheGraphsView_StaysInThatView) {
  make(graph_text);
  host.make_bindings();
  view = dermis_graph_view(host.graph);
  set_for_view("weight", "0.75");
  EXPECT_EQ(weight_of_graph("one"), 0.75);
  ASSERT_OK(host.reload(graph_text));
  EXPECT_EQ(weight_of_graph("one"), 0.75);
  dermis_view other = nullptr;
  ASSERT_OK(dermis_view_create(host.graph, nullptr, &other, nullptr));
  EXPECT_EQ(named(settings_of(other), "weight").value, 0.5);
  EXPECT_EQ(named(settings_of(other), "weight").set, 0u);
  std::swap(view, other);
  set_for_view("weight", "0.25");
  set_for_view("weight", nullptr);
  EXPECT_EQ(named(settings_of(view), "weight").value, 0.5);
  std::swap(view, other);
  set("weight", "0.125");
  EXPECT_EQ(weight_of_graph("one"), 0.75);
  set_for_view("weight", nullptr);
  EXPECT_EQ(weight_of_graph("one"), 0.125);
}

TEST_F(Settings, GraphSetting_IsRejectedForAView) {
  make_with_view();
  for (const char* name : {"on", "count", "how", "radius", "both", "threshold"}) {
    EXPECT_THAT(dermis_view_set_setting(view, name, "1", nullptr),
                Fails(DERMIS_ERROR_ARGUMENT,
                      "setting '" + std::string(name) + "' belongs to the graph",
                      "A view can have its own value of 'weight'"))
        << name;
  }
  EXPECT_THAT(dermis_view_set_setting(view, "wieght", "1", nullptr),
              Fails(DERMIS_ERROR_ARGUMENT, "has no setting 'wieght'"));
  EXPECT_EQ(dermis_view_set_setting(view, "weight", "1.5", nullptr), DERMIS_ERROR_CONFIG);
  EXPECT_THAT(dermis_view_set_setting(view, nullptr, "1", nullptr),
              Fails(DERMIS_ERROR_ARGUMENT, "name is NULL"));
  EXPECT_THAT(dermis_view_set_setting(nullptr, "weight", "1", nullptr),
              Fails(DERMIS_ERROR_ARGUMENT, "view is NULL"));
}

// The null device reports 0 for each pass, so learned times show at once.
TEST(SettingsOnANullDevice, AnimatedSetting_TimesAreLearned) {
  NullHost host;
  ASSERT_OK(host.start());
  const std::string before = text_from(dermis_graph_calibration, host.graph);
  for (int frame = 0; frame < 10; ++frame) {
    const std::string weight = std::to_string(0.5 + 0.001 * frame);
    ASSERT_OK(dermis_view_set_setting(dermis_graph_view(host.graph), "accumulate_weight",
                                      weight.c_str(), nullptr));
    ASSERT_OK(host.record());
  }
  EXPECT_FALSE(text_from(dermis_graph_calibration, host.graph) == before);
}

} // namespace
} // namespace dermis::abi_test
