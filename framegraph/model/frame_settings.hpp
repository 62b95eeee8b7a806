#pragma once
// Which settings of a graph may differ between the views of the graph.

#include "framegraph/model/graph.hpp"

namespace dermis {

// By setting of the graph, 1: every pass setting that follows it is declared per frame
// (PassTypeSetting::per_frame), there is at least one, no `when` reads it, and it is no choice by budget. A
// plan does not depend on the value of such a setting. Thread: any.
std::vector<uint8_t> frame_settings(const Graph& graph, const PassTypeRegistry& pass_types);

} // namespace dermis
