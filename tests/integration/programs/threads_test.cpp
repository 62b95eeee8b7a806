// Tests the thread contract of dermis.h. The thread sanitizer checks these tests with the preset
// `tsan`.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <atomic>
#include <functional>
#include <thread>

namespace dermis::abi_test {
namespace {

constexpr uint64_t frames = 300;
constexpr int changes = 48;

struct Threads : ::testing::Test {
  NullHost host;
  std::string skin = read_text("configs/profiles/skin.json"),
              dipole = read_text("configs/profiles/skin_dipole.json");
  void SetUp() override {
    host.device.make_discrete(); // views copy tables
    ASSERT_OK(host.start());
  }
  // Runs all jobs concurrently.
  static void run(const std::vector<std::function<void()>>& jobs) {
    std::vector<std::thread> threads;
    for (const auto& job : jobs)
      threads.emplace_back(job);
    for (std::thread& thread : threads)
      thread.join();
  }
  void change(int number) const {
    switch (number % 8) {
    case 0:
      EXPECT_OK(host.reload());
      break;
    case 1:
      EXPECT_EQ(host.reload("{ \"dermis\": 2"), DERMIS_ERROR_CONFIG);
      break;
    case 2:
      EXPECT_OK(
          dermis_graph_resize(host.graph, 33 + static_cast<uint32_t>(number) % 20, 40, nullptr));
      break;
    case 3:
      EXPECT_OK(dermis_graph_set_setting(host.graph, "accumulate_weight", "0.25", nullptr));
      break;
    case 4: {
      dermis_budget budget = DERMIS_BUDGET_INIT;
      budget.milliseconds = static_cast<float>(number % 3);
      if (number % 5 == 0) budget.flags = DERMIS_BUDGET_ALL_VIEWS;
      EXPECT_OK(dermis_graph_set_budget(host.graph, &budget, nullptr));
      break;
    }
    case 5:
      EXPECT_OK(host.set_profile(number % 3 == 0 ? skin : dipole));
      break;
    case 6: {
      const dermis_result removed = dermis_graph_set_profile(host.graph, 1, nullptr, nullptr);
      EXPECT_TRUE(removed == DERMIS_OK || removed == DERMIS_ERROR_ARGUMENT)
          << "another thread was first";
      EXPECT_OK(host.set_profile(skin));
      break;
    }
    default: {
      memory_of(host.graph);
      uint32_t count = 0;
      EXPECT_OK(dermis_graph_slots(host.graph, &count, nullptr));
      EXPECT_OK(dermis_view_settings(dermis_graph_view(host.graph), &count, nullptr));
      EXPECT_OK(dermis_graph_heaps(host.graph, &count, nullptr));
      size_t size = 0;
      EXPECT_OK(dermis_graph_describe(host.graph, DERMIS_DESCRIBE_TEXT, &size, nullptr));
      EXPECT_OK(dermis_graph_calibration(host.graph, &size, nullptr));
      dermis_outcome outcome = DERMIS_OUTCOME_INIT;
      EXPECT_OK(dermis_graph_frontier(host.graph, nullptr, &count, nullptr));
      EXPECT_OK(dermis_graph_predict(host.graph, nullptr, &outcome));
      break;
    }
    }
  }
};

TEST_F(Threads, TwoGraphsOfOneContext_RecordConcurrently) {
  NullHost other; // Uses the context of the first host.
  other.context = host.context;
  ASSERT_OK(other.make_graph(48));
  other.make_bindings();
  const auto record = [](NullHost& one) {
    for (uint64_t i = 0; i < frames; ++i)
      ASSERT_OK(one.record());
  };
  run({[&] { record(host); }, [&] { record(other); }});
  dermis_graph_destroy(other.graph);
  other.graph = nullptr;
  other.context = nullptr;
}

TEST_F(Threads, GraphChangesWhileAnotherThreadRecords) {
  std::atomic<bool> changing = true;
  run({[&] {
         uint64_t recorded = 0;
         while (changing || recorded < frames) {
           ASSERT_OK(host.record());
           ++recorded;
         }
       },
       [&] {
         for (int i = 0; i < changes; ++i)
           change(i);
         changing = false;
       }});
  EXPECT_OK(host.record());
}

TEST_F(Threads, ViewsRecordInThreadsWhileTheGraphChanges) {
  dermis_view views[2] = {nullptr, nullptr};
  for (dermis_view& view : views)
    ASSERT_OK(dermis_view_create(host.graph, nullptr, &view, nullptr));
  const auto record = [&](dermis_view view) {
    for (uint64_t index = 1; index <= frames; ++index) {
      ASSERT_OK(host.record(view, index));
      if (index % 16 == 0) {
        ASSERT_OK(dermis_view_set_setting(view, "accumulate_weight",
                                          index % 32 == 0 ? "0.5" : nullptr, nullptr));
      }
      demo::ReportedFrame choice;
      ASSERT_GE(demo::read_reported(view, index - 1, choice), DERMIS_OK) << dermis_last_error();
    }
  };
  const auto change_some = [&] {
    for (int i = 0; i < changes / 2; ++i)
      change(i);
  };
  run({[&] { record(views[0]); }, [&] { record(views[1]); }, change_some, change_some});
  dermis_view_destroy(views[0]); // The other view is destroyed with its graph.
}

TEST_F(Threads, GraphsAreCreatedAndDestroyedOnAllThreads) {
  const auto live = [&] {
    for (int i = 0; i < 4; ++i) {
      NullHost other;
      other.context = host.context;
      ASSERT_OK(other.make_graph(32));
      other.make_bindings();
      ASSERT_OK(other.record());
      dermis_graph_destroy(other.graph);
      other.graph = nullptr;
      other.context = nullptr;
    }
  };
  run({live, live, live});
  // A new context without kernels: several threads create equal kernels concurrently.
  host.destroy();
  const dermis_context_desc desc = host.context_desc();
  ASSERT_OK(host.make_context(desc));
  run({live, live, live});
}

} // namespace
} // namespace dermis::abi_test
