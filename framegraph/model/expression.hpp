#pragma once
// `when`: a total, typed expression over settings. "technique in ['afis', 'hybrid'] and max_samples > 8"
//
//   either     = both { "or" both } .                 both    = negation { "and" negation } .
//   negation   = "not" negation | comparison .
//   comparison = operand [ ("==" | "!=" | "<" | "<=" | ">" | ">=") operand | ["not"] "in" list ] .
//   operand    = "(" either ")" | setting | "true" | "false" | number | "'" option "'" .
//   list       = "[" literal { "," literal } "]" .
//
// Numbers compare with numbers, booleans with booleans (== and != only), options with options of the same
// setting (likewise). There are no other operators, no loops and nothing that can fail: every expression has
// a value.

#include "framegraph/model/graph.hpp"
#include "framegraph/text/document.hpp"

#include <string_view>
#include <vector>

namespace dermis {

// Parses the string at `node` and appends its nodes to graph.expressions, children before parents. Invalid
// after an error, which points into the string. Settings must be read already; comparisons with one that is
// marked in `broken` (by SettingId) are not checked, and the result is then invalid without a further error.
ExpressionId parse_expression(const Document& document, NodeId node, std::string_view what, Graph& graph,
                              const std::vector<bool>& broken, Diagnostics& diagnostics);

// Value of a boolean expression; values[i] belongs to graph.settings[i] and has its type.
bool evaluate(const Graph& graph, ExpressionId id, const std::vector<SettingValue>& values);

} // namespace dermis
