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

// Frames that were recorded, but never ran, keep no view from being replaced.
TEST(ContentIdOnTheNullDevice, DiscardedFrames_KeepNoViews) {
  NullHost host;
  ASSERT_OK(host.start());
  host.give_up_views();
  ASSERT_OK(host.record());
  const dermis_view view = dermis_graph_view(host.graph);
  const uint64_t next = host.last_frame + 1;
  for (int i = 0; i < 20; ++i) {
    host.number_images();
    ASSERT_OK(host.record(view, next)) << i;
    ASSERT_OK(dermis_view_discard(view, next));
  }
}

// Descriptors that recording writes, on a device that counts them.
struct DescriptorWrites : ::testing::Test {
  static constexpr uint64_t warm_frames = 8;
  NullHost host;

  void start(uint32_t frames_in_flight) {
    dermis_context_desc desc = host.context_desc();
    desc.frames_in_flight = frames_in_flight;
    ASSERT_OK(host.make_context(desc));
    ASSERT_OK(host.make_graph());
    host.make_bindings();
  }
  // Records a frame and returns the number of descriptors that it wrote.
  uint64_t writes_of_a_frame() {
    const uint64_t before = host.device.descriptor_writes();
    EXPECT_OK(host.record());
    return host.device.descriptor_writes() - before;
  }
  // Returns the writes of each of `count` frames.
  std::vector<uint64_t> writes_of_frames(size_t count) {
    std::vector<uint64_t> writes;
    for (size_t i = 0; i < count; ++i)
      writes.push_back(writes_of_a_frame());
    return writes;
  }
};

// The graph has histories: their images alternate in step with two frames in flight only.
TEST_F(DescriptorWrites, UnchangedImages_WriteNothing) {
  for (const uint32_t frames : {1u, 2u, 3u}) {
    ASSERT_NO_FATAL_FAILURE(start(frames));
    host.number_images();
    EXPECT_GT(writes_of_a_frame(), 20u) << "the first frame writes all";
    writes_of_frames(warm_frames);
    EXPECT_EQ(writes_of_frames(6), std::vector<uint64_t>(6, 0)) << frames << " frames in flight";
    host.give_up_views();
    EXPECT_GT(writes_of_a_frame(), 0u) << "views of the library";
    writes_of_frames(warm_frames);
    EXPECT_EQ(writes_of_frames(6), std::vector<uint64_t>(6, 0)) << frames << " frames in flight";
    host.destroy();
    host.last_frame = 0;
  }
}

TEST_F(DescriptorWrites, WithoutIds_AllHostImagesAreWritten) {
  ASSERT_NO_FATAL_FAILURE(start(2));
  const uint64_t all = writes_of_a_frame();
  writes_of_frames(warm_frames);
  const uint64_t each = writes_of_a_frame();
  EXPECT_GT(each, 0u) << "the handles may be those of other images";
  EXPECT_LT(each, all / 2);
  host.number_images();
  EXPECT_EQ(writes_of_frames(3), (std::vector<uint64_t>{each, each, 0}));
}

TEST_F(DescriptorWrites, ChangedImage_IsWrittenAtItsPorts) {
  ASSERT_NO_FATAL_FAILURE(start(2));
  host.number_images();
  writes_of_frames(warm_frames);
  host.number_images();
  const uint64_t of_all = writes_of_a_frame();
  writes_of_a_frame();
  uint64_t sum = 0, id = 1000;
  for (dermis_image_binding& binding : host.bindings()) {
    const auto expect_written = [&](const char* what) {
      const std::vector<uint64_t> writes = writes_of_frames(3);
      EXPECT_GT(writes[0], 0u) << what;
      EXPECT_EQ(writes, (std::vector<uint64_t>{writes[0], writes[0], 0})) << what;
      return writes[0];
    };
    binding.content_id = ++id;
    sum += expect_written("another image with equal handles");
    binding.view = host.device.make_view();
    expect_written("another view of the image");
  }
  EXPECT_EQ(sum, of_all);
}

TEST_F(DescriptorWrites, SurviveADiscardedFrame) {
  ASSERT_NO_FATAL_FAILURE(start(2));
  host.number_images();
  writes_of_frames(warm_frames);
  host.number_images();
  const uint64_t changed = writes_of_a_frame();
  ASSERT_OK(dermis_view_discard(dermis_graph_view(host.graph), host.last_frame));
  --host.last_frame;
  EXPECT_EQ(writes_of_frames(3), (std::vector<uint64_t>{0, changed, 0}));
}

// An image that is only cleared has no usage with which it may have a view.
TEST(ContentIdOnTheNullDevice, ImageThatIsOnlyCleared_GetsNoView) {
  NullHost host;
  ASSERT_OK(host.make_context(host.context_desc()));
  const std::string text = R"({ "dermis": 2, "name": "cleared",
    "resources": { "cleared": { "format": "rgba16f", "size": "view" } },
    "passes": [ { "pass": "clear", "type": "clear", "write": { "target": "cleared" } } ],
    "exports": ["cleared"] })";
  const dermis_graph_desc desc = graph_desc(text, "cleared.json", 16);
  ASSERT_OK(dermis_graph_create(host.context, &desc, &host.graph, nullptr));
  const auto slots = list_of(dermis_slot DERMIS_SLOT_INIT, dermis_graph_slots, host.graph);
  ASSERT_EQ(slots.size(), 1u);
  EXPECT_EQ(slots[0].usage, VkImageUsageFlags{VK_IMAGE_USAGE_TRANSFER_DST_BIT});
  host.make_bindings();
  host.give_up_views();
  const uint64_t before = host.device.creations();
  EXPECT_OK(host.record());
  EXPECT_EQ(host.device.creations(), before);
}

} // namespace
} // namespace dermis::abi_test
