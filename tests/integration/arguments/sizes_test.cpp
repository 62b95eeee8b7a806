// Tests the rules on struct_size in dermis.h for every struct of the C interface: accepted sizes,
// and fields that only the newer of host and library has.

#include "integration/abi/sized_struct.hpp"
#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/recorded_frame.hpp"

#include <cstring>
#include <functional>
#include <utility>

namespace dermis::abi_test {
namespace {

constexpr size_t slot_bytes = 2 * abi::largest_struct_size;
constexpr size_t newer_by = 16; // Bytes of fields that a later header might add.

// A struct followed by more bytes, as in a caller with a newer header.
template <class T> class Sized {
public:
  explicit Sized(const T& value) {
    std::memcpy(bytes_, &value, sizeof value);
    state(sizeof value);
  }
  void state(size_t size) { std::memcpy(bytes_, &size, sizeof size); }
  void tail(unsigned char value) { std::memset(bytes_ + sizeof(T), value, newer_by); }
  std::vector<std::byte> read_tail() const {
    return {bytes_ + sizeof(T), bytes_ + sizeof(T) + newer_by};
  }
  T* get() { return reinterpret_cast<T*>(bytes_); }

private:
  alignas(T) std::byte bytes_[slot_bytes]{};
};

template <class T> using Call = std::function<dermis_result(T*)>;

template <class T> void expect_wrong_sizes_rejected(Sized<T>& given, const Call<T>& call) {
  for (const size_t size :
       {size_t{0}, sizeof(size_t), sizeof(T) - 1, abi::largest_struct_size + 1, ~size_t{0}}) {
    given.state(size);
    EXPECT_THAT(call(given.get()), Fails(DERMIS_ERROR_ARGUMENT, "struct_size")) << size;
  }
}

// Checks a struct that the library reads.
template <class T> void expect_input_property(const T& value, const Call<T>& call) {
  Sized<T> given(value);
  expect_wrong_sizes_rejected(given, call);
  given.state(sizeof(T) + newer_by);
  EXPECT_OK(call(given.get()));
  given.tail(1);
  EXPECT_EQ(call(given.get()), DERMIS_ERROR_VERSION);
  given.tail(0);
  given.state(sizeof(T));
  EXPECT_OK(call(given.get()));
}

// Checks a struct that the library fills.
template <class T> void expect_output_property(const T& value, const Call<T>& call) {
  Sized<T> given(value);
  expect_wrong_sizes_rejected(given, call);
  given.state(sizeof(T) + newer_by);
  given.tail(0xff);
  EXPECT_OK(call(given.get()));
  EXPECT_THAT(given.read_tail(), Each(std::byte{0})) << "what the library does not know is zero";
  given.state(sizeof(T));
  given.tail(0xff);
  EXPECT_OK(call(given.get()));
  EXPECT_THAT(given.read_tail(), Each(std::byte{0xff}))
      << "nothing is written after the stated size";
}

struct StructSizes : RecordedFrame {};

void DERMIS_CALL record_nothing(void*, const dermis_pass_call*) {}
void* DERMIS_CALL take_nothing(void*, size_t, size_t) {
  return nullptr;
}
void DERMIS_CALL release_nothing(void*, void*, size_t, size_t) {}

TEST_F(StructSizes, Context_FollowsTheHeader) {
  expect_input_property<dermis_context_desc>(
      host.context_desc(), [](const dermis_context_desc* desc) {
        dermis_context made = nullptr;
        const dermis_result result = dermis_context_create(desc, &made);
        dermis_context_destroy(made);
        return result;
      });
}

TEST_F(StructSizes, GraphViewAndBudget_FollowTheHeader) {
  const std::string text = read_text("configs/graphs/burley.json");
  dermis_graph_desc desc = graph_desc(text, "burley.json", 16);
  expect_input_property<dermis_graph_desc>(desc, [&](const dermis_graph_desc* given) {
    dermis_graph made = nullptr;
    const dermis_result result = dermis_graph_create(host.context, given, &made, nullptr);
    dermis_graph_destroy(made);
    return result;
  });
  expect_input_property<dermis_view_desc>(
      DERMIS_VIEW_DESC_INIT, [&](const dermis_view_desc* given) {
        dermis_view made = nullptr;
        const dermis_result result = dermis_view_create(host.graph, given, &made, nullptr);
        dermis_view_destroy(made);
        return result;
      });
  expect_input_property<dermis_budget>(DERMIS_BUDGET_INIT, [&](const dermis_budget* given) {
    return dermis_graph_set_budget(host.graph, given, nullptr);
  });
  dermis_outcome outcome = DERMIS_OUTCOME_INIT;
  expect_input_property<dermis_forecast_desc>(
      DERMIS_FORECAST_DESC_INIT, [&](const dermis_forecast_desc* given) {
        return dermis_graph_predict(host.graph, given, &outcome);
      });
}

TEST_F(StructSizes, PassTypePortsAndSettings_FollowTheHeader) {
  uint32_t number = 0; // Names can be registered only once.
  dermis_port port = port_of("picture", DERMIS_PORT_STORAGE_IMAGE_UPDATE);
  dermis_pass_setting setting = DERMIS_PASS_SETTING_INIT;
  setting.name = "on";
  dermis_pass_type type = DERMIS_PASS_TYPE_INIT;
  type.ports = &port;
  type.settings = &setting;
  type.port_count = type.setting_count = 1;
  type.record = record_nothing;
  dermis_graph_destroy(host.graph);
  host.graph = nullptr;
  std::string name;
  const auto add = [&](dermis_pass_type* given) {
    name = "studio.kind" + std::to_string(++number);
    given->name = name.c_str();
    return dermis_register_pass_type(host.context, given);
  };
  expect_input_property<dermis_pass_type>(type, add);
  expect_input_property<dermis_port>(port, [&](const dermis_port* given) {
    type.ports = given;
    const dermis_result result = add(&type);
    type.ports = &port;
    return result;
  });
  expect_input_property<dermis_pass_setting>(setting, [&](const dermis_pass_setting* given) {
    type.settings = given;
    return add(&type);
  });
}

// The first element states the size of all: no other is read beyond it.
TEST_F(StructSizes, ElementsOfPassTypes_HaveOneSize) {
  dermis_port ports[2] = {port_of("a", DERMIS_PORT_SAMPLED_IMAGE),
                          port_of("b", DERMIS_PORT_STORAGE_IMAGE_UPDATE)};
  dermis_pass_setting settings[2] = {DERMIS_PASS_SETTING_INIT, DERMIS_PASS_SETTING_INIT};
  settings[0].name = "one", settings[1].name = "two";
  dermis_pass_type type = DERMIS_PASS_TYPE_INIT;
  type.name = "studio.sizes";
  type.ports = ports;
  type.settings = settings;
  type.port_count = type.setting_count = 2;
  type.record = record_nothing;
  dermis_graph_destroy(host.graph);
  host.graph = nullptr;
  for (size_t* size : {&ports[1].struct_size, &settings[1].struct_size}) {
    const size_t right = std::exchange(*size, 4000);
    EXPECT_EQ(dermis_register_pass_type(host.context, &type), DERMIS_ERROR_ARGUMENT);
    *size = right;
  }
  EXPECT_OK(dermis_register_pass_type(host.context, &type));
}

TEST_F(StructSizes, Allocators_FollowTheHeader) {
  dermis_context_desc desc = host.context_desc();
  const auto create = [&] {
    dermis_context made = nullptr;
    const dermis_result result = dermis_context_create(&desc, &made);
    dermis_context_destroy(made);
    return result;
  };
  dermis_device_allocator device = DERMIS_DEVICE_ALLOCATOR_INIT;
  device.allocate = [](void*, const dermis_memory_request*, dermis_memory_block*) {
    return VK_ERROR_UNKNOWN;
  };
  device.free = [](void*, const dermis_memory_block*) {};
  expect_input_property<dermis_device_allocator>(device, [&](const dermis_device_allocator* given) {
    desc.device_allocator = given;
    return create();
  });
  desc.device_allocator = nullptr;
  dermis_allocator memory = DERMIS_ALLOCATOR_INIT;
  memory.allocate = take_nothing;
  memory.free = release_nothing;
  Sized<dermis_allocator> given(
      memory); // with which nothing can be made: its own law stops at the refusals
  desc.allocator = given.get();
  expect_wrong_sizes_rejected<dermis_allocator>(given,
                                                [&](const dermis_allocator*) { return create(); });
  given.state(sizeof(dermis_allocator) + newer_by);
  given.tail(1);
  EXPECT_EQ(create(), DERMIS_ERROR_VERSION);
}

TEST_F(StructSizes, FrameAndBindings_FollowTheHeader) {
  uint64_t frame_index = host.last_frame;
  expect_input_property<dermis_frame>(host.frame_at(1), [&](dermis_frame* frame) {
    frame->frame_index = frame_index + 1;
    frame->completed_frame_index = frame_index;
    const dermis_result result = dermis_view_record(dermis_graph_view(host.graph), frame);
    if (result == DERMIS_OK) ++frame_index;
    return result;
  });
  // One binding followed by as many wrong bindings as the graph has slots: with the right size, the
  // call gets further.
  dermis_frame frame = host.frame_at(frame_index + 1);
  dermis_image_binding binding = frame.bindings[0];
  binding.slot = 1000;
  frame.binding_count = 1;
  Sized<dermis_image_binding> given(binding);
  frame.bindings = given.get();
  expect_wrong_sizes_rejected<dermis_image_binding>(given, [&](dermis_image_binding*) {
    return dermis_view_record(dermis_graph_view(host.graph), &frame);
  });
  given.state(sizeof(dermis_image_binding) + newer_by);
  EXPECT_THAT(dermis_view_record(dermis_graph_view(host.graph), &frame),
              Fails(DERMIS_ERROR_ARGUMENT, "slot is 1000"));
  given.tail(1);
  EXPECT_EQ(dermis_view_record(dermis_graph_view(host.graph), &frame), DERMIS_ERROR_VERSION);
}

TEST_F(StructSizes, NewerBindings_AreReadByTheirStride) {
  struct Newer {
    dermis_image_binding known;
    uint64_t unknown = 0;
  };
  std::vector<Newer> bound;
  for (const dermis_image_binding& binding : host.bindings()) {
    bound.push_back({binding});
    bound.back().known.struct_size = sizeof(Newer);
  }
  dermis_frame frame = host.frame_at(host.last_frame + 1);
  frame.bindings = &bound[0].known;
  bound[1].unknown = 1;
  EXPECT_EQ(dermis_view_record(dermis_graph_view(host.graph), &frame), DERMIS_ERROR_VERSION);
  bound[1].unknown = 0;
  EXPECT_OK(dermis_view_record(dermis_graph_view(host.graph), &frame));
}

TEST_F(StructSizes, SourcesProfilesAndFormats_FollowTheHeader) {
  const std::string text = read_text("configs/graphs/burley.json");
  dermis_graph_desc desc = graph_desc(text, "burley.json", 16);
  const auto create = [&] {
    dermis_graph made = nullptr;
    const dermis_result result = dermis_graph_create(host.context, &desc, &made, nullptr);
    dermis_graph_destroy(made);
    return result;
  };
  dermis_profile profile = skin_profile();
  desc.profile_count = 1;
  expect_input_property<dermis_profile>(profile, [&](const dermis_profile* given) {
    desc.profiles = given;
    return create();
  });
  desc.profile_count = 0;
  dermis_slot_format format = slot_format("depth", VK_FORMAT_R32_SFLOAT);
  desc.format_count = 1;
  expect_input_property<dermis_slot_format>(format, [&](const dermis_slot_format* given) {
    desc.formats = given;
    return create();
  });
  desc.format_count = 0;
  expect_input_property<dermis_source>(
      desc.source, [](const dermis_source* given) { return dermis_validate(given, nullptr); });
}

// A source that is a member of another struct, or that a member points to, never grows. A larger
// size is always rejected, even if all additional bytes are zero.
TEST_F(StructSizes, NestedSources_AreExact) {
  const std::string text = read_text("configs/graphs/burley.json");
  dermis_profile profile = skin_profile();
  dermis_graph_desc desc = graph_desc(text, "burley.json", 16);
  desc.profiles = &profile;
  desc.profile_count = 1;
  const auto create = [&] {
    dermis_graph made = nullptr;
    const dermis_result result = dermis_graph_create(host.context, &desc, &made, nullptr);
    dermis_graph_destroy(made);
    return result;
  };
  Sized<dermis_source> table(source_of(text, "table"));
  dermis_budget errors = DERMIS_BUDGET_INIT, calibration = DERMIS_BUDGET_INIT;
  errors.errors = calibration.calibration = table.get();
  const auto set = [&](const dermis_budget& budget) {
    return dermis_graph_set_budget(host.graph, &budget, nullptr);
  };
  const std::pair<const char*, std::function<dermis_result(size_t)>> nested[] = {
      {"desc.source.struct_size",
       [&](size_t size) {
         desc.source.struct_size = size;
         const dermis_result result = create();
         desc.source.struct_size = sizeof(dermis_source);
         return result;
       }},
      {"desc.profiles[0].source.struct_size",
       [&](size_t size) {
         profile.source.struct_size = size;
         const dermis_result result = create();
         profile.source.struct_size = sizeof(dermis_source);
         return result;
       }},
      {"errors.struct_size",
       [&](size_t size) {
         table.state(size);
         return set(errors);
       }},
      {"calibration.struct_size",
       [&](size_t size) {
         table.state(size);
         return set(calibration);
       }},
  };
  ASSERT_OK(create());
  for (const auto& [field, call] : nested)
    for (const size_t size :
         {size_t{0}, sizeof(size_t), sizeof(dermis_source) - 1, sizeof(dermis_source) + 1,
          sizeof(dermis_source) + newer_by, abi::largest_struct_size, ~size_t{0}}) {
      EXPECT_EQ(call(size), DERMIS_ERROR_ARGUMENT) << field << " = " << size;
      EXPECT_THAT(dermis_last_error(), HasAll(field, "DERMIS_SOURCE_INIT")) << size;
    }
}

TEST_F(StructSizes, OutputStructs_FollowTheHeader) {
  expect_output_property<dermis_memory>(
      DERMIS_MEMORY_INIT, [&](dermis_memory* out) { return dermis_graph_memory(host.graph, out); });
  expect_output_property<dermis_outcome>(DERMIS_OUTCOME_INIT, [&](dermis_outcome* out) {
    return dermis_graph_predict(host.graph, nullptr, out);
  });
  const dermis_view view = dermis_graph_view(host.graph);
  expect_output_property<dermis_frame_report>(
      DERMIS_FRAME_REPORT_INIT,
      [&](dermis_frame_report* out) { return dermis_view_report(view, 1, out); });
  expect_output_property<dermis_frame_statistics>(
      DERMIS_FRAME_STATISTICS_INIT,
      [&](dermis_frame_statistics* out) { return dermis_view_statistics(view, 1, out); });
  dermis_report report = nullptr;
  ASSERT_EQ(dermis_graph_set_setting(host.graph, "nothing", "1", &report), DERMIS_ERROR_ARGUMENT);
  expect_output_property<dermis_message>(DERMIS_MESSAGE_INIT, [&](dermis_message* out) {
    return dermis_report_message(report, 0, out);
  });
  dermis_report_destroy(report);
}

} // namespace
} // namespace dermis::abi_test
