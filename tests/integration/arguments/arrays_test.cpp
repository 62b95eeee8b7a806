// Tests two-call queries: the first call returns the count, the second all elements or as many as
// fit.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <cstring>
#include <functional>

namespace dermis::abi_test {
namespace {

struct TwoCalls : ::testing::Test {
  NullHost host;
  dermis_view view = nullptr;
  void SetUp() override {
    ASSERT_OK(host.start());
    ASSERT_OK(dermis_view_create(host.graph, nullptr, &view, nullptr));
    ASSERT_OK(host.record());
    ASSERT_OK(host.record(view, 1));
  }
};

constexpr unsigned char untouched = 0xa5;

template <class T> std::vector<std::byte> bytes_of(const T& value) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&value);
  return {bytes, bytes + sizeof value};
}

template <class T>
void expect_array_property(const std::function<dermis_result(uint32_t*, T*)>& ask) {
  uint32_t count = 0;
  ASSERT_OK(ask(&count, nullptr));
  ASSERT_GT(count, 0u);
  const uint32_t all = count;
  EXPECT_THAT(ask(nullptr, nullptr), Fails(DERMIS_ERROR_ARGUMENT, "count is NULL"));
  for (uint32_t space = 0; space <= all + 1; ++space) {
    std::vector<T> items(all + 1);
    std::memset(items.data(), untouched, items.size() * sizeof(T));
    items[0].struct_size = sizeof(T);
    count = space;
    EXPECT_EQ(ask(&count, items.data()), space < all ? DERMIS_INCOMPLETE : DERMIS_OK)
        << space << " of " << all;
    EXPECT_EQ(count, all);
    for (uint32_t i = 0; i < items.size(); ++i) {
      if (i < space && i < all) {
        EXPECT_EQ(items[i].struct_size, sizeof(T)) << i;
      } else if (i > 0) {
        EXPECT_THAT(bytes_of(items[i]), Each(std::byte{untouched}))
            << i << ": the capacity is " << space;
      }
    }
  }
  T item{};
  for (const size_t size : {size_t{0}, sizeof(size_t), sizeof(T) - 1}) {
    item.struct_size = size;
    count = 1;
    EXPECT_THAT(ask(&count, &item), Fails(DERMIS_ERROR_ARGUMENT, "array[0].struct_size")) << size;
  }
  // A newer caller's elements are larger; the library fills their unknown fields with zeros.
  struct Newer {
    T known;
    uint64_t later;
  };
  std::vector<Newer> newer(all);
  std::memset(newer.data(), untouched, all * sizeof(Newer));
  newer[0].known.struct_size = sizeof(Newer);
  count = all;
  ASSERT_OK(ask(&count, &newer[0].known));
  for (const Newer& one : newer) {
    EXPECT_EQ(one.known.struct_size, sizeof(Newer));
    EXPECT_EQ(one.later, 0u);
  }
}

TEST_F(TwoCalls, FillAtMostTheCapacity) {
  expect_array_property<dermis_requirement>([&](uint32_t* count, dermis_requirement* items) {
    return dermis_query_requirements(NullDevice::loader(), host.device.instance(),
                                     host.device.physical(), count, items);
  });
  expect_array_property<dermis_slot>([&](uint32_t* count, dermis_slot* items) {
    return dermis_graph_slots(host.graph, count, items);
  });
  expect_array_property<dermis_setting>([&](uint32_t* count, dermis_setting* items) {
    return dermis_view_settings(dermis_graph_view(host.graph), count, items);
  });
  expect_array_property<dermis_setting>([&](uint32_t* count, dermis_setting* items) {
    return dermis_view_settings(view, count, items);
  });
  expect_array_property<dermis_memory_request>([&](uint32_t* count, dermis_memory_request* items) {
    return dermis_graph_heaps(host.graph, count, items);
  });
  expect_array_property<dermis_outcome>([&](uint32_t* count, dermis_outcome* items) {
    return dermis_graph_frontier(host.graph, nullptr, count, items);
  });
  expect_array_property<dermis_pass_timing>([&](uint32_t* count, dermis_pass_timing* items) {
    return dermis_view_timings(dermis_graph_view(host.graph), 1, count, items);
  });
  expect_array_property<dermis_pass_timing>([&](uint32_t* count, dermis_pass_timing* items) {
    return dermis_view_timings(view, 1, count, items);
  });
  expect_array_property<dermis_history>([&](uint32_t* count, dermis_history* items) {
    return dermis_view_histories(dermis_graph_view(host.graph), count, items);
  });
  expect_array_property<dermis_history>([&](uint32_t* count, dermis_history* items) {
    return dermis_view_histories(view, count, items);
  });
}

void expect_text_property(const std::function<dermis_result(size_t*, char*)>& ask) {
  EXPECT_THAT(ask(nullptr, nullptr), Fails(DERMIS_ERROR_ARGUMENT, "size is NULL"));
  size_t size = 0;
  ASSERT_OK(ask(&size, nullptr));
  ASSERT_GT(size, 2u);
  const size_t all = size;
  for (const size_t space : {size_t{0}, size_t{1}, all - 1}) {
    std::string text(all, static_cast<char>(untouched));
    size = space;
    EXPECT_EQ(ask(&size, text.data()), DERMIS_INCOMPLETE) << space;
    EXPECT_EQ(size, all);
    EXPECT_EQ(text, std::string(all, static_cast<char>(untouched))) << "the text is not truncated";
  }
  std::string text(all + 1, static_cast<char>(untouched));
  size = all + 1;
  ASSERT_OK(ask(&size, text.data()));
  EXPECT_EQ(size, all);
  EXPECT_EQ(std::strlen(text.c_str()), all - 1) << "the final 0 is counted";
}

TEST_F(TwoCalls, TextIsWrittenCompletelyOrNotAtAll) {
  for (const dermis_describe_format format :
       {DERMIS_DESCRIBE_JSON, DERMIS_DESCRIBE_DOT, DERMIS_DESCRIBE_TEXT})
    expect_text_property([&](size_t* size, char* text) {
      return dermis_graph_describe(host.graph, format, size, text);
    });
  expect_text_property(
      [&](size_t* size, char* text) { return dermis_graph_calibration(host.graph, size, text); });
  expect_text_property(
      [&](size_t* size, char* text) { return dermis_export_pass_types(host.context, size, text); });
}

// A host may count frames that a view does not record.
TEST_F(TwoCalls, LaterFramesAreTheNewestRecordedFrame) {
  uint32_t count = 0;
  demo::ReportedFrame choice;
  for (const uint64_t completed : {uint64_t{1}, uint64_t{2}, ~uint64_t{0}}) {
    EXPECT_OK(dermis_view_timings(dermis_graph_view(host.graph), completed, &count, nullptr));
    EXPECT_OK(demo::read_reported(dermis_graph_view(host.graph), completed, choice));
    EXPECT_EQ(choice.demo::ReportedFrame::frame_index, 1u);
    EXPECT_OK(demo::read_reported(view, completed, choice));
  }
}

} // namespace
} // namespace dermis::abi_test
