#pragma once
// Finds the settings of a graph that may differ between its views, and those that formats and
// kernels depend on.

#include "framegraph/model/graph.hpp"

namespace dermis {

// Returns 1 for each graph setting that may differ between frames and views, else 0. Such a setting
// is not a choice by budget, is not read by any `when`, and at least one pass setting follows it;
// all that follow are declared per frame (PassTypeSetting::per_frame). A plan does not depend on
// the setting's value. Thread: any.
std::vector<uint8_t> frame_settings(const Graph& graph, const PassTypeRegistry& pass_types);

// Returns whether the formats that any port of a pass supports depend on the graph setting
// (Port::formats_while), so that another value needs another plan. Thread: any.
bool selects_formats(const Graph& graph, const PassTypeRegistry& pass_types, SettingId setting);

// Returns whether a pass setting that is a constant of kernels follows the graph setting. Thread:
// any.
bool selects_pipelines(const Graph& graph, const PassTypeRegistry& pass_types, SettingId setting);

} // namespace dermis
