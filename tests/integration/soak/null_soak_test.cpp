// The soak test without driver and validation layer, so that only the library's memory is measured.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"
#include "tests/integration/soak/memory_counts.hpp"

namespace dermis::abi_test {
namespace {

// Creates, runs, reloads, resizes and destroys a graph and its views.
void live_once(NullHost& host) {
  constexpr uint32_t frames = 100, reload_every = 10, resize_every = 25, side = 64;
  ASSERT_OK(host.make_graph(side));
  dermis_view view = view_of(host.graph);
  host.last_frame = 0;
  for (uint32_t i = 1; i <= frames; ++i) {
    if (i % reload_every == 0) {
      ASSERT_OK(host.reload());
      ASSERT_EQ(host.reload("{ \"dermis\": 2 }"), DERMIS_ERROR_CONFIG);
    }
    if (i % resize_every == 0) { // Resizes back, too, because the host's images keep their size.
      ASSERT_OK(dermis_graph_resize(host.graph, side / 2, side / 4, nullptr));
      ASSERT_OK(dermis_graph_resize(host.graph, side, side, nullptr));
    }
    ASSERT_OK(host.record());
    ASSERT_OK(host.record(view, i));
  }
  dermis_view_destroy(view);
  dermis_graph_destroy(host.graph);
  host.graph = nullptr;
}

// 20,000 frames after 2,000 frames of warm-up. A leak of one byte per hundred frames would be 6 KiB
// of heap.
TEST(NullSoak, MemoryDoesNotGrowOverManyFrames) {
  constexpr int warm_up = 10, lives = 100;
  // Bytes; 3 KiB and 100 KiB were measured.
  constexpr int64_t heap_slack = 16 << 10, resident_slack = 1 << 20;
  NullHost host;
  ASSERT_OK(host.make_context(host.context_desc()));
  ASSERT_OK(host.make_graph());
  // Images of the null device live as long as the device, so they are created once.
  host.make_bindings();
  dermis_graph_destroy(host.graph);
  host.graph = nullptr;
  ProcessMemory warm;
  for (int life = 0; life < lives; ++life) {
    if (life == warm_up) warm = process_memory();
    ASSERT_NO_FATAL_FAILURE(live_once(host));
  }
  const ProcessMemory after = process_memory();
  RecordProperty("heap_grown_bytes", static_cast<int>(after.heap - warm.heap));
  RecordProperty("resident_grown_bytes", static_cast<int>(after.resident - warm.resident));
  EXPECT_LE(after.heap - warm.heap, heap_slack);
  EXPECT_LE(after.resident - warm.resident, resident_slack);
  EXPECT_EQ(host.device.memory_bytes(), 0u);
}

} // namespace
} // namespace dermis::abi_test
