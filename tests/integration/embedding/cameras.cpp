#include "tests/integration/embedding/cameras.hpp"

#include "framegraph/model/splitmix.hpp"

namespace dermis::abi_test {

GraphOptions CameraTest::accumulating() const {
  GraphOptions options;
  options.width = options.height = side;
  options.overlays = {read_text("configs/overlays/accumulate.json")};
  options.unbound.emplace_back("velocity");
  return options;
}

dermis_graph CameraTest::make_accumulating() {
  const dermis_graph graph = make_graph(accumulating());
  if (graph != nullptr) {
    EXPECT_OK(dermis_graph_set_setting(graph, "accumulate_clip", "0", nullptr));
  }
  return graph;
}

Camera CameraTest::make_camera(dermis_graph graph, uint32_t seed) {
  make_images(graph);
  SplitMix64 random{seed};
  fill("lighting",
       [&](uint32_t, uint32_t) { return static_cast<float>(random.below(1024)) / 1024.0f; });
  Camera camera;
  camera.bound = bindings(graph);
  camera.images.swap(images);
  return camera;
}

dermis_frame CameraTest::frame_of(const Camera& camera, uint64_t index) const {
  dermis_frame frame = DERMIS_FRAME_INIT;
  frame.bindings = camera.bound.data();
  frame.binding_count = static_cast<uint32_t>(camera.bound.size());
  frame.frame_index = index;
  frame.completed_frame_index = completed_before(index);
  frame.depth_kind = DERMIS_DEPTH_VIEW_UNITS;
  for (float* projection : {frame.clip_from_view, frame.previous_clip_from_view}) {
    projection[0] = static_cast<float>(2.0 / (side * pitch_m));
    projection[5] = static_cast<float>(-2.0 / (side * pitch_m));
    projection[10] = -1.0f;
    projection[15] = 1.0f;
  }
  for (float* view : {frame.view_from_world, frame.previous_view_from_world})
    for (size_t i = 0; i < 16; i += 5)
      view[i] = 1.0f;
  return frame;
}

std::vector<float> CameraTest::light_of(const Camera& camera) const {
  wait();
  const demo::ImageState state{camera.bound.front().before.layout,
                               camera.bound.front().before.stages,
                               camera.bound.front().before.access};
  auto read = demo::read_image(*host, camera.images.at("lighting"), state);
  EXPECT_TRUE(read) << read.error().text;
  return read ? read.take() : std::vector<float>{};
}

} // namespace dermis::abi_test
