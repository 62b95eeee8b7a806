#pragma once

#include "framegraph/model/align_up.hpp"

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace dermis {

// States how many workgroups a pass dispatches.
struct DispatchRule {
  enum class Domain : uint8_t {
    rectangle,     // pixels of the render rectangle
    written_image, // texels of the first image that the pass type writes
    indirect,      // the port with usage indirect_arguments holds the counts
    one,           // one group
    none,          // not a dispatch (clear)
    host           // the host records the pass
  };
  std::string_view name = "over_view"; // in plans as JSON
  Domain domain = Domain::rectangle;
  uint32_t cell_side = 8;       // pixels or texels; the domain is divided into square cells
  uint32_t cells_per_group = 1; // more than 1: groups in one dimension, cells in row order
  uint32_t invocations = 64;    // per group; not checked for `one`
  uint32_t border = 0;          // pixels or texels that extend the domain, both sides together
  uint32_t max_groups = 0;      // 0: no limit; needs cells_per_group > 1

  constexpr bool is_kernel() const { return domain != Domain::none && domain != Domain::host; }
  // A group with one invocation per pixel of its cell has the cell's shape.
  constexpr bool cell_shaped() const {
    return (domain == Domain::rectangle || domain == Domain::written_image) &&
           cells_per_group == 1 && uint64_t{cell_side} * cell_side == invocations;
  }
  constexpr bool operator==(const DispatchRule&) const = default;
};

struct GroupCount {
  uint64_t x = 0, y = 0, z = 0;

  constexpr uint64_t total() const { return x * y * z; }
};

// Returns the number of groups for a domain of `width` x `height` pixels or texels; zero if the
// host or a buffer decides.
constexpr GroupCount group_count(const DispatchRule& rule, uint64_t width, uint64_t height) {
  switch (rule.domain) {
  case DispatchRule::Domain::rectangle:
  case DispatchRule::Domain::written_image: {
    const uint64_t columns = ceil_div(width + rule.border, rule.cell_side),
                   rows = ceil_div(height + rule.border, rule.cell_side);
    if (rule.cells_per_group == 1) return {columns, rows, 1};
    const uint64_t groups = ceil_div(columns * rows, rule.cells_per_group);
    return {rule.max_groups > 0 ? std::min<uint64_t>(groups, rule.max_groups) : groups, 1, 1};
  }
  case DispatchRule::Domain::one:
    return {1, 1, 1};
  case DispatchRule::Domain::indirect:
  case DispatchRule::Domain::none:
  case DispatchRule::Domain::host:
    break;
  }
  return {};
}

} // namespace dermis
