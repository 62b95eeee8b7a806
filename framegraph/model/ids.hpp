#pragma once
// Small integers that name graph objects. Distinct types, so that a pass is never used to index resources.

#include <compare>
#include <cstdint>
#include <functional>

namespace dermis {

template <class Tag> struct Index {
  static constexpr uint32_t none = 0xffffffffu;
  uint32_t value = none;

  constexpr bool valid() const { return value != none; }
  constexpr auto operator<=>(const Index&) const = default;
};

using PassId = Index<struct PassTag>;             // into Graph::passes
using ResourceId = Index<struct ResourceTag>;     // into Graph::resources
using SettingId = Index<struct SettingTag>;       // into Graph::settings
using KindId = Index<struct KindTag>;             // into KindRegistry
using ExpressionId = Index<struct ExpressionTag>; // into Graph::expressions
using NodeId = Index<struct NodeTag>;             // into Document
using FileId = Index<struct FileTag>;             // into the list of files a document was read from

} // namespace dermis
