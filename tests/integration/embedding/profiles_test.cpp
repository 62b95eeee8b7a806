// A replaced profile leaves nothing on the device once its frames are complete.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

namespace dermis::abi_test {
namespace {

constexpr uint32_t frames_in_flight = 2;

struct Profiles : ::testing::Test {
  NullHost host;
  std::string skin = read_text("configs/profiles/skin.json"),
              marble = read_text("configs/profiles/marble.json");
  void SetUp() override { ASSERT_OK(host.start()); }
  void record(uint32_t frames) {
    for (uint32_t i = 0; i < frames; ++i)
      ASSERT_OK(host.record());
  }
};

TEST_F(Profiles, Replaced_AreFreedAfterTheirFrames) {
  record(frames_in_flight);
  const uint64_t alive = host.device.alive(), bytes = host.device.memory_bytes();
  for (int round = 0; round < 4; ++round) {
    ASSERT_OK(host.set_profile(round % 2 == 0 ? marble : skin));
    EXPECT_GT(host.device.alive(), alive) << "frames in flight keep the old tables";
    record(frames_in_flight);
    EXPECT_EQ(host.device.alive(), alive);
    EXPECT_EQ(host.device.memory_bytes(), bytes);
  }
  for (int round = 0; round < 4; ++round) { // Faster than the frames.
    ASSERT_OK(host.set_profile(marble));
  }
  record(frames_in_flight);
  EXPECT_EQ(host.device.alive(), alive);
}

TEST_F(Profiles, ViewsShareOneBuffer) {
  const dermis_memory one = memory_of(host.graph);
  view_of(host.graph);
  const dermis_memory two = memory_of(host.graph);
  EXPECT_LT(two.constant_bytes - one.constant_bytes, 256u * 48u) << "less than a table of profiles";
}

TEST_F(Profiles, OutOfMemory_KeepsTheOldOnes) {
  record(1);
  uint64_t failures = 0;
  for (uint64_t nth = 1;; ++nth) {
    const uint64_t alive = host.device.alive();
    host.device.fail_creation(nth, VK_ERROR_OUT_OF_DEVICE_MEMORY);
    const dermis_result result = host.set_profile(marble);
    host.device.fail_creation(0, VK_SUCCESS);
    if (result == DERMIS_OK) break;
    ++failures;
    EXPECT_EQ(result, DERMIS_ERROR_DEVICE_MEMORY) << dermis_last_error();
    EXPECT_EQ(host.device.alive(), alive);
    record(1);
  }
  EXPECT_GE(failures, 2u) << "a buffer and its memory";
}

} // namespace
} // namespace dermis::abi_test
