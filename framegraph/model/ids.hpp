#pragma once
// Defines the index types that identify objects of a graph.

#include "framegraph/text/index.hpp"

namespace dermis {

using PassId = Index<struct PassTag>;             // into Graph::passes
using ResourceId = Index<struct ResourceTag>;     // into Graph::resources
using SettingId = Index<struct SettingTag>;       // into Graph::settings
using PassTypeId = Index<struct KindTag>;         // into PassTypeRegistry
using ExpressionId = Index<struct ExpressionTag>; // into Graph::expressions

} // namespace dermis
