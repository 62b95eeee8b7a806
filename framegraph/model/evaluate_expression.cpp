#include "framegraph/model/expression.hpp"

#include <algorithm>

namespace dermis {

namespace {

constexpr SettingValue reference(bool value) {
  return {SettingType::boolean, value ? 1 : 0, 0.0};
}

// Returns -1, 0 or 1 as `a` is less than, equal to or greater than `b`. Integers and reals compare
// by value.
int compare(const SettingValue& a, const SettingValue& b) {
  if (a.type == SettingType::real || b.type == SettingType::real) {
    const double left = a.type == SettingType::real ? a.real : static_cast<double>(a.integer);
    const double right = b.type == SettingType::real ? b.real : static_cast<double>(b.integer);
    return left < right ? -1 : left > right ? 1 : 0;
  }
  return a.integer < b.integer ? -1 : a.integer > b.integer ? 1 : 0;
}

// Returns the result of comparison `op` for two values that compare as `order`.
bool holds(Expression::Op op, int order) {
  switch (op) {
  case Expression::Op::equal:
    return order == 0;
  case Expression::Op::not_equal:
    return order != 0;
  case Expression::Op::less:
    return order < 0;
  case Expression::Op::less_equal:
    return order <= 0;
  case Expression::Op::greater:
    return order > 0;
  default:
    return order >= 0;
  }
}

bool is_listed(const Expression& node, const SettingValue& value) {
  return std::any_of(node.list.begin(), node.list.end(),
                     [&](const SettingValue& one) { return compare(value, one) == 0; });
}

SettingValue value_of(const Graph& graph, ExpressionId id,
                      const std::vector<SettingValue>& values) {
  const Expression& node = graph.expressions[id.value];
  switch (node.op) {
  case Expression::Op::literal:
    return node.literal;
  case Expression::Op::setting:
    return values[node.setting.value];
  case Expression::Op::logical_not:
    return reference(!evaluate(graph, node.left, values));
  case Expression::Op::logical_and:
    return reference(evaluate(graph, node.left, values) && evaluate(graph, node.right, values));
  case Expression::Op::logical_or:
    return reference(evaluate(graph, node.left, values) || evaluate(graph, node.right, values));
  case Expression::Op::in:
    return reference(is_listed(node, value_of(graph, node.left, values)));
  default:
    return reference(holds(
        node.op, compare(value_of(graph, node.left, values), value_of(graph, node.right, values))));
  }
}

using MaybeValue = std::optional<SettingValue>;

MaybeValue value_of(const Graph& graph, ExpressionId id, const PartialValues& values) {
  const Expression& node = graph.expressions[id.value];
  const auto is = [](const MaybeValue& value, bool expected) {
    return value && (value->integer != 0) == expected;
  };
  if (node.op == Expression::Op::literal) return node.literal;
  if (node.op == Expression::Op::setting) return values[node.setting.value];
  const MaybeValue left = value_of(graph, node.left, values);
  if (node.op == Expression::Op::logical_not)
    return left ? MaybeValue(reference(left->integer == 0)) : left;
  if (node.op == Expression::Op::in)
    return left ? MaybeValue(reference(is_listed(node, *left))) : left;
  const MaybeValue right = value_of(graph, node.right, values);
  if (node.op == Expression::Op::logical_and && (is(left, false) || is(right, false)))
    return reference(false);
  if (node.op == Expression::Op::logical_or && (is(left, true) || is(right, true)))
    return reference(true);
  if (!left || !right) return std::nullopt;
  if (node.op == Expression::Op::logical_and) return reference(true);
  if (node.op == Expression::Op::logical_or) return reference(false);
  return reference(holds(node.op, compare(*left, *right)));
}

} // namespace

bool evaluate(const Graph& graph, ExpressionId id, const std::vector<SettingValue>& values) {
  return value_of(graph, id, values).integer != 0;
}

std::optional<bool> evaluate_partly(const Graph& graph, ExpressionId id,
                                    const PartialValues& values) {
  const MaybeValue value = value_of(graph, id, values);
  return value ? std::optional(value->integer != 0) : std::nullopt;
}

bool reads_setting(const Graph& graph, ExpressionId id, SettingId setting) {
  if (!id.valid()) return false;
  const Expression& node = graph.expressions[id.value];
  return (node.op == Expression::Op::setting && node.setting.value == setting.value) ||
         reads_setting(graph, node.left, setting) || reads_setting(graph, node.right, setting);
}

} // namespace dermis
