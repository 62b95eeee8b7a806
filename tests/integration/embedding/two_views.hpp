#pragma once
// Two views of one graph with frames of equal numbers, so that their pictures only differ because
// of their inputs.

#include "tests/integration/abi/dermis_fixture.hpp"

namespace dermis::abi_test {

struct TwoViewsTest : DermisTest {
  dermis_graph graph = nullptr;
  dermis_view other = nullptr; // The second view; the first view is the graph's own.

  void TearDown() override {
    dermis_view_destroy(other);
    DermisTest::TearDown();
  }

  // Makes a square view. Of the optional slots only `bound` is bound; all `profiles` are one skin.
  void make(const std::string& text, const std::vector<std::string>& overlays, uint32_t side,
            const std::string& bound = "", uint32_t profiles = 1) {
    GraphOptions options;
    options.text = text;
    options.overlays = overlays;
    options.width = options.height = side;
    options.profile_count = profiles;
    options.unbound.clear();
    for (const char* name : {"albedo", "scatter_scale", "scattered_light", "importance", "velocity",
                             "thickness", "back_lighting", "sampling", "guidance"})
      if (text.find('"' + std::string(name) + '"') != std::string::npos && name != bound)
        options.unbound.emplace_back(name);
    if (!overlays.empty() && bound != "velocity") options.unbound.emplace_back("velocity");
    graph = make_graph(options);
    ASSERT_EQ(dermis_view_create(graph, nullptr, &other, nullptr), DERMIS_OK)
        << dermis_last_error();
    make_images(graph);
  }

  // Records frame `index` of a view, or of the graph's own view if `view` is null; submits and
  // waits.
  void record_in(dermis_view view, dermis_frame& frame, uint64_t index) {
    frame.frame_index = index;
    frame.completed_frame_index = index - 1;
    const auto ran = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
      frame.command_buffer = commands;
      EXPECT_EQ(view == nullptr ? dermis_view_record(dermis_graph_view(graph), &frame)
                                : dermis_view_record(view, &frame),
                DERMIS_OK)
          << dermis_last_error();
      return demo::success();
    });
    EXPECT_TRUE(ran) << ran.error().text;
  }
};

} // namespace dermis::abi_test
