#pragma once

#include <cstdint>

namespace dermis {

// The version that graphs, fragments and overlays state. Older files are converted by `dermis upgrade`.
inline constexpr int64_t graph_format_version = 2;

} // namespace dermis
