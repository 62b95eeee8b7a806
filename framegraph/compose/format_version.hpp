#pragma once

#include <cstdint>

namespace dermis {

// Version that graphs, fragments and overlays state. `dermis upgrade` converts older files.
inline constexpr int64_t graph_format_version = 2;

} // namespace dermis
