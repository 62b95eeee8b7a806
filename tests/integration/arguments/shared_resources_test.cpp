// Tests one image or buffer of the host in two slots of a frame.

#include "tests/integration/embedding/recorded_frame.hpp"

namespace dermis::abi_test {
namespace {

struct SharedImages : RecordedFrame {
  dermis_frame frame = DERMIS_FRAME_INIT;
  std::vector<dermis_image_binding> bindings;

  void SetUp() override {
    RecordedFrame::SetUp();
    frame = host.frame_at(2);
    bindings.assign(frame.bindings, frame.bindings + frame.binding_count);
    frame.bindings = bindings.data();
  }
  dermis_image_binding& slot(std::string_view name) {
    uint32_t count = 64;
    std::vector<dermis_slot> slots(count, dermis_slot DERMIS_SLOT_INIT);
    EXPECT_OK(dermis_graph_slots(host.graph, &count, slots.data()));
    for (uint32_t i = 0; i < count; ++i)
      if (slots[i].name == name)
        for (dermis_image_binding& binding : bindings)
          if (binding.slot == slots[i].id) return binding;
    ADD_FAILURE() << name;
    return bindings.front();
  }
  void rejected(const char* a, const char* b) {
    EXPECT_THAT(dermis_view_record(dermis_graph_view(host.graph), &frame),
                Fails(DERMIS_ERROR_ARGUMENT, a, b, "bound to the same"));
  }
  void recorded() {
    EXPECT_OK(dermis_view_record(dermis_graph_view(host.graph), &frame));
    ++frame.frame_index;
    ++frame.completed_frame_index;
  }
};

TEST_F(SharedImages, LayoutChange_IsRejectedNamingBothSlots) {
  slot("albedo").image = slot("scatter_scale").image;
  rejected("'albedo'", "'scatter_scale'"); // Read in another layout than that of the states.
  slot("albedo").image = slot("lighting").image;
  rejected("'albedo'", "'lighting'");
}

TEST_F(SharedImages, UnchangedLayout_IsAccepted) {
  for (const char* name : {"albedo", "scatter_scale"})
    slot(name).before.layout = slot(name).after.layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  slot("albedo").image = slot("scatter_scale").image;
  recorded();
  slot("albedo").before.access = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  rejected("'albedo'", "'scatter_scale'");
}

TEST_F(SharedImages, OtherLayersOrAspect_AreDistinct) {
  slot("albedo").image = slot("lighting").image;
  slot("albedo").layer = 1;
  slot("albedo").layer_count = 1;
  rejected("'albedo'", "'lighting'"); // All layers of lighting.
  slot("lighting").layer_count = 1;
  recorded();
  slot("lighting").layer_count = 2;
  rejected("'albedo'", "'lighting'");
}

} // namespace
} // namespace dermis::abi_test
