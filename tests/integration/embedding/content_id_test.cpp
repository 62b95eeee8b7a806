// Tests images without a view: the library keeps one view per content_id, and handles may be
// reused.

#include "tests/integration/embedding/cameras.hpp"
#include "tests/integration/embedding/null_host.hpp"

namespace dermis::abi_test {
namespace {

struct ContentId : CameraTest {
  uint64_t submitted = 0;
  void run(dermis_graph graph, const Camera& camera, uint64_t index) {
    submit(++submitted, [&](VkCommandBuffer into) {
      dermis_frame frame = frame_of(camera, index);
      frame.command_buffer = into;
      ASSERT_OK(dermis_view_record(dermis_graph_view(graph), &frame));
    });
  }
  static void give_up_views(Camera& camera, uint64_t first_id) {
    for (dermis_image_binding& binding : camera.bound) {
      binding.view = VK_NULL_HANDLE;
      binding.content_id = first_id++;
    }
  }
};

TEST_F(ContentId, ReplacesTheHostsViews) {
  std::vector<float> light[2];
  for (const bool without : {false, true}) {
    const dermis_graph graph = make_accumulating();
    Camera camera = make_camera(graph, 1);
    if (without) give_up_views(camera, 1);
    wait();
    for (uint64_t index = 1; index <= 5; ++index)
      run(graph, camera, index);
    light[without ? 1 : 0] = light_of(camera);
  }
  EXPECT_TRUE(light[0] == light[1]);
}

// The validation layer reports the use of a view of a destroyed image.
TEST_F(ContentId, DistinguishesImagesWithEqualHandles) {
  const dermis_graph graph = make_accumulating();
  uint64_t id = 1, index = 0;
  std::vector<float> expected;
  for (uint32_t seed = 1; seed <= 4; ++seed) {
    // The images of the previous camera are destroyed, so their handles are free.
    Camera camera = make_camera(graph, seed);
    give_up_views(camera, id);
    id += camera.bound.size();
    const std::vector<float> before = light_of(camera);
    dermis_frame frame = frame_of(camera, ++index);
    frame.flags |= DERMIS_FRAME_RESET_HISTORY;
    submit(++submitted, [&](VkCommandBuffer into) {
      frame.command_buffer = into;
      ASSERT_OK(dermis_view_record(dermis_graph_view(graph), &frame));
    });
    EXPECT_FALSE(before == light_of(camera)) << "the graph wrote this image";
  }
}

TEST_F(ContentId, TooManyImages_AreRejectedOnlyWhileInUse) {
  const dermis_graph graph = make_accumulating();
  Camera camera = make_camera(graph, 1);
  // A new image in each frame, three frames in flight.
  for (uint64_t index = 1; index <= 40; ++index) {
    give_up_views(camera, index * 100);
    run(graph, camera, index);
  }
  wait();
}

TEST(ContentIdOnTheNullDevice, CreatesAViewOnceAndDestroysIt) {
  NullHost host;
  ASSERT_OK(host.start());
  host.give_up_views();
  host.device.fail_creation(1, VK_ERROR_OUT_OF_DEVICE_MEMORY);
  EXPECT_THAT(host.record(), Fails(DERMIS_ERROR_DEVICE_MEMORY, "vkCreateImageView"));
  ASSERT_OK(host.record());
  const uint64_t creations = host.device.creations();
  for (int i = 0; i < 5; ++i)
    ASSERT_OK(host.record());
  EXPECT_EQ(host.device.creations(), creations);
}

} // namespace
} // namespace dermis::abi_test
