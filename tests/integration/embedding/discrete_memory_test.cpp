// Tests a device whose device-local memory is not host-visible, as on many graphics cards: the
// first frame that reads tables copies them.

#include "tests/integration/embedding/cameras.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <cstring>
#include <set>

namespace dermis::abi_test {
namespace {

// A loader that shows the driver's only memory type as two: type 0 is host-visible and not
// device-local, type 1 is device-local and not host-visible.
std::set<VkDeviceMemory> hidden; // memory of type 1

template <class Function> Function driver(VkDevice device, const char* name) {
  return reinterpret_cast<Function>(vkGetDeviceProcAddr(device, name));
}

void VKAPI_CALL memory_properties(VkPhysicalDevice physical,
                                  VkPhysicalDeviceMemoryProperties* out) {
  vkGetPhysicalDeviceMemoryProperties(physical, out);
  out->memoryTypeCount = 2;
  out->memoryTypes[1] = {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, out->memoryTypes[0].heapIndex};
  out->memoryTypes[0].propertyFlags &= ~VkMemoryPropertyFlags{VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
}

void VKAPI_CALL image_needs(VkDevice device, VkImage image, VkMemoryRequirements* needs) {
  driver<PFN_vkGetImageMemoryRequirements>(device, "vkGetImageMemoryRequirements")(device, image,
                                                                                   needs);
  needs->memoryTypeBits |= 2u;
}

void VKAPI_CALL buffer_needs(VkDevice device, VkBuffer buffer, VkMemoryRequirements* needs) {
  driver<PFN_vkGetBufferMemoryRequirements>(device, "vkGetBufferMemoryRequirements")(device, buffer,
                                                                                     needs);
  needs->memoryTypeBits |= 2u;
}

void VKAPI_CALL image_needs_by_info(VkDevice device, const VkDeviceImageMemoryRequirements* info,
                                    VkMemoryRequirements2* needs) {
  driver<PFN_vkGetDeviceImageMemoryRequirements>(device, "vkGetDeviceImageMemoryRequirements")(
      device, info, needs);
  needs->memoryRequirements.memoryTypeBits |= 2u;
}

void VKAPI_CALL buffer_needs_by_info(VkDevice device, const VkDeviceBufferMemoryRequirements* info,
                                     VkMemoryRequirements2* needs) {
  driver<PFN_vkGetDeviceBufferMemoryRequirements>(device, "vkGetDeviceBufferMemoryRequirements")(
      device, info, needs);
  needs->memoryRequirements.memoryTypeBits |= 2u;
}

VkResult VKAPI_CALL allocate(VkDevice device, const VkMemoryAllocateInfo* info,
                             const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory) {
  VkMemoryAllocateInfo real = *info;
  real.memoryTypeIndex = 0;
  const VkResult result =
      driver<PFN_vkAllocateMemory>(device, "vkAllocateMemory")(device, &real, callbacks, memory);
  hidden.erase(*memory); // of a handle that was freed
  if (result == VK_SUCCESS && info->memoryTypeIndex == 1) hidden.insert(*memory);
  return result;
}

VkResult VKAPI_CALL map(VkDevice device, VkDeviceMemory memory, VkDeviceSize offset,
                        VkDeviceSize size, VkMemoryMapFlags flags, void** data) {
  if (hidden.contains(memory)) return VK_ERROR_MEMORY_MAP_FAILED;
  return driver<PFN_vkMapMemory>(device, "vkMapMemory")(device, memory, offset, size, flags, data);
}

PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char* name) {
  const auto is = [&](const char* other) { return std::strcmp(name, other) == 0; };
  const auto as = [](auto function) { return reinterpret_cast<PFN_vkVoidFunction>(function); };
  if (is("vkGetImageMemoryRequirements")) return as(&image_needs);
  if (is("vkGetBufferMemoryRequirements")) return as(&buffer_needs);
  if (is("vkGetDeviceImageMemoryRequirements")) return as(&image_needs_by_info);
  if (is("vkGetDeviceBufferMemoryRequirements")) return as(&buffer_needs_by_info);
  if (is("vkAllocateMemory")) return as(&allocate);
  if (is("vkMapMemory")) return as(&map);
  return vkGetDeviceProcAddr(device, name);
}

PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance instance, const char* name) {
  if (std::strcmp(name, "vkGetDeviceProcAddr") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&device_function);
  if (std::strcmp(name, "vkGetPhysicalDeviceMemoryProperties") == 0)
    return reinterpret_cast<PFN_vkVoidFunction>(&memory_properties);
  return vkGetInstanceProcAddr(instance, name);
}

struct DiscreteMemory : CameraTest {
  uint64_t submitted = 0;

  void SetUp() override {
    CameraTest::SetUp();
    if (!host || IsSkipped()) return;
    VkPhysicalDeviceMemoryProperties properties;
    vkGetPhysicalDeviceMemoryProperties(host->physical_device, &properties);
    if (properties.memoryTypeCount != 1) GTEST_SKIP() << "a device with several memory types";
  }
  void use_memory(bool discrete) {
    wait();
    for (const dermis_graph graph : graphs)
      dermis_graph_destroy(graph);
    graphs.clear();
    dermis_context_destroy(context);
    dermis_context_desc desc = context_desc();
    desc.frames_in_flight = frames;
    if (discrete) desc.get_instance_proc_addr = &instance_function;
    ASSERT_OK(dermis_context_create(&desc, &context));
  }
  static void set_profile(dermis_graph graph, const std::string& name) {
    const std::string text = read_text("configs/profiles/" + name + ".json");
    const dermis_source source = source_of(text, "profile.json");
    ASSERT_OK(dermis_graph_set_profile(graph, 1, &source, nullptr));
  }
  void record(dermis_view view, const Camera& camera, uint64_t index, VkCommandBuffer into) {
    dermis_frame frame = frame_of(camera, index);
    frame.command_buffer = into;
    ASSERT_OK(dermis_view_record(view, &frame));
  }
  // Records a frame as data and discards it.
  void discard(dermis_view view, const Camera& camera, uint64_t index) {
    const dermis_frame frame = frame_of(camera, index);
    uint32_t count = 0;
    const dermis_command* list = nullptr;
    ASSERT_OK(dermis_view_commands(view, &frame, &count, &list));
    ASSERT_OK(dermis_view_discard(view, index));
  }
  // Runs two views whose profile changes while frames are in flight. Returns their light.
  std::vector<std::vector<float>> run(bool discrete) {
    use_memory(discrete);
    const dermis_graph graph = make_accumulating();
    dermis_view own = dermis_graph_view(graph), other = view_of(graph);
    const Camera first = make_camera(graph, 1), second = make_camera(graph, 2);
    wait();
    for (uint64_t index = 1; index <= 9; ++index) {
      if (index % 3 == 0) set_profile(graph, "skin");
      if (index % 3 == 1) set_profile(graph, "marble");
      if (index == 6) {
        const std::string text = read_text("configs/graphs/burley.json");
        EXPECT_OK(reload_text(graph, source_of(text, "graph.json")));
      }
      submit(++submitted, [&](VkCommandBuffer into) {
        if (index % 2 == 1) discard(own, first, index);
        record(own, first, index, into);
        record(other, second, index, into);
      });
    }
    return {light_of(first), light_of(second)};
  }
};

TEST_F(DiscreteMemory, GivesEqualPictures) {
  const std::vector<std::vector<float>> expected = run(false), copied = run(true);
  EXPECT_TRUE(copied == expected);
  EXPECT_FALSE(copied[0] == copied[1]);
}

// Copies of tables, on a device that counts commands.
struct TableCopies : ::testing::Test {
  NullHost host;

  void start(bool discrete) {
    if (discrete) host.device.make_discrete();
    ASSERT_OK(host.start());
  }
  // Records a frame and returns the number of its copies of buffers.
  uint64_t copies_of_a_frame() {
    const uint64_t before = host.device.buffer_copies();
    EXPECT_OK(host.record());
    return host.device.buffer_copies() - before;
  }
  uint64_t copies_of_a_frame(dermis_view view, uint64_t index) {
    const uint64_t before = host.device.buffer_copies();
    EXPECT_OK(host.record(view, index));
    return host.device.buffer_copies() - before;
  }
};

TEST_F(TableCopies, AreNoneInHostVisibleDeviceMemory) {
  ASSERT_NO_FATAL_FAILURE(start(false));
  EXPECT_EQ(copies_of_a_frame(), 0u);
}

TEST_F(TableCopies, AreMadeOncePerViewAndProfile) {
  ASSERT_NO_FATAL_FAILURE(start(true));
  EXPECT_EQ(copies_of_a_frame(), 1u);
  EXPECT_EQ(copies_of_a_frame(), 0u);
  const uint64_t one = memory_of(host.graph).constant_bytes;
  dermis_view view = view_of(host.graph);
  EXPECT_GT(memory_of(host.graph).constant_bytes - one, 256u * 48u) << "a copy of the profiles";
  EXPECT_EQ(copies_of_a_frame(view, 1), 1u);
  EXPECT_EQ(copies_of_a_frame(view, 2), 0u);
  ASSERT_OK(host.set_profile(read_text("configs/profiles/marble.json")));
  EXPECT_EQ(copies_of_a_frame(), 1u);
  EXPECT_EQ(copies_of_a_frame(), 0u);
  EXPECT_EQ(copies_of_a_frame(view, 3), 1u);
}

TEST_F(TableCopies, AreRepeatedAfterADiscardedFrame) {
  ASSERT_NO_FATAL_FAILURE(start(true));
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(copies_of_a_frame(), 1u);
    ASSERT_OK(dermis_view_discard(dermis_graph_view(host.graph), host.last_frame--));
  }
  EXPECT_EQ(copies_of_a_frame(), 1u);
  EXPECT_EQ(copies_of_a_frame(), 0u);
  ASSERT_OK(dermis_view_discard(dermis_graph_view(host.graph), host.last_frame--));
  EXPECT_EQ(copies_of_a_frame(), 0u) << "an earlier frame made it";
}

// Constants and tables that prefer memory which is full take the host's.
TEST_F(TableCopies, AreMadeIfHostVisibleDeviceMemoryIsFull) {
  host.device.make_discrete_with_full_bar();
  ASSERT_NO_FATAL_FAILURE(start(true));
  EXPECT_EQ(copies_of_a_frame(), 1u);
  EXPECT_EQ(copies_of_a_frame(), 0u);
}

TEST_F(TableCopies, AreFreedAfterTheirFrames) {
  ASSERT_NO_FATAL_FAILURE(start(true));
  const std::string skin = read_text("configs/profiles/skin.json");
  for (int i = 0; i < 3; ++i)
    copies_of_a_frame();
  const uint64_t alive = host.device.alive(), bytes = host.device.memory_bytes();
  for (int round = 0; round < 4; ++round) {
    ASSERT_OK(host.set_profile(skin));
    EXPECT_GT(host.device.alive(), alive) << "frames in flight keep the old tables";
    for (int i = 0; i < 3; ++i)
      copies_of_a_frame();
    EXPECT_EQ(host.device.alive(), alive);
    EXPECT_EQ(host.device.memory_bytes(), bytes);
  }
}

} // namespace
} // namespace dermis::abi_test
