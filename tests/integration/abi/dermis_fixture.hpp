#pragma once
// A device under validation, a context and small G-buffers for tests of the C interface. Every
// message of the validation layer fails the test.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "integration/examples/demo_engine/vulkan_image.hpp"
#include "tests/integration/abi/sources.hpp"

#include <dermis/dermis.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dermis::abi_test {

// Copies a report, so that tests need not destroy it.
struct Said {
  std::vector<std::string> names, texts;
  std::vector<std::pair<uint32_t, uint32_t>> places; // Line, column.
  std::string all;
};
Said take(dermis_report report);

struct GraphOptions {
  std::string text; // Empty: configs/graphs/burley.json.
  uint32_t width = 64, height = 64;
  std::vector<std::string> unbound{"albedo", "scatter_scale", "scattered_light"};
  std::vector<std::pair<std::string, VkFormat>> formats{{"depth", VK_FORMAT_R32_SFLOAT}};
  std::vector<std::string> overlays; // JSON texts.
  dermis_include_fn include = nullptr;
  void* include_user = nullptr;
  bool profiles = true;       // False: no profiles.
  uint32_t profile_count = 1; // Ids from 1 on, all with `profile`.
  std::string profile;        // JSON text; empty: configs/profiles/skin.json.
};

struct DermisTest : ::testing::Test {
  static void SetUpTestSuite();
  static void TearDownTestSuite();
  void SetUp() override;
  void TearDown() override;

  dermis_context_desc context_desc();
  dermis_result create_graph(const GraphOptions& options, dermis_graph* graph,
                             dermis_report* report = nullptr);
  dermis_result reload_graph(dermis_graph graph, const GraphOptions& options,
                             dermis_report* report = nullptr);
  dermis_graph
  // Fails the test on an error; TearDown destroys the graph.
  make_graph(const GraphOptions& options = {});

  // Makes images for every bound slot: light on the left half, profile 1 everywhere, 0.5 m away.
  // `but` is a slot without an image.
  void make_images(dermis_graph graph, std::string_view but = "");
  std::vector<dermis_image_binding> bindings(dermis_graph graph);
  // Returns a frame of an orthographic camera with pixels of `pitch_m` metres; frame_index follows
  // the last frame's.
  dermis_frame frame(const std::vector<dermis_image_binding>& bound, uint32_t width = 64,
                     uint32_t height = 64);
  dermis_result record(dermis_graph graph, dermis_frame& frame); // records, submits and waits
  demo::ReportedFrame run_frame(dermis_graph graph); // one frame of what is bound, and what was chosen for it
  // Gives an image new contents: `value(x, y)` in every channel.
  void upload(const std::string& slot, const std::vector<float>& values); // Channel by channel.
  void fill(const std::string& slot, const std::function<float(uint32_t, uint32_t)>& value);
  std::vector<float> texels(const std::string& slot);

  static std::unique_ptr<demo::VulkanHost> host;
  dermis_context context = nullptr;
  std::vector<dermis_graph> graphs;
  std::map<std::string, demo::Image> images; // By slot.
  std::vector<std::string> logged;           // Texts of the log callback.
  uint64_t last_frame = 0;
};

inline constexpr double pitch_m = 0.0005; // 0.5 mm per pixel: skin's red d is about two pixels.

} // namespace dermis::abi_test
