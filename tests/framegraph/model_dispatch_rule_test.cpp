#include "framegraph/model/dispatch_rule.hpp"

#include <gtest/gtest.h>

namespace dermis {
namespace {

using Domain = DispatchRule::Domain;

void expect_groups(const DispatchRule& rule, uint64_t width, uint64_t height, uint64_t x,
                   uint64_t y) {
  const GroupCount groups = group_count(rule, width, height);
  EXPECT_EQ(groups.x, x);
  EXPECT_EQ(groups.y, y);
  EXPECT_EQ(groups.z, 1u);
}

TEST(DispatchRuleTest, PartialCellsCountAsWholeGroups) {
  expect_groups({}, 64, 64, 8, 8);
  expect_groups({}, 65, 1, 9, 1);
  expect_groups({.cell_side = 32}, 65, 64, 3, 2);
  expect_groups({.domain = Domain::written_image}, 9, 8, 2, 1);
}

TEST(DispatchRuleTest, SeveralCellsPerGroup_DispatchInOneDimension) {
  expect_groups({.cells_per_group = 64}, 64, 64, 1, 1);
  expect_groups({.cells_per_group = 64}, 65, 64, 2, 1); // 9 x 8 cells
  expect_groups({.cells_per_group = 64}, 7680, 4320, 8100, 1);
}

TEST(DispatchRuleTest, GroupsCanBeLimited) {
  expect_groups({.cells_per_group = 64, .max_groups = 32}, 7680, 4320, 32, 1);
  expect_groups({.cells_per_group = 64, .max_groups = 32}, 65, 64, 2, 1);
}

TEST(DispatchRuleTest, BorderExtendsTheDomain) {
  expect_groups({.cell_side = 128, .border = 32}, 96, 97, 1, 2);
  expect_groups({.cell_side = 128, .border = 32}, 2560, 1440, 21, 12);
}

TEST(DispatchRuleTest, OneGroupIgnoresTheSize) {
  expect_groups({.domain = Domain::one}, 0, 0, 1, 1);
}

TEST(DispatchRuleTest, CountsOfBuffersAndHostsAreUnknown) {
  for (const Domain domain : {Domain::indirect, Domain::none, Domain::host})
    EXPECT_EQ(group_count({.domain = domain}, 64, 64).total(), 0u);
}

TEST(DispatchRuleTest, OnlyFullGroupsHaveTheShapeOfTheCells) {
  EXPECT_TRUE(DispatchRule{}.cell_shaped());
  EXPECT_FALSE((DispatchRule{.cell_side = 32}.cell_shaped()));
  EXPECT_TRUE((DispatchRule{.cell_side = 16, .invocations = 256}.cell_shaped()));
  EXPECT_FALSE((DispatchRule{.cells_per_group = 64}.cell_shaped()));
  EXPECT_FALSE((DispatchRule{.domain = Domain::indirect}.cell_shaped()));
}

} // namespace
} // namespace dermis
