// Tests host memory: every allocation comes from the host and is freed there. A failure of any
// allocation is reported and leaks nothing.

#include "tests/framegraph/test_scale.hpp"
#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <cstdlib>
#include <functional>

namespace dermis::abi_test {
namespace {

// Counts allocations, and rejects the requested one.
struct Heap {
  uint64_t blocks = 0, bytes = 0; // Alive.
  uint64_t calls = 0;
  uint64_t rejected = 0; // Number of the call, from 1; 0: none.
  bool misaligned = false;

  static void* DERMIS_CALL allocate(void* user, size_t size, size_t alignment) {
    Heap& heap = *static_cast<Heap*>(user);
    if (++heap.calls == heap.rejected) return nullptr;
    ++heap.blocks;
    heap.bytes += size;
    heap.misaligned = heap.misaligned || alignment < 16 || (alignment & (alignment - 1)) != 0;
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  }
  static void DERMIS_CALL release(void* user, void* memory, size_t size, size_t) {
    Heap& heap = *static_cast<Heap*>(user);
    --heap.blocks;
    heap.bytes -= size;
    std::free(memory);
  }
  dermis_allocator allocator() {
    dermis_allocator out = DERMIS_ALLOCATOR_INIT;
    out.allocate = allocate;
    out.free = release;
    out.user = this;
    return out;
  }
};

struct HostMemory : ::testing::Test {
  Heap heap;
  dermis_allocator allocator = heap.allocator();
  NullHost host;

  void SetUp() override {
    const dermis_context_desc desc = with_heap();
    const dermis_result made = host.make_context(desc);
    if (made == DERMIS_ERROR_UNSUPPORTED)
      GTEST_SKIP() << "with sanitizers the program's operator new serves the library: "
                   << dermis_last_error();
    ASSERT_OK(made);
  }
  dermis_context_desc with_heap() {
    dermis_context_desc desc = host.context_desc();
    desc.allocator = &allocator;
    return desc;
  }
  void TearDown() override {
    host.destroy();
    EXPECT_EQ(heap.blocks, 0u) << "destruction frees cached memory, too";
    EXPECT_EQ(heap.bytes, 0u);
  }
  void make_graph() {
    ASSERT_OK(host.make_graph());
    host.make_bindings();
    ASSERT_OK(host.record());
  }

  // Calls `change` with its first allocation rejected, then its second, until it succeeds: every
  // one of the first 300, then every `step`-th.
  void reject_each(uint64_t step, const std::function<dermis_result()>& change,
                   const std::function<void()>& after) {
    constexpr uint64_t each_until = 300;
    uint64_t refusals = 0;
    for (uint64_t number = 1;; number += number < each_until ? 1 : step) {
      const uint64_t blocks = heap.blocks, bytes = heap.bytes;
      const uint64_t alive = host.device.alive(), device_bytes = host.device.memory_bytes();
      heap.calls = 0;
      heap.rejected = number;
      const dermis_result result = change();
      heap.rejected = 0;
      if (result == DERMIS_OK) break;
      ++refusals;
      ASSERT_EQ(result, DERMIS_ERROR_MEMORY)
          << "allocation " << number << ": " << dermis_last_error();
      ASSERT_GE(heap.blocks, blocks)
          << "allocation " << number << ": caches may grow, but nothing may be freed";
      ASSERT_GE(heap.bytes, bytes) << "allocation " << number;
      ASSERT_EQ(host.device.alive(), alive) << "allocation " << number;
      ASSERT_EQ(host.device.memory_bytes(), device_bytes) << "allocation " << number;
      after();
    }
    RecordProperty("refusals", std::to_string(refusals));
    EXPECT_GT(refusals, 5u);
    EXPECT_FALSE(heap.misaligned);
  }
  void still_records() { ASSERT_EQ(host.record(), DERMIS_OK) << dermis_last_error(); }
  static uint64_t step() { return dermis::testing::seeds_to_try(61, 1); }
};

TEST_F(HostMemory, AllAllocationsAreFreed) {
  make_graph();
  const uint64_t running = heap.blocks;
  EXPECT_GT(running, 100u) << "the graph uses the host's memory";
  const uint64_t calls = heap.calls;
  for (int i = 0; i < 4; ++i)
    ASSERT_OK(host.record());
  EXPECT_EQ(heap.calls, calls) << "recording allocates nothing";
  dermis_report report = nullptr;
  const std::string wrong = "{";
  dermis_source source = DERMIS_SOURCE_INIT;
  source.text = wrong.data();
  source.length = wrong.size();
  EXPECT_EQ(reload_text(host.graph, source, &report), DERMIS_ERROR_CONFIG);
  host.destroy();
  EXPECT_GT(heap.blocks, 0u) << "the report stays allocated";
  EXPECT_NE(std::string(dermis_report_text(report)), "");
  dermis_report_destroy(report);
  EXPECT_EQ(heap.blocks, 0u);
  EXPECT_EQ(heap.bytes, 0u);
}

TEST_F(HostMemory, FailedContext_LeaksNothing) {
  host.destroy();
  reject_each(
      1,
      [&] {
        const dermis_result result = host.make_context(with_heap());
        EXPECT_EQ(result == DERMIS_OK, host.context != nullptr);
        return result;
      },
      [] {});
}

TEST_F(HostMemory, FailedGraph_LeaksNothing) {
  reject_each(
      step(), [&] { return host.make_graph(); }, [&] { EXPECT_EQ(host.graph, nullptr); });
}

TEST_F(HostMemory, FailedReload_KeepsTheGraph) {
  make_graph();
  reject_each(
      step(), [&] { return host.reload(); }, [&] { still_records(); });
}

TEST_F(HostMemory, FailedShaderReload_KeepsTheGraph) {
  make_graph();
  uint32_t requested = 0;
  if (dermis_graph_reload_shaders(host.graph, open_kernel, &requested, nullptr) ==
      DERMIS_ERROR_UNSUPPORTED)
    GTEST_SKIP() << "this library compiles no shaders; test_shared_shaders is the one that does";
  still_records();
  ASSERT_OK(dermis_graph_reload_shaders(host.graph, nullptr, nullptr, nullptr));
  reject_each(
      step(),
      [&] { return dermis_graph_reload_shaders(host.graph, open_kernel, &requested, nullptr); },
      [&] { still_records(); });
  EXPECT_GT(requested, 0u);
}

TEST_F(HostMemory, FailedResize_KeepsTheGraph) {
  make_graph();
  uint32_t calls = 0; // few sizes, so that the cache of plans drops none
  reject_each(
      step(), [&] { return dermis_graph_resize(host.graph, 32 + ++calls % 3, 32, nullptr); },
      [&] { still_records(); });
}

TEST_F(HostMemory, FailedSetting_KeepsTheGraph) {
  make_graph();
  reject_each(
      1, [&] { return dermis_graph_set_setting(host.graph, "accumulate_clip", "2", nullptr); },
      [&] { still_records(); });
}

TEST_F(HostMemory, FailedPipelines_KeepTheGraph) {
  make_graph();
  reject_each(
      1, [&] { return dermis_graph_set_setting(host.graph, "texturing", "\"pre\"", nullptr); },
      [&] { still_records(); });
  heap.calls = 0;
  for (int i = 0; i < 4; ++i)
    ASSERT_OK(host.record());
  EXPECT_EQ(heap.calls, 0u) << "switching to the new pipelines allocates nothing";
}

TEST_F(HostMemory, FailedProfile_KeepsTheGraph) {
  make_graph();
  const std::string marble = read_text("configs/profiles/marble.json");
  reject_each(
      1, [&] { return host.set_profile(marble); }, [&] { still_records(); });
  heap.calls = 0;
  for (int i = 0; i < 4; ++i)
    ASSERT_OK(host.record());
  EXPECT_EQ(heap.calls, 0u) << "switching to the new tables allocates nothing";
}

TEST_F(HostMemory, FailedViewSetting_KeepsTheView) {
  make_graph();
  dermis_view view = view_of(host.graph);
  uint64_t index = 0;
  reject_each(
      1, [&] { return dermis_view_set_setting(view, "accumulate_weight", "0.5", nullptr); },
      [&] { ASSERT_EQ(host.record(view, ++index), DERMIS_OK) << dermis_last_error(); });
}

TEST_F(HostMemory, FailedBudget_KeepsTheGraph) {
  make_graph();
  size_t size = 0;
  ASSERT_OK(dermis_graph_calibration(host.graph, &size, nullptr));
  std::string text(size, '\0');
  ASSERT_OK(dermis_graph_calibration(host.graph, &size, text.data()));
  dermis_source calibration = DERMIS_SOURCE_INIT;
  calibration.text = text.data();
  calibration.length = size - 1;
  dermis_budget budget = DERMIS_BUDGET_INIT;
  budget.milliseconds = 1;
  budget.calibration = &calibration;
  reject_each(
      step(), [&] { return dermis_graph_set_budget(host.graph, &budget, nullptr); },
      [&] { still_records(); });
}

TEST_F(HostMemory, FailedMemoryBudget_KeepsTheGraph) {
  make_graph();
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  desc.keep = DERMIS_KEEP_ALL & ~DERMIS_KEEP_MEMORY;
  desc.max_bytes = 1; // no plan fits: reported
  reject_each(
      step(), [&] { return dermis_graph_reload(host.graph, &desc, nullptr); },
      [&] { still_records(); });
}

TEST_F(HostMemory, FailedView_LeaksNothing) {
  make_graph();
  dermis_view view = nullptr;
  reject_each(
      1, [&] { return dermis_view_create(host.graph, nullptr, &view, nullptr); },
      [&] {
        EXPECT_EQ(view, nullptr);
        still_records();
      });
  EXPECT_OK(host.record(view, 1));
}

// A new view each time, because a list keeps its capacity.
TEST_F(HostMemory, FailedCommandList_LeavesNoFrame) {
  make_graph();
  const dermis_frame frame = host.frame_at(1);
  for (uint64_t number = 1;; ++number) {
    dermis_view view = view_of(host.graph);
    uint32_t count = 1;
    const dermis_command* commands = nullptr;
    heap.calls = 0;
    heap.rejected = number;
    const dermis_result result = dermis_view_commands(view, &frame, &count, &commands);
    heap.rejected = 0;
    if (result != DERMIS_OK) {
      ASSERT_EQ(result, DERMIS_ERROR_MEMORY)
          << "allocation " << number << ": " << dermis_last_error();
      EXPECT_EQ(count, 0u);
      EXPECT_EQ(commands, nullptr);
      EXPECT_OK(dermis_view_commands(view, &frame, &count, &commands));
    }
    EXPECT_GT(count, 10u);
    dermis_view_destroy(view);
    if (result == DERMIS_OK) {
      EXPECT_GT(number, 5u) << "a command list allocates memory";
      break;
    }
  }
}

// A list keeps its capacity, so each failure has a view of its own.
TEST_F(HostMemory, FailedCommandList_FrameBeforeCanBeDiscarded) {
  make_graph();
  for (uint64_t number = 1;; ++number) {
    dermis_view view = view_of(host.graph);
    ASSERT_OK(host.record(view, 1));
    const dermis_frame frame = host.frame_at(2);
    uint32_t count = 0;
    const dermis_command* commands = nullptr;
    heap.calls = 0;
    heap.rejected = number;
    const dermis_result result = dermis_view_commands(view, &frame, &count, &commands);
    heap.rejected = 0;
    if (result == DERMIS_OK) {
      dermis_view_destroy(view);
      break;
    }
    ASSERT_EQ(result, DERMIS_ERROR_MEMORY);
    ASSERT_EQ(dermis_view_discard(view, 1), DERMIS_OK)
        << "allocation " << number << ": " << dermis_last_error();
    EXPECT_EQ(dermis_view_discard(view, 1), DERMIS_ERROR_ARGUMENT) << "only once";
    EXPECT_OK(host.record(view, 1));
    dermis_view_destroy(view);
  }
}

TEST_F(HostMemory, FailedPassType_IsNotRegistered) {
  const auto exported = [&] { return text_from(dermis_export_pass_types, host.context); };
  const std::string before = exported();
  const dermis_port ports[] = {
      port_of("a_picture_that_is_changed", DERMIS_PORT_STORAGE_IMAGE_UPDATE),
      port_of("a_picture_that_is_only_read", DERMIS_PORT_SAMPLED_IMAGE)};
  dermis_pass_setting weight = real_setting("weight", 1);
  dermis_pass_type type = pass_type_of(
      "studio.mix", ports, [](void*, const dermis_pass_call*) {}, nullptr);
  type.settings = &weight;
  type.setting_count = 1;
  reject_each(
      1, [&] { return dermis_register_pass_type(host.context, &type); },
      [&] { ASSERT_EQ(exported(), before); });
  EXPECT_NE(exported(), before);
}

// Queries change nothing; a rejected query can be repeated.
TEST_F(HostMemory, FailedQuery_CanBeRepeated) {
  make_graph();
  uint32_t count = 0;
  size_t size = 0;
  dermis_memory memory = DERMIS_MEMORY_INIT;
  const std::function<dermis_result()> questions[] = {
      [&] { return dermis_graph_describe(host.graph, DERMIS_DESCRIBE_JSON, &size, nullptr); },
      [&] { return dermis_graph_describe(host.graph, DERMIS_DESCRIBE_DOT, &size, nullptr); },
      [&] { return dermis_graph_describe(host.graph, DERMIS_DESCRIBE_TEXT, &size, nullptr); },
      [&] { return dermis_graph_calibration(host.graph, &size, nullptr); },
      [&] { return dermis_graph_memory(host.graph, &memory); },
      [&] { return dermis_graph_heaps(host.graph, &count, nullptr); },
      [&] { return dermis_graph_slots(host.graph, &count, nullptr); },
      [&] { return dermis_view_settings(dermis_graph_view(host.graph), &count, nullptr); },
      [&] { return dermis_view_histories(dermis_graph_view(host.graph), &count, nullptr); },
  };
  uint64_t refusals = 0;
  for (const auto& ask : questions)
    for (uint64_t number = 1;; number += number < 100 ? 1 : 61) {
      const uint64_t blocks = heap.blocks;
      heap.calls = 0;
      heap.rejected = number;
      const dermis_result result = ask();
      heap.rejected = 0;
      ASSERT_EQ(heap.blocks, blocks) << "allocation " << number;
      if (result == DERMIS_OK) break;
      ++refusals;
      ASSERT_EQ(result, DERMIS_ERROR_MEMORY)
          << "allocation " << number << ": " << dermis_last_error();
    }
  EXPECT_GT(refusals, 50u);
  still_records();
}

TEST_F(HostMemory, RecordingAFrame_AllocatesNothing) {
  make_graph();
  heap.calls = 0;
  heap.rejected = 1;
  EXPECT_OK(host.record());
  EXPECT_EQ(heap.calls, 0u);
  ASSERT_EQ(host.reload(), DERMIS_ERROR_MEMORY);
  heap.rejected = 0;
  ASSERT_OK(host.reload());
  heap.calls = 0;
  EXPECT_OK(host.record()) << "switching plans allocates nothing";
  EXPECT_EQ(heap.calls, 0u);
}

TEST_F(HostMemory, Forecasts_AllocateNothing) {
  make_graph();
  std::vector<dermis_outcome> outcomes(64, dermis_outcome DERMIS_OUTCOME_INIT);
  dermis_forecast_desc desc = DERMIS_FORECAST_DESC_INIT;
  desc.width = desc.height = 16;
  for (const float ms : {0.0f, 1.0f}) { // with and without a budget
    desc.milliseconds = ms;
    uint32_t count = 64;
    heap.calls = 0;
    heap.rejected = 1;
    EXPECT_OK(dermis_graph_frontier(host.graph, &desc, &count, outcomes.data()));
    EXPECT_OK(dermis_graph_predict(host.graph, &desc, outcomes.data()));
    EXPECT_EQ(heap.calls, 0u);
    heap.rejected = 0;
  }
}

TEST_F(HostMemory, HalfAnAllocatorIsRejected) {
  host.destroy();
  allocator.free = nullptr;
  EXPECT_THAT(host.make_context(with_heap()),
              Fails(DERMIS_ERROR_ARGUMENT, "desc.allocator.free is NULL"));
}

} // namespace
} // namespace dermis::abi_test
