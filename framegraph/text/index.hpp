#pragma once
// Small integers that identify objects in lists. Types are distinct, so that a pass never indexes
// resources.

#include <compare>
#include <cstdint>

namespace dermis {

template <class Tag> struct Index {
  static constexpr uint32_t none = 0xffffffffu;
  uint32_t value = none;

  constexpr bool valid() const { return value != none; }
  constexpr auto operator<=>(const Index&) const = default;
};

using NodeId = Index<struct NodeTag>; // into Document
using FileId = Index<struct FileTag>; // into Diagnostics::files

} // namespace dermis
