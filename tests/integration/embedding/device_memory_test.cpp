// Tests device memory from a host's heaps, and a device that fails or is lost at any call.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "tests/integration/embedding/cameras.hpp"
#include "tests/integration/embedding/null_host.hpp"

namespace dermis::abi_test {
namespace {

// One block of memory per type, from which parts are allocated at odd offsets and never reused.
struct Arena {
  static constexpr uint64_t bytes = 64u << 20, first_offset = 256 * 7;
  struct Block {
    VkDeviceMemory memory = VK_NULL_HANDLE;
    uint64_t used = first_offset;
    std::byte* mapped = nullptr;
  };
  demo::VulkanHost& host;
  std::map<uint32_t, Block> blocks; // By type.
  uint64_t alive = 0, taken = 0;
  std::map<dermis_memory_purpose, uint64_t> alive_bytes;
  uint64_t rejected = 0; // Number of the call, from 1; 0: none.
  // Number of transient heaps of one view that heaps of further views overlap; 0: each view has
  // separate heaps.
  size_t overlaid = 0, transients = 0;
  std::vector<dermis_memory_block> first_view = {};

  explicit Arena(demo::VulkanHost& owner) : host(owner) {}
  ~Arena() {
    for (const auto& [type, block] : blocks)
      host.vk.vkFreeMemory(host.device, block.memory, nullptr);
  }
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  uint32_t type_for(const dermis_memory_request& request) const {
    VkPhysicalDeviceMemoryProperties properties;
    vkGetPhysicalDeviceMemoryProperties(host.physical_device, &properties);
    for (uint32_t i = 0; i < properties.memoryTypeCount; ++i)
      if ((request.memory_types >> i & 1u) != 0 &&
          (properties.memoryTypes[i].propertyFlags & request.required) == request.required)
        return i;
    return 0;
  }

  static VkResult DERMIS_CALL take(void* user, const dermis_memory_request* request,
                                   dermis_memory_block* out) {
    Arena& arena = *static_cast<Arena*>(user);
    if (++arena.taken == arena.rejected) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    const bool fractions = arena.overlaid > 0 && request->purpose == DERMIS_MEMORY_TRANSIENT;
    const size_t number = fractions ? arena.transients++ : 0;
    if (fractions && number >= arena.overlaid) {
      *out = arena.first_view[number % arena.overlaid];
      EXPECT_EQ(reinterpret_cast<uintptr_t>(out->user), request->bytes)
          << "all views request equal memory";
      ++arena.alive;
      return VK_SUCCESS;
    }
    const uint32_t type = arena.type_for(*request);
    Block& block = arena.blocks[type];
    if (block.memory == VK_NULL_HANDLE) {
      auto info = demo::vulkan_struct<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
      info.allocationSize = bytes;
      info.memoryTypeIndex = type;
      if (const VkResult result =
              arena.host.vk.vkAllocateMemory(arena.host.device, &info, nullptr, &block.memory))
        return result;
      void* mapped = nullptr; // Every memory type of the software driver can be mapped.
      if (const VkResult result = arena.host.vk.vkMapMemory(arena.host.device, block.memory, 0,
                                                            VK_WHOLE_SIZE, 0, &mapped))
        return result;
      block.mapped = static_cast<std::byte*>(mapped);
    }
    out->memory = block.memory;
    out->offset = (block.used + request->alignment - 1) / request->alignment * request->alignment;
    out->mapped = block.mapped + out->offset;
    out->user = reinterpret_cast<void*>(static_cast<uintptr_t>(request->bytes));
    block.used = out->offset + request->bytes;
    if (block.used > bytes) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    ++arena.alive;
    arena.alive_bytes[request->purpose] += request->bytes;
    if (fractions) arena.first_view.push_back(*out);
    return VK_SUCCESS;
  }
  static void DERMIS_CALL give_back(void* user, const dermis_memory_block* block) {
    Arena& arena = *static_cast<Arena*>(user);
    --arena.alive;
    EXPECT_NE(block->user, nullptr) << "the host's pointer is passed back";
  }
  dermis_device_allocator allocator() {
    dermis_device_allocator out = DERMIS_DEVICE_ALLOCATOR_INIT;
    out.allocate = take;
    out.free = give_back;
    out.user = this;
    return out;
  }
};

struct DeviceMemory : CameraTest {
  std::unique_ptr<Arena> arena;
  dermis_device_allocator allocator = DERMIS_DEVICE_ALLOCATOR_INIT;

  void use_arena() {
    arena = std::make_unique<Arena>(*host);
    allocator = arena->allocator();
    dermis_context_destroy(context);
    dermis_context_desc desc = context_desc();
    desc.frames_in_flight = frames;
    desc.device_allocator = &allocator;
    ASSERT_OK(dermis_context_create(&desc, &context));
  }
  void drop_graphs() {
    wait();
    for (const dermis_graph graph : graphs)
      dermis_graph_destroy(graph);
    graphs.clear();
  }
  void TearDown() override {
    if (host) drop_graphs();
    if (arena) {
      EXPECT_EQ(arena->alive, 0u);
    }
    InFlightTest::TearDown();
  }
  std::vector<float> light_after_five_frames() {
    const dermis_graph graph = make_accumulating();
    const Camera camera = make_camera(graph, 3);
    wait();
    for (uint64_t index = 1; index <= 5; ++index)
      submit(++submitted, [&](VkCommandBuffer into) {
        dermis_frame frame = frame_of(camera, index);
        frame.command_buffer = into;
        ASSERT_OK(dermis_view_record(dermis_graph_view(graph), &frame));
      });
    return light_of(camera);
  }
  uint64_t submitted = 0;
};

TEST_F(DeviceMemory, HostHeaps_GiveEqualPictures) {
  const std::vector<float> own = light_after_five_frames();
  drop_graphs();
  use_arena();
  EXPECT_TRUE(own == light_after_five_frames());
  EXPECT_GT(arena->taken, 3u);
  const dermis_memory memory = memory_of(graphs.front());
  EXPECT_EQ(arena->alive_bytes[DERMIS_MEMORY_TRANSIENT], memory.transient_bytes);
  EXPECT_GE(arena->alive_bytes[DERMIS_MEMORY_HISTORY], memory.history_bytes);
  EXPECT_GE(arena->alive_bytes[DERMIS_MEMORY_CONSTANTS], memory.constant_bytes);
}

// Views do not depend on each other's transients if a barrier separates the views.
TEST_F(DeviceMemory, ViewsCanShareTransientMemory) {
  constexpr uint64_t last = 6;
  constexpr size_t cameras = 3;
  const auto barrier = [&](VkCommandBuffer into) {
    auto memory = demo::vulkan_struct<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
    memory.srcStageMask = memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    memory.dstAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT | VK_ACCESS_2_MEMORY_READ_BIT;
    auto dependency = demo::vulkan_struct<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &memory;
    host->vk.vkCmdPipelineBarrier2(into, &dependency);
  };
  const auto lights = [&] {
    const dermis_graph graph = make_accumulating();
    std::vector<dermis_view> views(cameras);
    std::vector<Camera> seen;
    for (uint32_t c = 0; c < cameras; ++c) {
      EXPECT_OK(dermis_view_create(graph, nullptr, &views[c], nullptr));
      seen.push_back(make_camera(graph, 11 + c));
    }
    wait();
    for (uint64_t index = 1; index <= last; ++index)
      submit(++submitted, [&](VkCommandBuffer into) {
        for (size_t c = 0; c < cameras; ++c) {
          dermis_frame frame = frame_of(seen[c], index);
          frame.command_buffer = into;
          barrier(into);
          ASSERT_OK(dermis_view_record(views[c], &frame));
        }
      });
    std::vector<std::vector<float>> out;
    for (const Camera& camera : seen)
      out.push_back(light_of(camera));
    return out;
  };
  const auto apart = lights();
  const dermis_memory memory = memory_of(graphs.front());
  const auto heaps =
      list_of(dermis_memory_request DERMIS_MEMORY_REQUEST_INIT, dermis_graph_heaps, graphs.front());
  drop_graphs();
  use_arena();
  for (const dermis_memory_request& heap : heaps)
    arena->overlaid += heap.purpose == DERMIS_MEMORY_TRANSIENT ? 1 : 0;
  ASSERT_GT(arena->overlaid, 0u);
  EXPECT_TRUE(apart == lights());
  EXPECT_EQ(arena->transients, (1 + cameras) * arena->overlaid)
      << "the graph's own view has memory, too";
  EXPECT_EQ(arena->alive_bytes[DERMIS_MEMORY_TRANSIENT] * (1 + cameras), memory.transient_bytes);
}

TEST_F(DeviceMemory, TransientsAndHistories_AreReportedPerBlock) {
  const dermis_graph graph = make_accumulating();
  uint32_t count = 0;
  ASSERT_OK(dermis_graph_heaps(graph, &count, nullptr));
  ASSERT_GE(count, 2u);
  std::vector<dermis_memory_request> heaps(count, dermis_memory_request DERMIS_MEMORY_REQUEST_INIT);
  ASSERT_OK(dermis_graph_heaps(graph, &count, heaps.data()));
  const dermis_memory memory = memory_of(graph);
  uint64_t transient = 0, history = 0;
  for (const dermis_memory_request& heap : heaps) {
    (heap.purpose == DERMIS_MEMORY_TRANSIENT ? transient : history) += heap.bytes;
    EXPECT_NE(heap.memory_types, 0u);
    EXPECT_GE(heap.alignment, 1u);
    EXPECT_EQ(heap.alignment & (heap.alignment - 1), 0u);
  }
  EXPECT_EQ(transient, memory.transient_bytes);
  EXPECT_EQ(history, memory.history_bytes);
}

TEST_F(DeviceMemory, HostRejects_IsReportedAndNothingLeaks) {
  use_arena();
  dermis_graph graph = nullptr;
  uint64_t refusals = 0;
  for (;; ++refusals) {
    arena->taken = 0;
    arena->rejected = refusals + 1;
    const dermis_result result = create_graph(accumulating(), &graph);
    if (result == DERMIS_OK) break;
    ASSERT_EQ(result, DERMIS_ERROR_DEVICE_MEMORY) << dermis_last_error();
    ASSERT_EQ(arena->alive, 0u);
    ASSERT_THAT(dermis_last_error(), HasSubstr("the host's allocator"));
  }
  EXPECT_GE(refusals, 3u);
  arena->rejected = 0;
  dermis_graph_destroy(graph);
}

// ---- A device that rejects

enum class Change { reload, resize, view };

struct FailingNull : ::testing::TestWithParam<Change> {
  NullHost host;
  std::vector<dermis_view> views;
  uint32_t calls = 0;

  void SetUp() override {
    ASSERT_OK(host.start());
    ASSERT_OK(host.record());
  }
  dermis_result change() {
    switch (GetParam()) {
    case Change::reload:
      return host.reload();
    case Change::resize:
      return dermis_graph_resize(host.graph, 32 + ++calls % 2, 32, nullptr);
    case Change::view:
      break;
    }
    dermis_view view = nullptr;
    const dermis_result result = dermis_view_create(host.graph, nullptr, &view, nullptr);
    if (view != nullptr) views.push_back(view);
    return result;
  }
};

TEST_P(FailingNull, EachFailingCallIsReported_TheGraphRunsOn) {
  uint64_t refusals = 0;
  for (;; ++refusals) {
    const uint64_t alive = host.device.alive(), bytes = host.device.memory_bytes();
    host.device.fail_creation(refusals + 1, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    const dermis_result result = change();
    host.device.fail_creation(0, VK_SUCCESS);
    if (result == DERMIS_OK) break;
    ASSERT_EQ(result, DERMIS_ERROR_DEVICE_MEMORY) << "call " << refusals + 1;
    ASSERT_EQ(host.device.alive(), alive) << "call " << refusals + 1;
    ASSERT_EQ(host.device.memory_bytes(), bytes) << "call " << refusals + 1;
    ASSERT_OK(host.record()) << "call " << refusals + 1;
  }
  EXPECT_GT(refusals, 10u);
}

TEST_P(FailingNull, DeviceLostAtAnyCall_IsKeptAndAllIsFreed) {
  uint64_t losses = 0;
  for (;; ++losses) {
    host.device.fail_creation(losses + 1, VK_ERROR_DEVICE_LOST);
    const dermis_result result = change();
    host.device.fail_creation(0, VK_SUCCESS);
    if (result == DERMIS_OK) break;
    ASSERT_EQ(result, DERMIS_ERROR_DEVICE_LOST) << "call " << losses + 1;
    ASSERT_EQ(host.record(), DERMIS_ERROR_DEVICE_LOST);
    ASSERT_EQ(host.reload(), DERMIS_ERROR_DEVICE_LOST);
    ASSERT_EQ(dermis_graph_resize(host.graph, 16, 16, nullptr), DERMIS_ERROR_DEVICE_LOST);
    dermis_view view = nullptr;
    ASSERT_EQ(dermis_view_create(host.graph, nullptr, &view, nullptr), DERMIS_ERROR_DEVICE_LOST);
    dermis_graph another = nullptr;
    const dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
    ASSERT_EQ(dermis_graph_create(host.context, &desc, &another, nullptr),
              DERMIS_ERROR_DEVICE_LOST);
    const uint64_t images = host.device.alive();
    host.destroy();
    ASSERT_LT(host.device.alive(), images);
    ASSERT_EQ(host.device.memory_bytes(), 0u) << "call " << losses + 1;
    views.clear();
    host.last_frame = 0;
    SetUp();
  }
  EXPECT_GT(losses, 10u);
}

INSTANTIATE_TEST_SUITE_P(Changes, FailingNull,
                         testing::Values(Change::reload, Change::resize, Change::view),
                         [](const auto& one) {
                           return std::string(one.param == Change::reload   ? "Reload"
                                              : one.param == Change::resize ? "Resize"
                                                                            : "View");
                         });

TEST(LostDevice, LossInTimestamps_EndsTheContext) {
  for (const bool by_timings : {true, false}) {
    NullHost host;
    ASSERT_OK(host.start());
    ASSERT_OK(host.record());
    host.device.fail_queries(VK_ERROR_DEVICE_LOST);
    uint32_t count = 64;
    std::vector<dermis_pass_timing> times(count, dermis_pass_timing DERMIS_PASS_TIMING_INIT);
    demo::ReportedFrame choice;
    if (by_timings) {
      EXPECT_EQ(dermis_view_timings(dermis_graph_view(host.graph), 1, &count, times.data()),
                DERMIS_ERROR_DEVICE_LOST);
    } else {
      EXPECT_EQ(demo::read_reported(dermis_graph_view(host.graph), 1, choice),
                DERMIS_ERROR_DEVICE_LOST);
    }
    EXPECT_EQ(host.record(), DERMIS_ERROR_DEVICE_LOST);
  }
}

TEST(LostDevice, KnownTimesAreNotHandedOutAfterIt) {
  NullHost host;
  ASSERT_OK(host.start());
  ASSERT_OK(host.record());
  const dermis_view view = dermis_graph_view(host.graph);
  uint32_t count = 64;
  std::vector<dermis_pass_timing> times(count, dermis_pass_timing DERMIS_PASS_TIMING_INIT);
  ASSERT_OK(dermis_view_timings(view, 1, &count, times.data()));
  ASSERT_OK(host.record());
  host.device.fail_queries(VK_ERROR_DEVICE_LOST);
  demo::ReportedFrame choice;
  ASSERT_EQ(demo::read_reported(view, 2, choice), DERMIS_ERROR_DEVICE_LOST);
  host.device.fail_queries(VK_SUCCESS);
  count = 64;
  EXPECT_EQ(dermis_view_timings(view, 1, &count, times.data()), DERMIS_ERROR_DEVICE_LOST);
}

TEST(TwoContexts, TwoDevices_AreIndependent) {
  NullHost first, second;
  for (NullHost* host : {&first, &second}) {
    ASSERT_OK(host->make_context(host->context_desc()));
    ASSERT_OK(host->make_graph());
    host->make_bindings();
    ASSERT_OK(host->record());
  }
  const uint64_t alive = second.device.alive(), commands = second.device.commands();
  first.device.fail_creation(1, VK_ERROR_DEVICE_LOST);
  EXPECT_EQ(first.reload(), DERMIS_ERROR_DEVICE_LOST);
  EXPECT_EQ(first.record(), DERMIS_ERROR_DEVICE_LOST);
  first.destroy();
  EXPECT_EQ(second.device.alive(), alive);
  EXPECT_EQ(second.device.commands(), commands);
  EXPECT_OK(second.record()) << "the loss of one device does not affect the other";
}

// ---- Reloads do not accumulate memory

TEST(ManyReloads, ObjectsAndBytesStayConstant) {
  NullHost host;
  ASSERT_OK(host.start());
  dermis_view view = view_of(host.graph);
  const auto settle = [&] {
    for (int i = 0; i < 4; ++i) {
      ASSERT_OK(host.record());
      ASSERT_OK(host.record(view, host.last_frame));
    }
  };
  settle();
  const uint64_t alive = host.device.alive(), bytes = host.device.memory_bytes();
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(host.reload(i % 2 == 0 ? "" : "{ \"dermis\": 2"),
              i % 2 == 0 ? DERMIS_OK : DERMIS_ERROR_CONFIG);
    if (i % 3 == 0) {
      ASSERT_OK(host.record());
    }
  }
  settle();
  EXPECT_EQ(host.device.alive(), alive);
  EXPECT_EQ(host.device.memory_bytes(), bytes);
}

} // namespace
} // namespace dermis::abi_test
