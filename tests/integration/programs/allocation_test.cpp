// Tests host memory if operator new is the program's: recording allocates nothing, and failed
// allocations are reported and leak nothing.

#include "tests/framegraph/test_scale.hpp"
#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/recorded_frame.hpp"

#include <cstdlib>
#include <functional>
#include <new>

namespace {

// The state of operator new on this thread.
struct Allocations {
  bool counting = false;
  uint64_t count = 0;
  uint64_t fail_at = 0; // The allocation that fails, from 1; 0: none.
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

// All other forms of new and delete call these. If a delete were inlined next to its uses, gcc
// would report a mismatch.
void* operator new(size_t size) {
  return allocate(size, 0);
}
void* operator new(size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<size_t>(alignment));
}
// std::stable_sort allocates its buffer with this form.
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

// Calls `change` with its first allocation failing, then its second, until it succeeds: every one
// of the first 300, then some.
void fail_each(const std::function<dermis_result()>& change,
               const std::function<void(uint64_t)>& after) {
  constexpr uint64_t each_until = 300;
  const uint64_t step = dermis::testing::seeds_to_try(61, 1);
  uint64_t failures = 0;
  for (uint64_t number = 1;; number += number < each_until ? 1 : step) {
    allocations = {true, 0, number};
    const dermis_result result = change();
    allocations.counting = false;
    if (result == DERMIS_OK) break;
    ++failures;
    ASSERT_EQ(result, DERMIS_ERROR_MEMORY)
        << "allocation " << number << ": " << dermis_last_error();
    after(number);
  }
  EXPECT_GT(failures, 50u);
}

struct Allocation : RecordedFrame {};

TEST_F(Allocation, RecordingAllocatesNothing) {
  for (int i = 0; i < 4; ++i) {
    if (i == 2) {
      ASSERT_OK(host.reload()); // No history to copy remains.
    }
    allocations = {true, 0, 0};
    const dermis_result result = host.record();
    allocations.counting = false;
    EXPECT_OK(result);
    EXPECT_EQ(allocations.count, 0u) << "frame " << i;
  }
}

TEST_F(Allocation, RejectedFrameAllocatesNothing) {
  dermis_frame frame = DERMIS_FRAME_INIT;
  frame.command_buffer = host.device.command_buffer();
  frame.frame_index = host.last_frame + 1;
  frame.completed_frame_index = host.last_frame;
  allocations = {true, 0, 0};
  const dermis_result result = dermis_view_record(dermis_graph_view(host.graph), &frame);
  allocations.counting = false;
  EXPECT_EQ(result, DERMIS_ERROR_ARGUMENT) << "no image is bound";
  EXPECT_EQ(allocations.count, 0u);
}

// The null device allocates from the same heap; HostMemory counts leaked objects.
TEST_F(Allocation, EachFailureInAReloadIsReported) {
  fail_each(
      [&] { return host.reload(); },
      [&](uint64_t number) { ASSERT_EQ(host.record(), DERMIS_OK) << "allocation " << number; });
}

TEST_F(Allocation, HostAllocatorIsRejected) {
  dermis_allocator allocator = DERMIS_ALLOCATOR_INIT;
  allocator.allocate = [](void*, size_t, size_t) -> void* { return nullptr; };
  allocator.free = [](void*, void*, size_t, size_t) {};
  dermis_context_desc desc = host.context_desc();
  desc.allocator = &allocator;
  dermis_context context = nullptr;
  EXPECT_EQ(dermis_context_create(&desc, &context), DERMIS_ERROR_UNSUPPORTED);
  EXPECT_EQ(context, nullptr);
}

TEST(AllocationFailure, EachFailureInAValidationIsReported) {
  const std::string text = read_text("configs/graphs/burley.json");
  const dermis_source source = source_of(text, "burley.json");
  dermis_report report = nullptr;
  fail_each(
      [&] {
        const dermis_result result = dermis_validate(&source, &report);
        if (result == DERMIS_OK) dermis_report_destroy(report);
        return result;
      },
      [&](uint64_t number) { ASSERT_EQ(report, nullptr) << "allocation " << number; });
}

} // namespace
} // namespace dermis::abi_test
