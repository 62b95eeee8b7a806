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

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace dermis {

// Parses the string at `node` and appends its nodes to graph.expressions, children before parents. Invalid
// after an error, which points into the string. Settings must be read already; comparisons with one that is
// marked in `broken` (by SettingId) are not checked, and the result is then invalid without a further error.
ExpressionId parse_expression(const Document& document, NodeId node, std::string_view what, Graph& graph,
                              const std::vector<bool>& broken, Diagnostics& diagnostics);

// A `when` and the value that it is to have. An invalid id always holds.
struct Condition {
  ExpressionId when;
  bool holds = true;
};
// Whether the graph's settings can have values for which all conditions are as they are to be. True as well
// where finding out would take too long.
bool can_hold(const Graph& graph, std::span<const Condition> conditions);

// Value of a boolean expression; values[i] belongs to graph.settings[i] and has its type.
bool evaluate(const Graph& graph, ExpressionId id, const std::vector<SettingValue>& values);
// The same where only some settings have a value; nullopt: it depends on others.
using PartialValues = std::vector<std::optional<SettingValue>>;
std::optional<bool> evaluate_partly(const Graph& graph, ExpressionId id, const PartialValues& values);

} // namespace dermis
