// Tests frequent reloads while a graph runs, half of them with broken text. The pictures must not
// show them.

#include "integration/examples/demo_engine/engine.hpp"
#include "tests/integration/embedding/cameras.hpp"

namespace dermis::abi_test {
namespace {

constexpr uint32_t storm_frames = 50, reloads_a_frame = 10; // 500 reloads, half of them broken.
constexpr uint32_t storm_width = 96, storm_height = 64;     // Pixels.

// Returns a text as an editor may save it halfway.
std::string broken(const std::string& text, uint32_t number) {
  switch (number % 5) {
  case 0:
    return text.substr(0, text.size() * (1 + number % 89) / 100); // A truncated file.
  case 1:
    return replaced(text, "\"type\": \"subsurface.classify\"", "\"type\": \"subsurface.clasify\"");
  case 2:
    return replaced(text, "\"passes\"", "\"pases\"");
  case 3:
    return replaced(text, "\"lighting\": {", "\"lightning\": {");
  default:
    return "{ \"dermis\": 2 }";
  }
}

struct Storm {
  std::vector<std::vector<float>> colors; // By frame.
  demo::RenderSummary summary;
};

Storm rendered(const std::function<std::vector<std::string>(uint32_t)>& reloads) {
  demo::RenderOptions options;
  options.scene = std::string(DERMIS_SOURCE_DIR) + "/configs/scenes/flashing.json";
  options.graph = std::string(DERMIS_SOURCE_DIR) + "/configs/graphs/papers/sap_residual.json";
  options.width = storm_width;
  options.height = storm_height;
  options.frames = storm_frames;
  options.validation = true;
  options.reloads = reloads;
  Storm storm;
  demo::RenderCallbacks callbacks;
  callbacks.on_frame = [&](const demo::FrameOutputs& frame) -> demo::Result<> {
    storm.colors.push_back(frame.color.texels);
    return demo::success();
  };
  auto done = demo::render(options, callbacks);
  EXPECT_TRUE(done) << done.error().text;
  if (done) storm.summary = done.take();
  EXPECT_THAT(storm.summary.validation_messages, IsEmpty());
  return storm;
}

TEST(ReloadStorm, BrokenReloadsChangeNothing) {
  const std::string text = read_text("configs/graphs/papers/sap_residual.json");
  const Storm calm = rendered({});
  const Storm rejected = rendered([&](uint32_t frame) {
    std::vector<std::string> texts;
    for (uint32_t i = 0; i < reloads_a_frame / 2; ++i)
      texts.push_back(broken(text, frame * reloads_a_frame + i));
    return texts;
  });
  const Storm mixed = rendered([&](uint32_t frame) {
    std::vector<std::string> texts;
    for (uint32_t i = 0; i < reloads_a_frame; ++i)
      texts.push_back((i + frame) % 2 == 0 ? text : broken(text, frame * reloads_a_frame + i));
    return texts;
  });
  ASSERT_EQ(calm.colors.size(), storm_frames);
  EXPECT_EQ(rejected.summary.reloads, storm_frames * reloads_a_frame / 2);
  EXPECT_EQ(rejected.summary.rejected_reloads, rejected.summary.reloads);
  EXPECT_EQ(mixed.summary.reloads, storm_frames * reloads_a_frame);
  EXPECT_EQ(mixed.summary.rejected_reloads, mixed.summary.reloads / 2);
  EXPECT_TRUE(calm.colors == rejected.colors) << "a rejected reload changed a picture";
  EXPECT_TRUE(calm.colors == mixed.colors) << "a reload of the same graph lost history";
}

struct Sizes : CameraTest {};

TEST_F(Sizes, CanChangeEachFrameWithThreeInFlight) {
  constexpr uint32_t count = 200, largest = 97;
  GraphOptions options = accumulating();
  options.width = options.height = largest;
  const dermis_graph graph = make_graph(options);
  dermis_view view = view_of(graph);
  const Camera camera = make_camera(graph, 1), other = make_camera(graph, 2);
  dermis_memory before = DERMIS_MEMORY_INIT, after = DERMIS_MEMORY_INIT;
  ASSERT_OK(dermis_graph_memory(graph, &before));
  for (uint64_t index = 1; index <= count; ++index) {
    const bool back = index == count;
    const auto width = back ? largest : static_cast<uint32_t>(1 + index * 37 % largest);
    const auto height = back ? largest : static_cast<uint32_t>(1 + index * 53 % largest);
    ASSERT_OK(dermis_graph_resize(graph, width, height, nullptr));
    submit(index, [&](VkCommandBuffer into) {
      dermis_frame first = frame_of(camera, index), second = frame_of(other, index);
      first.command_buffer = second.command_buffer = into;
      ASSERT_OK(dermis_view_record(dermis_graph_view(graph), &first));
      if (index % 3 == 0) { // that many sizes are skipped by this one
        ASSERT_OK(dermis_view_record(view, &second));
      }
    });
  }
  wait();
  ASSERT_OK(dermis_graph_memory(graph, &after));
  EXPECT_EQ(after.history_bytes, before.history_bytes);
  EXPECT_EQ(after.transient_bytes, before.transient_bytes);
  EXPECT_EQ(after.constant_bytes, before.constant_bytes);
}

} // namespace
} // namespace dermis::abi_test
