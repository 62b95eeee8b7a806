#pragma once
// A graph on a null device with one recorded frame.

#include "tests/integration/embedding/null_host.hpp"

namespace dermis::abi_test {

struct RecordedFrame : ::testing::Test {
  NullHost host;
  void SetUp() override {
    ASSERT_EQ(host.make_context(host.context_desc()), DERMIS_OK) << dermis_last_error();
    ASSERT_EQ(host.make_graph(), DERMIS_OK) << dermis_last_error();
    host.make_bindings();
    ASSERT_EQ(host.record(), DERMIS_OK) << dermis_last_error();
  }
};

} // namespace dermis::abi_test
