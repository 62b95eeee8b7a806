#pragma once
// The steps of the phase that have files of their own. Internal to compile/.

#include "framegraph/compile/phases.hpp"

#include <array>

namespace dermis {

// Says in the plan which passes `after` orders; needs points where they are on two queues.
void keep_orderings(CompileContext& context);

// Gives every pass the point that it waits for and the one that it reaches, as few as
// CompileContext::needs_point and needs_frame_before allow.
void number_points(CompileContext& context);

// What each pass knows to be done on its own queue through waits of both: CompileContext::round_trip.
void find_round_trips(CompileContext& context);

// Drafts that stand in one batch and differ in the parts of an image alone become one, and so do their
// reasons.
void merge_part_barriers(CompileContext& context);

// What a set of usages, as a mask of 1 << usage, comes to.
inline constexpr auto usage_count = static_cast<uint32_t>(Usage::count);
inline constexpr uint32_t usage_sets = 1u << usage_count;
static_assert(usage_count <= 16, "PassTouch::usages and ObjectState::visible have 16 bits");

struct UsageSet {
  Stage stages = 0;
  Access access = 0;
  Layout image_layout = Layout::undefined; // one layout for all: `general` serves every one of them
  uint16_t sees = 0; // usages that see what these see: visible to them, visible to those
  bool reads = false, writes = false;
};

const std::array<UsageSet, usage_sets>& all_usage_sets(); // by mask

} // namespace dermis
