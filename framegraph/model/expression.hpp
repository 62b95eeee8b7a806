#pragma once
// Parses and evaluates `when`: a total, typed expression over settings, e.g. "technique in ['afis',
// 'hybrid'] and max_samples > 8". Grammar:
//
//   either     = both { "or" both } .
//   both       = negation { "and" negation } .
//   negation   = "not" negation | comparison .
//   comparison = operand [ ("==" | "!=" | "<" | "<=" | ">" | ">=") operand | ["not"] "in" list ] .
//   operand    = "(" either ")" | setting | "true" | "false" | number | "'" option "'" .
//   list       = "[" literal { "," literal } "]" .
//
// Numbers compare with numbers; booleans with booleans, and options with options of one setting
// (both with == and != only). There are no other operators, no loops and no run-time failures:
// every expression has a value.

#include "framegraph/model/graph.hpp"
#include "framegraph/text/document.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace dermis {

// Parses the string at `node` and appends its nodes to graph.expressions, children before parents.
// Returns an invalid id after an error, which points into the string. Settings must already be
// read. If the string names a setting marked in `broken` (by SettingId), the result is invalid
// without a further error.
ExpressionId parse_expression(const Document& document, NodeId node, std::string_view what,
                              Graph& graph, const std::vector<bool>& broken,
                              Diagnostics& diagnostics);

// A `when` expression and its required value. An invalid `when` counts as true.
struct Condition {
  ExpressionId when;
  bool holds = true;
};
// Returns whether some values of the graph's settings satisfy all conditions. Also returns true if
// the search takes too long. `steps` limits the search together with others: each step reduces it
// by 1. If it reaches 0, the result is true and means nothing.
bool can_hold(const Graph& graph, std::span<const Condition> conditions, uint64_t& steps);

// Returns the value of a boolean expression; values[i] belongs to graph.settings[i] and has its
// type.
bool evaluate(const Graph& graph, ExpressionId id, const std::vector<SettingValue>& values);
// Evaluates with only some settings known. Returns nullopt if the result depends on unknown
// settings.
using PartialValues = std::vector<std::optional<SettingValue>>;
std::optional<bool> evaluate_partly(const Graph& graph, ExpressionId id,
                                    const PartialValues& values);

// Returns whether the expression reads the setting.
bool reads_setting(const Graph& graph, ExpressionId id, SettingId setting);

} // namespace dermis
