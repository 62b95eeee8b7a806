// Host memory: recording takes none, and running out of it is told and leaves nothing behind.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <cstdlib>
#include <new>

namespace {

// What operator new does on this thread.
struct Allocations {
  bool counting = false;
  uint64_t count = 0;
  uint64_t fail_at = 0; // the allocation that fails, from 1; 0: none
};
constinit thread_local Allocations allocations;

void* allocate(size_t size, size_t alignment) {
  if (allocations.counting && ++allocations.count == allocations.fail_at) throw std::bad_alloc();
  void* memory = alignment > alignof(std::max_align_t)
                     ? std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment)
                     : std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

} // namespace

// All other forms of new and delete call these. Inlined next to its uses, a delete looks mismatched to gcc.
void* operator new(size_t size) {
  return allocate(size, 0);
}
void* operator new(size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<size_t>(alignment));
}
// std::stable_sort asks for its buffer so.
void* operator new(size_t size, const std::nothrow_t&) noexcept {
  try {
    return allocate(size, 0);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace dermis::abi_test {
namespace {

// The validation layer allocates inside of Vulkan calls, so this suite runs without it.
struct Allocation : DermisTest {
  static void SetUpTestSuite() {
    auto made = demo::create_vulkan_host({.validation = false, .device = ""});
    if (made) host = made.take();
  }
};

TEST_F(Allocation, RecordingTakesNoHostMemory) {
  const dermis_graph graph = make_graph();
  ASSERT_NE(graph, nullptr);
  make_images(graph);
  const auto bound = bindings(graph);
  for (int i = 0; i < 4; ++i) {
    dermis_frame one = frame(bound);
    const auto ran = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
      one.command_buffer = commands;
      allocations = {true, 0, 0};
      const dermis_result result = dermis_graph_record(graph, &one);
      allocations.counting = false;
      EXPECT_EQ(result, DERMIS_OK) << dermis_last_error();
      return demo::success();
    });
    ASSERT_TRUE(ran);
    last_frame = one.frame_index;
    EXPECT_EQ(allocations.count, 0u) << "frame " << i;
  }
}

TEST_F(Allocation, ARefusedFrameTakesNoHostMemoryEither) {
  const dermis_graph graph = make_graph();
  ASSERT_NE(graph, nullptr);
  dermis_frame one = frame({});
  one.command_buffer = reinterpret_cast<VkCommandBuffer>(uintptr_t{8}); // refused before it is used
  one.bindings = nullptr;
  logged.reserve(100);
  allocations = {true, 0, 0};
  const dermis_result result = dermis_graph_record(graph, &one);
  allocations.counting = false;
  EXPECT_EQ(result, DERMIS_ERROR_ARGUMENT);
  EXPECT_LE(allocations.count, 1u) << "the test's own log callback copies the text";
}

TEST(AllocationFailure, EachFailedAllocationOfAValidationIsToldAndTheNextCallWorks) {
  const std::string text = read_text("configs/graphs/burley.json");
  const dermis_source source = source_of(text, "burley.json");
  dermis_result result = DERMIS_ERROR_MEMORY;
  uint64_t failed = 0;
  while (result != DERMIS_OK) {
    dermis_report report = nullptr;
    allocations = {true, 0, failed + 1};
    result = dermis_validate(&source, &report);
    allocations.counting = false;
    if (result != DERMIS_OK) {
      ASSERT_EQ(result, DERMIS_ERROR_MEMORY) << "allocation " << failed + 1 << ": " << dermis_last_error();
      ASSERT_EQ(report, nullptr);
      ++failed;
    }
    dermis_report_destroy(report);
  }
  EXPECT_GT(failed, 50u) << "the validation allocates more than that";
}

} // namespace
} // namespace dermis::abi_test
