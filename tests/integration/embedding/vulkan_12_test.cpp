// A Vulkan 1.2 device with two extensions gives equal pictures.

#include "tests/integration/embedding/cameras.hpp"

namespace dermis::abi_test {
namespace {

struct Vulkan12 : CameraTest {
  static void SetUpTestSuite() {} // A new host for each device, one after the other.
  static void TearDownTestSuite() {}
  void SetUp() override {}
  void TearDown() override {}

  std::vector<float> light(bool as_vulkan_12) {
    auto made =
        demo::create_vulkan_host({.validation = true, .device = "", .as_vulkan_12 = as_vulkan_12});
    EXPECT_TRUE(made) << made.error().text;
    if (!made) return {};
    host = made.take();
    InFlightTest::SetUp();
    std::vector<float> out;
    {
      const dermis_graph graph = make_accumulating();
      const Camera camera = make_camera(graph, 1);
      for (uint64_t index = 1; index <= 5; ++index) {
        const std::string text = read_text("configs/graphs/burley.json");
        if (index == 3) {
          EXPECT_OK(reload_text(graph, source_of(text, "burley.json")));
        }
        submit(index, [&](VkCommandBuffer into) {
          dermis_frame frame = frame_of(camera, index);
          frame.command_buffer = into;
          ASSERT_OK(dermis_view_record(dermis_graph_view(graph), &frame));
        });
      }
      out = light_of(camera);
    }
    InFlightTest::TearDown(); // No message of the validation layer.
    graphs.clear();
    CameraTest::TearDownTestSuite(); // Also the contexts, which belong to the device.
    return out;
  }
};

TEST_F(Vulkan12, WithExtensions_MatchesVulkan13) {
  const std::vector<float> with_13 = light(false), with_12 = light(true);
  ASSERT_FALSE(with_13.empty());
  EXPECT_TRUE(with_13 == with_12);
}

} // namespace
} // namespace dermis::abi_test
