#pragma once
// A device under validation, a context and small G-buffers for tests of the C interface. Every
// message of the validation layer fails the test.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "integration/examples/demo_engine/vulkan_image.hpp"
#include "tests/integration/abi/sources.hpp"

#include <array>
#include <deque>
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

// Returns the options of a shipped graph.
inline GraphOptions shipped_options(const std::string& path) {
  GraphOptions options;
  options.text = read_text(path);
  return options;
}

// Returns the options of a graph with only required slots, in formats that it declares once.
inline GraphOptions own_graph(const std::string& text) {
  GraphOptions options;
  options.text = text;
  options.unbound.clear();
  options.formats.clear();
  return options;
}

struct DermisTest : ::testing::Test {
  static void SetUpTestSuite();
  static void TearDownTestSuite();
  void SetUp() override;
  void TearDown() override;

  dermis_context_desc context_desc();
  // Uses the context with these flags, which all tests of the suite share: it keeps kernels, which
  // take seconds to compile. SetUp() shares one without flags.
  void share_context(uint32_t flags = 0);
  // Uses a context of this test only.
  void own_context(const dermis_context_desc& desc);
  dermis_result create_graph(const GraphOptions& options, dermis_graph* graph,
                             dermis_report* report = nullptr);
  dermis_result reload_graph(dermis_graph graph, const GraphOptions& options,
                             dermis_report* report = nullptr);
  // Throws on an error; TearDown destroys the graph.
  dermis_graph make_graph(const GraphOptions& options = {});
  dermis_graph make_bound_graph(const GraphOptions& options = {}); // With images at every slot.

  // Makes images for every bound slot: light on the left half, profile 1 everywhere, 0.5 m away.
  // `but` is a slot without an image.
  void make_images(dermis_graph graph, std::string_view but = "");
  std::vector<dermis_image_binding> bindings(dermis_graph graph);
  // Returns a frame of an orthographic camera with pixels of `pitch_m` metres; frame_index follows
  // the last frame's.
  dermis_frame frame(const std::vector<dermis_image_binding>& bound, uint32_t width = 64,
                     uint32_t height = 64);
  // Returns a frame with the present images, whose bindings live as long as the test.
  dermis_frame bound_frame(dermis_graph graph, uint32_t width = 64, uint32_t height = 64);
  dermis_result record(dermis_graph graph, dermis_frame& frame); // Records, submits and waits.
  // Records a frame into a command buffer that is not submitted.
  void record_unsubmitted(dermis_graph graph, dermis_frame& frame);
  // Records a frame and returns its report.
  demo::ReportedFrame record_and_read(dermis_graph graph, dermis_frame& frame);
  demo::ReportedFrame run_frame(dermis_graph graph); // Does both with the present images.
  // Makes a depth buffer of 64 x 64 pixels in device memory; its view has only the depth aspect.
  static demo::Image make_depth_image(VkFormat format, VkImageUsageFlags usage);
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

private:
  void drop_context();
  std::deque<std::vector<dermis_image_binding>> bound_; // By frame.
};

// Sets matrices of a camera at rest.
void rest(dermis_frame& frame);

// Compares all channels except the fourth.
void expect_equal_rgb(const std::vector<float>& texels, const std::vector<float>& expected);

inline constexpr double pitch_m = 0.0005; // 0.5 mm per pixel: skin's red d is about two pixels.

} // namespace dermis::abi_test
