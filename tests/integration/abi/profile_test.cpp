// Tests profiles that change while a graph runs: pictures match a new graph with the new profile,
// histories continue, and frames in flight keep their profile.

#include "tests/integration/abi/dermis_fixture.hpp"

#include "passes/common/pass_types.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::abi_test {
namespace {

std::string profile_text(const std::string& name) {
  return read_text("configs/profiles/" + name + ".json");
}

struct SetProfile : DermisTest {
  static GraphOptions with(const std::string& graph, const std::string& profile) {
    GraphOptions options = shipped_options(dermis::shipped::graph_file(graph));
    options.profile = profile_text(profile);
    options.unbound = {"albedo",    "scatter_scale", "scattered_light",
                       "thickness", "back_lighting", "velocity"};
    return options;
  }
  static dermis_result set_profile(dermis_graph graph, const std::string& text, uint32_t id = 1,
                                   dermis_report* report = nullptr) {
    const dermis_source source = source_of(text, "profile.json");
    return dermis_graph_set_profile(graph, id, &source, report);
  }
  // Runs frame `index`, whose light and noise are equal for each graph.
  std::vector<float> picture(dermis_graph graph, uint64_t index) {
    make_images(graph);
    const auto bound = bindings(graph);
    last_frame = index - 1;
    dermis_frame one = frame(bound);
    std::ranges::copy(one.clip_from_view, one.previous_clip_from_view); // The camera is at rest.
    for (size_t i = 0; i < 16; i += 5)
      one.view_from_world[i] = one.previous_view_from_world[i] = 1;
    EXPECT_OK(record(graph, one));
    return texels("lighting");
  }
  static uint32_t settles_after(dermis_graph graph, std::string_view history) {
    const auto all = list_of(dermis_history DERMIS_HISTORY_INIT, dermis_view_histories,
                             dermis_graph_view(graph));
    for (const dermis_history& one : all)
      if (one.name == history) return one.settles_after;
    return 0;
  }
};

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, std::abs(double{a[i]} - double{b[i]}));
  return largest;
}

TEST_F(SetProfile, MatchesTheNewGraphsPictures) {
  for (const char* graph_name : {"burley", "separable", "sap"})
    for (const char* profile : {"marble", "skin_dipole", "skin_artist"}) {
      const dermis_graph graph = make_graph(with(graph_name, "skin"));
      const std::vector<float> skin = picture(graph, 1);
      ASSERT_OK(set_profile(graph, profile_text(profile)));
      const std::vector<float> changed = picture(graph, 2);
      const dermis_graph fresh = make_graph(with(graph_name, profile));
      EXPECT_EQ(changed, picture(fresh, 2)) << graph_name << " " << profile;
      EXPECT_NE(changed, skin) << graph_name << " " << profile;
      ASSERT_OK(set_profile(graph, profile_text("skin")));
      const dermis_graph again = make_graph(with(graph_name, "skin"));
      EXPECT_EQ(picture(graph, 3), picture(again, 3)) << graph_name << " " << profile;
    }
}

TEST_F(SetProfile, RecordedFramesKeepTheirProfile) {
  const dermis_graph graph = make_graph(with("burley", "skin")),
                     skin = make_graph(with("burley", "skin")),
                     marble = make_graph(with("burley", "marble"));
  const std::vector<float> expected = picture(skin, 1), later = picture(marble, 2);
  make_images(graph);
  const auto bound = bindings(graph);
  last_frame = 0;
  dermis_frame one = frame(bound);
  const auto ran = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
    one.command_buffer = commands;
    EXPECT_OK(dermis_view_record(dermis_graph_view(graph), &one));
    EXPECT_OK(set_profile(graph, profile_text("marble")));
    return demo::success(); // Submitted after the profile has changed.
  });
  ASSERT_TRUE(ran);
  EXPECT_EQ(texels("lighting"), expected);
  EXPECT_EQ(picture(graph, 2), later);
}

TEST_F(SetProfile, TakesEffectAfterADiscardedFrame) {
  const dermis_graph graph = make_bound_graph(with("burley", "skin")),
                     marble = make_graph(with("burley", "marble"));
  dermis_frame one = bound_frame(graph);
  record_unsubmitted(graph, one);
  ASSERT_OK(set_profile(graph, profile_text("marble")));
  ASSERT_OK(dermis_view_discard(dermis_graph_view(graph), 1));
  EXPECT_EQ(picture(graph, 1), picture(marble, 1));
}

TEST_F(SetProfile, KeepsHistoriesThatConvergeAsStated) {
  constexpr uint64_t changed = 20; // Frames with the old profile.
  GraphOptions skin = with("burley", "skin"), marble = with("burley", "marble");
  skin.overlays = marble.overlays = {read_text("configs/overlays/accumulate.json")};
  const dermis_graph graph = make_graph(skin), fresh = make_graph(marble);
  // Only a running mean, from which settles_after is computed.
  for (const dermis_graph one : {graph, fresh})
    ASSERT_OK(dermis_graph_set_setting(one, "accumulate_clip", "0", nullptr));
  const uint32_t settles = settles_after(graph, "past");
  EXPECT_EQ(settles, 44u) << "0.9^44 is 0.0097, 0.9^43 is 0.0108";
  EXPECT_EQ(settles_after(graph, "past_place"), 1u);
  double before = 0;
  for (uint64_t index = 1; index <= changed; ++index)
    before = largest_difference(picture(graph, index), picture(fresh, index));
  ASSERT_GT(before, 0.05);
  dermis_report report = nullptr;
  ASSERT_OK(set_profile(graph, profile_text("marble"), 1, &report));
  const Said said = take(report);
  EXPECT_THAT(said.names, ElementsAre("profile_settles"));
  EXPECT_THAT(said.texts, Contains(HasSubstr("after 44 frames at most 1 % of history 'past'")));
  const double rounding = 2.0 / 1024; // Half floats near 1, twice.
  for (uint64_t index = changed + 1; index <= changed + settles; ++index) {
    const double now = largest_difference(picture(graph, index), picture(fresh, index));
    if (index == changed + settles / 4) {
      EXPECT_GT(now, 0.1 * before) << "0.9^11 is 0.31";
    }
    if (index == changed + settles) {
      EXPECT_LE(now, 0.01 * before + rounding);
    }
  }
}

TEST_F(SetProfile, FirstAndLastProfile_Recompile) {
  GraphOptions none = with("burley", "skin");
  none.profiles = false;
  const dermis_graph graph = make_graph(none), empty = make_graph(none),
                     skin = make_graph(with("burley", "skin"));
  EXPECT_EQ(picture(graph, 1), picture(empty, 1));
  ASSERT_OK(set_profile(graph, profile_text("skin")));
  EXPECT_EQ(picture(graph, 2), picture(skin, 2));
  ASSERT_OK(set_profile(graph, profile_text("marble"), 7));
  ASSERT_OK(dermis_graph_set_profile(graph, 7, nullptr, nullptr));
  EXPECT_EQ(picture(graph, 3), picture(skin, 3));
  ASSERT_OK(dermis_graph_set_profile(graph, 1, nullptr, nullptr));
  EXPECT_EQ(picture(graph, 4), picture(empty, 4));
}

TEST_F(SetProfile, IsKeptOverAReloadAndForNewViews) {
  const dermis_graph graph = make_graph(with("sap", "skin")),
                     marble = make_graph(with("sap", "marble"));
  ASSERT_OK(set_profile(graph, profile_text("marble")));
  EXPECT_EQ(picture(graph, 1), picture(marble, 1));
  const std::string text = read_text("configs/graphs/sap.json");
  ASSERT_OK(reload_text(graph, source_of(text, "sap.json")));
  EXPECT_EQ(picture(graph, 2), picture(marble, 2));
  dermis_view view = view_of(graph);
  const std::vector<float> expected = picture(marble, 3);
  make_images(graph);
  const auto bound = bindings(graph);
  last_frame = 2;
  dermis_frame one = frame(bound);
  const auto ran = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
    one.command_buffer = commands;
    EXPECT_OK(dermis_view_record(view, &one));
    return demo::success();
  });
  ASSERT_TRUE(ran);
  EXPECT_EQ(texels("lighting"), expected);
}

TEST_F(SetProfile, WrongProfile_IsNamedAndChangesNothing) {
  const dermis_graph graph = make_graph(with("burley", "skin")),
                     skin = make_graph(with("burley", "skin"));
  const auto rejected = [](dermis_result result, const char* said) {
    EXPECT_THAT(result, Fails(DERMIS_ERROR_ARGUMENT, said)) << said;
  };
  const std::string text = profile_text("marble");
  rejected(dermis_graph_set_profile(nullptr, 1, nullptr, nullptr), "graph is NULL");
  rejected(set_profile(graph, text, 0), "id is 0, expected 1..255");
  rejected(set_profile(graph, text, 256), "id is 256, expected 1..255");
  rejected(dermis_graph_set_profile(graph, 2, nullptr, nullptr), "the graph has no profile 2");
  const dermis_source empty = DERMIS_SOURCE_INIT;
  rejected(dermis_graph_set_profile(graph, 1, &empty, nullptr), "source.text is NULL");
  dermis_report report = nullptr;
  EXPECT_EQ(set_profile(graph, "{ \"dermis_profile\": 1 }", 1, &report), DERMIS_ERROR_CONFIG);
  EXPECT_THAT(take(report).all, HasSubstr("profile.json:1:1"));
  EXPECT_EQ(picture(graph, 1), picture(skin, 1));
}

TEST(HistoryWeights, NamePortsAndSettingsOfTheirTypes) {
  const PassTypeRegistry pass_types = subsurface::make_pass_types();
  size_t mixes = 0;
  for (uint32_t k = 0; k < pass_types.size(); ++k)
    for (const HistoryWeight& mix : pass_types[PassTypeId{k}].mixes) {
      ++mixes;
      EXPECT_GE(find_port(pass_types[PassTypeId{k}], mix.port, PortSide::write), 0) << mix.port;
      const int setting = find_setting(pass_types[PassTypeId{k}], mix.setting);
      ASSERT_GE(setting, 0) << mix.setting;
      EXPECT_EQ(pass_types[PassTypeId{k}].settings[static_cast<size_t>(setting)].type,
                SettingType::real);
    }
  EXPECT_GE(mixes, 4u);
}

} // namespace
} // namespace dermis::abi_test
