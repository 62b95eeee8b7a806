// Tests host-recorded passes: the call's arguments, the call order, and every rejected declaration.

#include "tests/integration/abi/dermis_fixture.hpp"

namespace dermis::abi_test {
namespace {

struct Call {
  std::string pass;
  std::vector<dermis_pass_port> ports;
  std::vector<double> settings;
  uint32_t width = 0, height = 0;
  uint64_t frame_index = 0;
  VkCommandBuffer commands = VK_NULL_HANDLE;
};

void DERMIS_CALL keep(void* user, const dermis_pass_call* call) {
  Call kept;
  kept.pass = call->pass;
  kept.ports.assign(call->ports, call->ports + call->port_count);
  kept.settings.assign(call->settings, call->settings + call->setting_count);
  kept.width = call->rect_width;
  kept.height = call->rect_height;
  kept.frame_index = call->frame_index;
  kept.commands = call->command_buffer;
  static_cast<std::vector<Call>*>(user)->push_back(kept);
}

const std::string graph_text = R"({
  "dermis": 2, "name": "bloom",
  "settings": { "level": { "real": 0.5, "min": 0, "max": 4 } },
  "imports": { "lighting": { "format": ["rgba16f"], "size": "view" } },
  "resources": { "bright": { "format": "rgba16f", "size": "view/2" }, "sums": { "buffer": { "stride": 4, "count": [4, 1] } } },
  "passes": [
    { "pass": "threshold", "type": "studio.threshold", "read": { "light": "lighting" },
      "write": { "bright": "bright", "sums": "sums" }, "set": { "level": "$level", "taps": 5 } },
    { "pass": "add", "type": "studio.add", "read": { "bright": "bright", "sums": "sums" }, "write": { "onto": "lighting" } } ],
  "exports": ["lighting"] })";

struct HostPassTypes : DermisTest {
  void SetUp() override {
    DermisTest::SetUp();
    if (IsSkipped()) return;
    own_context(context_desc()); // pass types stay registered
    threshold_ports = {port_of("light"), port_of("bright", DERMIS_PORT_STORAGE_IMAGE_WRITE),
                       port_of("sums", DERMIS_PORT_STORAGE_BUFFER_WRITE),
                       port_of("mask", DERMIS_PORT_SAMPLED_IMAGE, true)};
    add_ports = {port_of("bright", DERMIS_PORT_SAMPLED_IMAGE),
                 port_of("sums", DERMIS_PORT_STORAGE_BUFFER_READ),
                 port_of("onto", DERMIS_PORT_STORAGE_IMAGE_UPDATE)};
    dermis_pass_setting taps = DERMIS_PASS_SETTING_INIT;
    taps.name = "taps";
    taps.type = DERMIS_PASS_SETTING_INT;
    taps.default_value = taps.minimum = 3;
    taps.maximum = 25;
    settings = {real_setting("level", 4), taps};
  }

  dermis_pass_type type(const char* name, const std::vector<dermis_port>& ports) {
    return pass_type_of(name, ports, keep, &calls);
  }

  void register_both() {
    dermis_pass_type threshold = type("studio.threshold", threshold_ports);
    threshold.settings = settings.data();
    threshold.setting_count = 2;
    const dermis_pass_type add = type("studio.add", add_ports);
    ASSERT_OK(dermis_register_pass_type(context, &threshold));
    ASSERT_OK(dermis_register_pass_type(context, &add));
  }

  dermis_graph bloom() { return make_graph(own_graph(graph_text)); }

  dermis_graph bloom_with_images() {
    const dermis_graph graph = make_bound_graph(own_graph(graph_text));
    bound = bindings(graph);
    return graph;
  }

  void expect_rejected(const dermis_pass_type& wrong, const char* why) {
    EXPECT_THAT(dermis_register_pass_type(context, &wrong), Fails(DERMIS_ERROR_ARGUMENT, why));
  }

  std::vector<dermis_port> threshold_ports, add_ports;
  std::vector<dermis_pass_setting> settings;
  std::vector<Call> calls;
  std::vector<dermis_image_binding> bound;
};

TEST_F(HostPassTypes, AreCalledInPlanOrderWithTheirBindings) {
  register_both();
  const dermis_graph graph = bloom_with_images();
  dermis_frame one = frame(bound);
  ASSERT_OK(record(graph, one));
  ASSERT_EQ(calls.size(), 2u);
  const Call& threshold = calls[0];
  EXPECT_EQ(threshold.pass, "threshold");
  EXPECT_THAT(threshold.settings, ElementsAre(0.5, 5.0));
  EXPECT_EQ(threshold.commands, one.command_buffer);
  EXPECT_EQ(threshold.frame_index, one.frame_index);
  EXPECT_EQ(threshold.width, 64u);
  ASSERT_EQ(threshold.ports.size(), 4u);
  EXPECT_EQ(threshold.ports[0].image, bound[0].image) << "the host's own";
  EXPECT_EQ(threshold.ports[0].view, bound[0].view);
  EXPECT_EQ(threshold.ports[1].layout, VK_IMAGE_LAYOUT_GENERAL);
  EXPECT_EQ(threshold.ports[1].format, VK_FORMAT_R16G16B16A16_SFLOAT);
  EXPECT_EQ(threshold.ports[1].width, 32u);
  EXPECT_NE(threshold.ports[1].view, nullptr);
  EXPECT_NE(threshold.ports[2].buffer, nullptr);
  EXPECT_EQ(threshold.ports[2].bytes, 16u);
  EXPECT_EQ(threshold.ports[3].image, nullptr) << "an optional port that nothing is bound to";
  const Call& add = calls[1];
  EXPECT_EQ(add.pass, "add");
  EXPECT_EQ(add.ports[0].image, threshold.ports[1].image);
  EXPECT_EQ(add.ports[1].buffer, threshold.ports[2].buffer);
  EXPECT_EQ(add.ports[2].image, bound[0].image);
  EXPECT_EQ(add.ports[2].layout, VK_IMAGE_LAYOUT_GENERAL);
}

TEST_F(HostPassTypes, SeeASettingChangeAtTheNextRecord) {
  register_both();
  const dermis_graph graph = bloom_with_images();
  ASSERT_OK(dermis_graph_set_setting(graph, "level", "2.5", nullptr));
  dermis_frame one = frame(bound);
  ASSERT_OK(record(graph, one));
  EXPECT_THAT(calls.at(0).settings, ElementsAre(2.5, 5.0));
}

TEST_F(HostPassTypes, AreTimedLikeAllPasses) {
  register_both();
  const dermis_graph graph = bloom_with_images();
  dermis_frame one = frame(bound);
  ASSERT_OK(record(graph, one));
  std::array<dermis_pass_timing, 4> timings;
  timings.fill(DERMIS_PASS_TIMING_INIT);
  uint32_t count = 4;
  ASSERT_OK(dermis_view_timings(dermis_graph_view(graph), one.frame_index, &count, timings.data()));
  ASSERT_EQ(count, 2u);
  EXPECT_STREQ(timings[1].pass, "add");
}

TEST_F(HostPassTypes, SurviveAReload) {
  register_both();
  const dermis_graph graph = bloom_with_images();
  dermis_frame one = frame(bound);
  ASSERT_OK(record(graph, one));
  ASSERT_OK(reload_text(graph, source_of(graph_text, "bloom.json")));
  dermis_frame two = frame(bound);
  ASSERT_OK(record(graph, two));
  EXPECT_EQ(calls.size(), 4u);
}

TEST_F(HostPassTypes, UnregisteredType_IsAnErrorOfTheGraph) {
  dermis_graph graph = nullptr;
  dermis_report report = nullptr;
  GraphOptions options;
  options.text = graph_text;
  EXPECT_EQ(create_graph(options, &graph, &report), DERMIS_ERROR_CONFIG);
  EXPECT_THAT(take(report).names, Contains("unknown_pass_type"));
}

TEST_F(HostPassTypes, WrongField_IsNamed) {
  dermis_pass_type wrong = type("bloom", add_ports);
  expect_rejected(wrong, "type.name is 'bloom'");
  wrong.name = nullptr;
  expect_rejected(wrong, "type.name is ''");
  wrong.name = "subsurface.mine";
  expect_rejected(wrong, "are reserved for the library");
  wrong = type("studio.add", add_ports);
  wrong.record = nullptr;
  expect_rejected(wrong, "type.record is NULL");
  wrong = type("studio.add", add_ports);
  wrong.port_count = 0;
  expect_rejected(wrong, "type.ports has 0 entries, expected 1..32");
  wrong.port_count = 33;
  expect_rejected(wrong, "type.port_count is 33");
  wrong.port_count = 1;
  wrong.ports = nullptr;
  expect_rejected(wrong, "type.ports is NULL");
  auto ports = add_ports;
  ports[1].name = "bright";
  expect_rejected(type("studio.add", ports), "have the same name 'bright'");
  ports[1].name = "a b";
  expect_rejected(type("studio.add", ports), "ports[1].name is 'a b'");
  ports = add_ports;
  ports[2].usage = static_cast<dermis_port_usage>(7);
  expect_rejected(type("studio.add", ports), "type.ports[2].usage is 7");
  ports[0].struct_size = 4;
  expect_rejected(type("studio.add", ports), "struct_size");
  wrong = type("studio.add", add_ports);
  auto values = settings;
  wrong.settings = values.data();
  wrong.setting_count = 2;
  values[0].default_value = 5.0;
  expect_rejected(wrong, "settings[0]: expected");
  values = settings;
  values[1].default_value = 3.5;
  expect_rejected(wrong, "settings[1] is an int");
  EXPECT_THAT(dermis_register_pass_type(context, nullptr),
              Fails(DERMIS_ERROR_ARGUMENT, "dermis_register_pass_type: type is NULL"));
  EXPECT_EQ(dermis_register_pass_type(nullptr, &wrong), DERMIS_ERROR_ARGUMENT);
}

TEST_F(HostPassTypes, MustBeRegisteredOnceBeforeTheFirstGraph) {
  register_both();
  expect_rejected(type("studio.add", add_ports), "there is a pass type 'studio.add' already");
  bloom();
  expect_rejected(type("studio.late", add_ports), "has graphs already");
}

TEST_F(HostPassTypes, AreExportedForTools) {
  register_both();
  size_t size = 0;
  ASSERT_OK(dermis_export_pass_types(context, &size, nullptr));
  std::string text(size, '?');
  size_t less = size - 1;
  EXPECT_EQ(dermis_export_pass_types(context, &less, text.data()), DERMIS_INCOMPLETE);
  EXPECT_EQ(less, size);
  ASSERT_OK(dermis_export_pass_types(context, &size, text.data()));
  EXPECT_THAT(text, HasAll("\"studio.threshold\"", "storage_buffer_write"));
  EXPECT_EQ(dermis_export_pass_types(context, nullptr, nullptr), DERMIS_ERROR_ARGUMENT);
  EXPECT_EQ(dermis_export_pass_types(nullptr, &size, nullptr), DERMIS_ERROR_ARGUMENT);
}

TEST_F(HostPassTypes, UpdateInPlaceNeedsOwnTexels) {
  std::vector<dermis_port> ports = {port_of("light"),
                                    port_of("result", DERMIS_PORT_STORAGE_IMAGE_WRITE)};
  const dermis_pass_type blur = type("studio.blur", ports);
  ASSERT_OK(dermis_register_pass_type(context, &blur));
  ports[0].own_texels = 1;
  const dermis_pass_type fade = type("studio.fade", ports);
  ASSERT_OK(dermis_register_pass_type(context, &fade));
  const auto options_of = [](const std::string& name) {
    return own_graph(R"({ "dermis": 2, "name": "g",
      "imports": { "lighting": { "format": "rgba16f", "size": "view" } }, "passes": [
        { "pass": "change", "type": ")" +
                     name +
                     R"(", "read": { "light": "lighting" }, "write": { "result": "lighting" } } ],
      "exports": ["lighting"] })");
  };
  dermis_graph rejected = nullptr;
  EXPECT_NE(create_graph(options_of("studio.blur"), &rejected), DERMIS_OK);
  EXPECT_THAT(dermis_last_error(), HasSubstr("D0232"));
  EXPECT_NE(make_graph(options_of("studio.fade")), nullptr);
  size_t size = 0;
  ASSERT_OK(dermis_export_pass_types(context, &size, nullptr));
  std::string text(size, '?');
  ASSERT_OK(dermis_export_pass_types(context, &size, text.data()));
  EXPECT_THAT(text, HasSubstr("\"own_texels\": true"));
}

TEST_F(HostPassTypes, OnlyWritersOrderInternally) {
  for (const dermis_port_usage usage :
       {DERMIS_PORT_SAMPLED_IMAGE, DERMIS_PORT_STORAGE_BUFFER_READ,
        DERMIS_PORT_STORAGE_IMAGE_UPDATE, DERMIS_PORT_STORAGE_BUFFER_UPDATE}) {
    std::vector<dermis_port> ports = {port_of("levels", usage)};
    ports[0].internally_ordered = 1;
    const dermis_pass_type wrong = type("studio.wrong", ports);
    EXPECT_EQ(dermis_register_pass_type(context, &wrong), DERMIS_ERROR_ARGUMENT);
    EXPECT_THAT(dermis_last_error(), HasSubstr("ports[0] ('levels') declares internally_ordered"));
  }
  std::vector<dermis_port> ports = {port_of("levels", DERMIS_PORT_STORAGE_IMAGE_WRITE),
                                    port_of("sums", DERMIS_PORT_STORAGE_BUFFER_WRITE)};
  for (dermis_port& port : ports)
    port.internally_ordered = 1;
  const dermis_pass_type right = type("studio.levels", ports);
  ASSERT_OK(dermis_register_pass_type(context, &right));
  size_t size = 0;
  ASSERT_OK(dermis_export_pass_types(context, &size, nullptr));
  std::string text(size, '?');
  ASSERT_OK(dermis_export_pass_types(context, &size, text.data()));
  EXPECT_THAT(text, HasSubstr("\"internally_ordered\": true"));
}

} // namespace
} // namespace dermis::abi_test
