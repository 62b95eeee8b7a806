#include "framegraph/model/expression.hpp"

namespace dermis {

namespace {

constexpr SettingValue truth(bool value) {
  return {SettingType::boolean, value ? 1 : 0, 0.0};
}

// -1, 0 or 1 as a is less than, equal to or greater than b. Numbers of both types compare by value.
int compare(const SettingValue& a, const SettingValue& b) {
  if (a.type == SettingType::real || b.type == SettingType::real) {
    const double left = a.type == SettingType::real ? a.real : static_cast<double>(a.integer);
    const double right = b.type == SettingType::real ? b.real : static_cast<double>(b.integer);
    return left < right ? -1 : left > right ? 1 : 0;
  }
  return a.integer < b.integer ? -1 : a.integer > b.integer ? 1 : 0;
}

SettingValue value_of(const Graph& graph, ExpressionId id, const std::vector<SettingValue>& values) {
  const Expression& node = graph.expressions[id.value];
  switch (node.op) {
  case Expression::Op::literal:
    return node.literal;
  case Expression::Op::setting:
    return values[node.setting.value];
  case Expression::Op::logical_not:
    return truth(!evaluate(graph, node.left, values));
  case Expression::Op::logical_and:
    return truth(evaluate(graph, node.left, values) && evaluate(graph, node.right, values));
  case Expression::Op::logical_or:
    return truth(evaluate(graph, node.left, values) || evaluate(graph, node.right, values));
  case Expression::Op::in: {
    const SettingValue left = value_of(graph, node.left, values);
    for (const SettingValue& one : node.list) {
      if (compare(left, one) == 0) return truth(true);
    }
    return truth(false);
  }
  default:
    break;
  }
  const int order = compare(value_of(graph, node.left, values), value_of(graph, node.right, values));
  switch (node.op) {
  case Expression::Op::equal:
    return truth(order == 0);
  case Expression::Op::not_equal:
    return truth(order != 0);
  case Expression::Op::less:
    return truth(order < 0);
  case Expression::Op::less_equal:
    return truth(order <= 0);
  case Expression::Op::greater:
    return truth(order > 0);
  default:
    return truth(order >= 0);
  }
}

} // namespace

bool evaluate(const Graph& graph, ExpressionId id, const std::vector<SettingValue>& values) {
  return value_of(graph, id, values).integer != 0;
}

} // namespace dermis
