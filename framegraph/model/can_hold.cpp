// Decides whether conditions can hold together, by a search over the values of the settings that
// they name. Between the numbers that expressions and ranges name, only the order of values
// matters, so a few candidates suffice.

#include "framegraph/model/expression.hpp"

#include <algorithm>
#include <cmath>

namespace dermis {
namespace {

constexpr uint32_t max_tries = 20000; // maximum number of values tried

struct Search {
  const Graph& graph;
  std::span<const Condition> conditions;
  std::vector<SettingId> settings = {}; // settings that the conditions name
  std::vector<double> numbers = {};     // candidates for settings with a number type
  PartialValues values = {};
  uint64_t& steps;    // left; a step is a visit of a node or of a candidate
  uint64_t nodes = 0; // of all conditions
  uint32_t tries = 0;

  // Returns false if no steps are left.
  bool spend(uint64_t count) {
    steps -= std::min(steps, count);
    return steps > 0;
  }

  static bool is_number(SettingType type) {
    return type == SettingType::integer || type == SettingType::real;
  }

  void add_number(const SettingValue& value) {
    if (is_number(value.type))
      numbers.push_back(value.type == SettingType::real ? value.real
                                                        : static_cast<double>(value.integer));
  }

  void collect(ExpressionId id) {
    if (!id.valid()) return;
    ++nodes;
    const Expression& node = graph.expressions[id.value];
    if (node.op == Expression::Op::literal) add_number(node.literal);
    for (const SettingValue& one : node.list)
      add_number(one);
    if (node.op == Expression::Op::setting &&
        std::find(settings.begin(), settings.end(), node.setting) == settings.end()) {
      settings.push_back(node.setting);
      const SettingDeclaration& setting = graph.settings[node.setting.value];
      if (is_number(setting.type))
        numbers.insert(numbers.end(), {setting.minimum, setting.maximum});
    }
    collect(node.left);
    collect(node.right);
  }

  // Adds candidates around and between the known numbers: as many whole numbers and as many
  // fractions as there are number settings, so that all settings can differ. Returns false if no
  // steps are left.
  bool add_between() {
    const auto count = std::count_if(settings.begin(), settings.end(), [&](SettingId id) {
      return is_number(graph.settings[id.value].type);
    });
    const auto sort = [&] {
      std::sort(numbers.begin(), numbers.end());
      numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    };
    sort();
    const auto added = static_cast<uint64_t>(count);
    if (!spend(numbers.size() * (1 + 2 * added) * (1 + added))) return false;
    for (size_t i = numbers.size(); i-- > 0;)
      for (std::ptrdiff_t k = 1; k <= count; ++k) {
        numbers.push_back(std::floor(numbers[i]) + static_cast<double>(k));
        numbers.push_back(std::ceil(numbers[i]) - static_cast<double>(k));
      }
    sort();
    for (size_t i = numbers.size() - std::min<size_t>(numbers.size(), 1); i-- > 0;) {
      const double from = numbers[i],
                   step = (numbers[i + 1] - from) / static_cast<double>(count + 1);
      for (std::ptrdiff_t k = 1; k <= count; ++k)
        numbers.push_back(from + step * static_cast<double>(k));
    }
    return true;
  }

  bool contradicted() const {
    return std::any_of(conditions.begin(), conditions.end(), [&](const Condition& condition) {
      if (!condition.when.valid()) return !condition.holds;
      return evaluate_partly(graph, condition.when, values) == !condition.holds;
    });
  }

  std::vector<SettingValue> candidates(const SettingDeclaration& setting) const {
    std::vector<SettingValue> all;
    if (!is_number(setting.type)) {
      const int64_t count = setting.type == SettingType::boolean ? 2 : std::ssize(setting.options);
      for (int64_t i = 0; i < count; ++i)
        all.push_back({setting.type, i, 0.0});
      return all;
    }
    for (const double number : numbers) {
      if (number < setting.minimum || number > setting.maximum) continue;
      if (setting.type == SettingType::real)
        all.push_back({setting.type, 0, number});
      else if (std::floor(number) == number)
        all.push_back({setting.type, static_cast<int64_t>(number), 0.0});
    }
    return all;
  }

  bool try_from(size_t next) {
    if (!spend(1 + nodes + numbers.size())) return true;
    if (contradicted()) return false;
    if (next == settings.size()) return true;
    std::optional<SettingValue>& value = values[settings[next].value];
    for (const SettingValue& one : candidates(graph.settings[settings[next].value])) {
      if (++tries > max_tries) return true;
      value = one;
      if (try_from(next + 1)) return true;
    }
    value.reset();
    return false;
  }
};

} // namespace

bool can_hold(const Graph& graph, std::span<const Condition> conditions, uint64_t& steps) {
  Search search{.graph = graph, .conditions = conditions, .steps = steps};
  for (const Condition& condition : conditions)
    search.collect(condition.when);
  if (!search.spend(search.nodes) || !search.add_between()) return true;
  // Settings with few values first: they contradict conditions after few tries.
  std::stable_partition(search.settings.begin(), search.settings.end(), [&](SettingId id) {
    return !Search::is_number(graph.settings[id.value].type);
  });
  search.values.resize(graph.settings.size());
  return search.try_from(0);
}

} // namespace dermis
