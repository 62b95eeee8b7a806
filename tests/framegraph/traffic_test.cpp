// Tests the count of bytes per covered pixel of a plan.
#include "framegraph/explain/traffic.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {
namespace {

constexpr DispatchRule whole_view{};
constexpr DispatchRule listed{.name = "listed", .domain = DispatchRule::Domain::indirect};
constexpr DispatchRule host{.name = "host", .domain = DispatchRule::Domain::host};
constexpr TrafficAssumptions assumptions{.covered = 0.25, .flagged = 0.5, .flagged_fine = 0.125};
constexpr double tolerance = 1e-12; // sums of a few doubles near 1 to 100

// A plan with one pass over a view of 64x64 pixels.
class Traffic : public ::testing::Test {
protected:
  Traffic() { plan.view_width = plan.view_height = 64; }

  uint32_t image(Format format, uint32_t side, uint32_t mips = 1) {
    PlanResource resource;
    resource.format = format;
    resource.width = resource.height = side;
    resource.mips = mips;
    plan.resources.push_back(resource);
    return static_cast<uint32_t>(plan.resources.size() - 1);
  }
  uint32_t buffer(uint64_t bytes) {
    PlanResource resource;
    resource.type = ResourceType::buffer;
    resource.bytes = bytes;
    plan.resources.push_back(resource);
    return static_cast<uint32_t>(plan.resources.size() - 1);
  }
  PlanAccess& access(Usage usage, uint32_t resource,
                     AccessExtent extent = AccessExtent::dispatched) {
    ports.push_back({"port", usage, false, "texture2D", "", {}, false, extent});
    PlanAccess made;
    made.port = static_cast<uint32_t>(ports.size() - 1);
    made.resource = resource;
    made.range = plan.resources[resource].whole();
    made.access = usage_info(usage).access;
    plan.accesses.push_back(made);
    return plan.accesses.back();
  }
  PassTraffic count(const DispatchRule& dispatch) {
    PassType type;
    type.name = "test.pass";
    type.ports = ports;
    type.dispatch = dispatch;
    PassTypeRegistry pass_types;
    PlanPass pass;
    pass.type = pass_types.add(type);
    pass.access_count = static_cast<uint32_t>(plan.accesses.size());
    plan.passes = {pass};
    return count_traffic(plan, pass_types, assumptions).front();
  }

  Plan plan;
  std::vector<Port> ports;
};

TEST_F(Traffic, ListedPassesCountTheirTexels) {
  access(Usage::sampled_image, image(Format::rgba16f, 64));
  access(Usage::sampled_image, image(Format::rgba32_uint, 32));
  access(Usage::storage_image_write, image(Format::r32f, 64));
  const PassTraffic traffic = count(listed);
  EXPECT_NEAR(traffic.read, 8.0 + 16.0 / 4, tolerance);
  EXPECT_NEAR(traffic.written, 4.0, tolerance);
}

TEST_F(Traffic, PassesOverTheViewReadUncoveredPixels) {
  access(Usage::sampled_image, image(Format::r8_uint, 64));
  access(Usage::sampled_image, image(Format::d32f, 64), AccessExtent::covered);
  access(Usage::storage_image_write, image(Format::rgba16f, 64), AccessExtent::flagged);
  const PassTraffic traffic = count(whole_view);
  EXPECT_NEAR(traffic.read, 1.0 / 0.25 + 4.0, tolerance);
  EXPECT_NEAR(traffic.written, 8.0 * 0.125, tolerance);
}

TEST_F(Traffic, FlaggedTexels_DependOnTheResolution) {
  access(Usage::sampled_image, image(Format::rgba16f, 32), AccessExtent::flagged);
  access(Usage::storage_image_write, image(Format::rgba16f, 31), AccessExtent::flagged);
  const PassTraffic traffic = count(listed);
  EXPECT_NEAR(traffic.read, 8.0 / 4 * 0.125, tolerance);
  EXPECT_NEAR(traffic.written, 8.0 * 31 * 31 / (64 * 64) * 0.5, tolerance);
}

TEST_F(Traffic, UpdatesCountInBothDirections) {
  access(Usage::storage_image_update, image(Format::rgba16f, 64));
  const PassTraffic traffic = count(listed);
  EXPECT_NEAR(traffic.read, 8.0, tolerance);
  EXPECT_NEAR(traffic.written, 8.0, tolerance);
}

TEST_F(Traffic, OnlyTheMipsOfThePortCount) {
  PlanAccess& read = access(Usage::sampled_image, image(Format::r32f, 64, 4));
  read.range.first_mip = 1;
  read.range.mips = 2;
  EXPECT_NEAR(count(listed).read, 4.0 / 4 + 4.0 / 16, tolerance);
}

TEST_F(Traffic, ListsShrinkWithTheWrittenImage) {
  access(Usage::storage_buffer_read, buffer(64 * 64 * 2));
  access(Usage::storage_image_write, image(Format::r32f, 16));
  EXPECT_NEAR(count(listed).read, 2.0 / 16, tolerance);
}

TEST_F(Traffic, ListsWithBytesPerTile_CountTheWrittenTiles) {
  access(Usage::storage_buffer_read, buffer(64 * 64 * 2));
  ports.back().bytes_per_tile = 8;
  access(Usage::storage_image_write, image(Format::r32f, 32));
  EXPECT_NEAR(count(listed).read, 8.0 * (4 * 4) / (64 * 64), tolerance);
}

TEST_F(Traffic, FallbacksOfHistoriesDoNotCount) {
  const uint32_t history = image(Format::rgba16f, 64);
  access(Usage::sampled_image, history).when = ReadWhen::history_valid;
  access(Usage::sampled_image, image(Format::rgba32f, 64)).when = ReadWhen::history_invalid;
  access(Usage::indirect_arguments, buffer(16));
  EXPECT_NEAR(count(listed).read, 8.0, tolerance);
}

TEST_F(Traffic, PassesOfTheHostDoNotCount) {
  access(Usage::sampled_image, image(Format::rgba16f, 64));
  EXPECT_EQ(count(host).read, 0.0);
}

} // namespace
} // namespace dermis::testing
