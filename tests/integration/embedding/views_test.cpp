// Tests several views of one graph: each gives the pictures of a graph with one view, whatever
// happens to the graph and to the other views.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "tests/integration/embedding/cameras.hpp"

namespace dermis::abi_test {
namespace {

using Recorder = std::function<dermis_result(const dermis_frame*)>;

Recorder recorder_of(dermis_graph graph) {
  return [graph](const dermis_frame* frame) {
    return dermis_view_record(dermis_graph_view(graph), frame);
  };
}
Recorder recorder_of(dermis_view view) {
  return [view](const dermis_frame* frame) { return dermis_view_record(view, frame); };
}

// Some cameras skip some frames; the first camera has all frames.
bool takes_part(size_t camera, uint64_t index) {
  return camera == 0 || (index * 5 + camera) % 4 != 0;
}

struct Views : CameraTest {
  dermis_view make_view(dermis_graph graph, const dermis_view_desc* desc = nullptr) {
    dermis_view view = nullptr;
    EXPECT_OK(dermis_view_create(graph, desc, &view, nullptr));
    return view;
  }

  // A change of the graph between frames.
  using Change = std::function<void(dermis_graph, uint64_t)>;
  static void nothing(dermis_graph, uint64_t) {}

  void run(dermis_graph graph, const std::vector<Recorder>& recorders,
           const std::vector<Camera>& cameras, const std::vector<size_t>& numbers, uint64_t count,
           const Change& change) {
    wait();
    for (uint64_t index = 1; index <= count; ++index) {
      change(graph, index);
      const auto record = [&](VkCommandBuffer into) {
        for (size_t c = 0; c < cameras.size(); ++c) {
          if (!takes_part(numbers[c], index)) continue;
          dermis_frame frame = frame_of(cameras[c], index);
          frame.command_buffer = into;
          ASSERT_OK(recorders[c](&frame));
        }
      };
      submit_again(index, record);
    }
    wait();
  }

  // Returns the light of `count` cameras after `last` frames, as views of one graph.
  std::vector<std::vector<float>> together(size_t count, uint64_t last, const Change& change) {
    const dermis_graph graph = make_accumulating();
    std::vector<Recorder> recorders{recorder_of(graph)};
    std::vector<Camera> cameras;
    std::vector<size_t> numbers;
    for (size_t c = 0; c < count; ++c) {
      if (c > 0) recorders.push_back(recorder_of(make_view(graph)));
      cameras.push_back(make_camera(graph, static_cast<uint32_t>(c + 1)));
      numbers.push_back(c);
    }
    run(graph, recorders, cameras, numbers, last, change);
    std::vector<std::vector<float>> light;
    for (const Camera& camera : cameras)
      light.push_back(light_of(camera));
    return light;
  }

  // Returns the light of one camera with a separate graph.
  std::vector<float> rendered_alone(size_t number, uint64_t last, const Change& change) {
    const dermis_graph graph = make_accumulating();
    std::vector<Camera> cameras;
    cameras.push_back(make_camera(graph, static_cast<uint32_t>(number + 1)));
    run(graph, {recorder_of(graph)}, cameras, {number}, last, change);
    return light_of(cameras.front());
  }

  // Several runs use the same fences.
  void submit_again(uint64_t index, const std::function<void(VkCommandBuffer)>& record) {
    submit(submitted + 1, record);
    ++submitted;
    last_frame = index;
  }
  uint64_t submitted = 0;
};

TEST_F(Views, EachOfEightMatchesASingleView) {
  constexpr uint64_t last = 9;
  const auto light = together(8, last, nothing);
  for (size_t c = 0; c < light.size(); ++c)
    EXPECT_TRUE(light[c] == rendered_alone(c, last, nothing)) << "camera " << c;
  EXPECT_FALSE(light[0] == light[4]) << "the views differ";
  EXPECT_FALSE(light[0] == rendered_alone(0, last - 1, nothing)) << "each frame changes the light";
}

TEST_F(Views, Reload_KeepsTheHistoryOfEach) {
  constexpr uint64_t last = 7;
  const std::string text = read_text("configs/graphs/burley.json");
  const Change reload = [&](dermis_graph graph, uint64_t index) {
    if (index == 4) {
      ASSERT_OK(reload_text(graph, source_of(text, "graph.json")));
    }
  };
  const auto light = together(3, last, reload);
  for (size_t c = 0; c < light.size(); ++c)
    EXPECT_TRUE(light[c] == rendered_alone(c, last, nothing))
        << "camera " << c << " notices the reload";
}

TEST_F(Views, Resize_AppliesToAll) {
  constexpr uint64_t last = 7;
  const Change resize = [](dermis_graph graph, uint64_t index) {
    if (index == 4) {
      ASSERT_OK(dermis_graph_resize(graph, side - 5, side - 3, nullptr));
    }
  };
  const auto light = together(3, last, resize);
  for (size_t c = 0; c < light.size(); ++c)
    EXPECT_TRUE(light[c] == rendered_alone(c, last, resize)) << "camera " << c;
}

TEST_F(Views, GraphSetting_AppliesToAll) {
  constexpr uint64_t last = 6;
  const Change set = [](dermis_graph graph, uint64_t index) {
    if (index == 3) {
      ASSERT_OK(dermis_graph_set_setting(graph, "accumulate_weight", "0.5", nullptr));
    }
  };
  const auto light = together(2, last, set);
  EXPECT_TRUE(light[1] == rendered_alone(1, last, set));
  EXPECT_FALSE(light[1] == rendered_alone(1, last, nothing)) << "the setting changes the picture";
}

TEST_F(Views, DiscardedFrame_ChangesNoView) {
  const dermis_graph graph = make_accumulating();
  const dermis_view view = make_view(graph);
  std::vector<Camera> cameras;
  for (uint32_t seed : {1u, 2u})
    cameras.push_back(make_camera(graph, seed));
  for (uint64_t index = 1; index <= 6; ++index) {
    dermis_frame first = frame_of(cameras[0], index), second = frame_of(cameras[1], index);
    if (index == 4) { // Recorded and thrown away.
      const auto begin = demo::vulkan_struct<VkCommandBufferBeginInfo>(
          VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
      VkCommandBuffer thrown = commands[index % frames];
      wait();
      ASSERT_EQ(host->vk.vkBeginCommandBuffer(thrown, &begin), VK_SUCCESS);
      second.command_buffer = thrown;
      ASSERT_OK(dermis_view_record(view, &second));
      ASSERT_EQ(host->vk.vkEndCommandBuffer(thrown), VK_SUCCESS);
      EXPECT_EQ(dermis_view_discard(dermis_graph_view(graph), index), DERMIS_ERROR_ARGUMENT)
          << "that is another view";
      ASSERT_OK(dermis_view_discard(view, index));
    }
    submit(index, [&](VkCommandBuffer into) {
      first.command_buffer = second.command_buffer = into;
      ASSERT_OK(dermis_view_record(dermis_graph_view(graph), &first));
      if (takes_part(1, index)) {
        ASSERT_OK(dermis_view_record(view, &second));
      }
    });
  }
  submitted = 6;
  EXPECT_TRUE(light_of(cameras[0]) == rendered_alone(0, 6, nothing));
  EXPECT_TRUE(light_of(cameras[1]) == rendered_alone(1, 6, nothing));
}

TEST_F(Views, CanBeCreatedAndDestroyedWhileOthersRun) {
  const dermis_graph graph = make_accumulating();
  std::vector<Camera> cameras;
  for (uint32_t seed : {1u, 2u})
    cameras.push_back(make_camera(graph, seed));
  dermis_view view = nullptr;
  for (uint64_t index = 1; index <= 9; ++index) {
    if (index == 3) view = make_view(graph);
    if (index == 7) {
      wait();
      dermis_view_destroy(view);
      view = nullptr;
    }
    submit(index, [&](VkCommandBuffer into) {
      for (size_t c = 0; c < 2; ++c) {
        dermis_frame frame = frame_of(cameras[c], index);
        frame.command_buffer = into;
        if (c == 1 && view == nullptr) continue;
        const dermis_result result = c == 0 ? dermis_view_record(dermis_graph_view(graph), &frame)
                                            : dermis_view_record(view, &frame);
        ASSERT_OK(result);
      }
    });
  }
  submitted = 9;
  EXPECT_TRUE(light_of(cameras[0]) == rendered_alone(0, 9, nothing));
  dermis_view_destroy(nullptr);
}

TEST_F(Views, CanUseLayersOfOneImage) {
  constexpr uint64_t last = 4;
  const dermis_graph graph = make_accumulating();
  const dermis_view right = make_view(graph);
  Camera camera = make_camera(graph, 1), apart = make_camera(graph, 2);
  const demo::Image& flat = camera.images.at("lighting");
  demo::ImageDesc desc;
  desc.format = flat.format;
  desc.width = desc.height = side;
  desc.layers = 2;
  desc.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT |
               VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  auto made = demo::create_image(*host, desc);
  ASSERT_TRUE(made) << made.error().text;
  demo::Image both = made.take();
  // Layer 0 gets the camera's light. Layer 1 stays in another layout, so that validation would
  // report any access.
  std::vector<float> light = light_of(camera);
  const dermis_image_state rests = camera.bound.front().before;
  const demo::ImageState state{rests.layout, rests.stages, rests.access};
  const auto uploaded = demo::upload_image(*host, both, light, 4, state);
  ASSERT_TRUE(uploaded) << uploaded.error().text;
  std::vector<dermis_image_binding> left_bound = camera.bound, right_bound = apart.bound;
  uint32_t lighting = 0;
  for (const dermis_slot& slot : slots_of(graph))
    if (std::string_view(slot.name) == "lighting") lighting = slot.id;
  for (auto* bound : {&left_bound, &right_bound})
    for (dermis_image_binding& binding : *bound)
      if (binding.slot == lighting) {
        binding.image = both.image;
        binding.layer = bound == &left_bound ? 0 : 1;
        binding.view = both.layer_views[binding.layer];
        binding.layer_count = 1;
        binding.after.layout = bound == &left_bound ? VK_IMAGE_LAYOUT_GENERAL
                                                    : VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
      }
  for (uint64_t index = 1; index <= last; ++index)
    submit(index, [&](VkCommandBuffer into) {
      dermis_frame frame = frame_of(camera, index);
      frame.command_buffer = into;
      frame.bindings = left_bound.data();
      ASSERT_OK(dermis_view_record(dermis_graph_view(graph), &frame));
      frame.bindings = right_bound.data();
      ASSERT_OK(dermis_view_record(right, &frame));
      for (dermis_image_binding& binding : right_bound)
        if (binding.slot == lighting) binding.before.layout = binding.after.layout;
    });
  submitted = last;
  wait();
  // read_image() needs all layers in one layout.
  const auto settled = demo::run_commands(*host, [&](VkCommandBuffer into) -> demo::Result<> {
    auto barrier =
        demo::vulkan_struct<VkImageMemoryBarrier2>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2);
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = barrier.dstAccessMask =
        VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
    barrier.image = both.image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 1, 1};
    auto dependency = demo::vulkan_struct<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
    dependency.imageMemoryBarrierCount = 1;
    dependency.pImageMemoryBarriers = &barrier;
    host->vk.vkCmdPipelineBarrier2(into, &dependency);
    return demo::success();
  });
  ASSERT_TRUE(settled);
  const auto left_light = demo::read_image(*host, both, state, 0),
             right_light = demo::read_image(*host, both, state, 1);
  ASSERT_TRUE(left_light && right_light);
  EXPECT_TRUE(*left_light == rendered_alone(0, last, nothing));
  // Equal layers would mean that the library wrote one eye's light into both.
  EXPECT_FALSE(*left_light == *right_light);
}

TEST_F(Views, EachAddsAnEqualAmountOfMemory) {
  const dermis_graph graph = make_accumulating();
  const auto memory = [&] {
    const dermis_memory bytes = memory_of(graph);
    return bytes;
  };
  const dermis_memory one = memory();
  const dermis_view view = make_view(graph);
  const dermis_memory two = memory();
  EXPECT_EQ(two.history_bytes, 2 * one.history_bytes);
  EXPECT_EQ(two.transient_bytes, 2 * one.transient_bytes);
  dermis_view_destroy(view);
  EXPECT_EQ(memory().history_bytes, one.history_bytes);
}

TEST_F(Views, ReportSeparateTimesAndChoices) {
  const dermis_graph graph = make_accumulating();
  const dermis_view view = make_view(graph);
  const Camera camera = make_camera(graph, 1);
  submit(1, [&](VkCommandBuffer into) {
    dermis_frame frame = frame_of(camera, 1);
    frame.command_buffer = into;
    ASSERT_OK(dermis_view_record(view, &frame));
  });
  wait();
  demo::ReportedFrame choice;
  EXPECT_EQ(demo::read_reported(dermis_graph_view(graph), 0, choice), DERMIS_NOT_READY)
      << "the graph's own view ran no frame";
  EXPECT_OK(demo::read_reported(view, 1, choice));
  EXPECT_EQ(choice.frame_index, 1u);
  uint32_t count = 0;
  ASSERT_OK(dermis_view_timings(view, 1, &count, nullptr));
  std::vector<dermis_pass_timing> times(count, dermis_pass_timing DERMIS_PASS_TIMING_INIT);
  ASSERT_OK(dermis_view_timings(view, 1, &count, times.data()));
  EXPECT_EQ(times[0].frame_index, 1u);
  EXPECT_EQ(dermis_view_timings(dermis_graph_view(graph), 0, &count, times.data()),
            DERMIS_NOT_READY);
}

} // namespace
} // namespace dermis::abi_test
