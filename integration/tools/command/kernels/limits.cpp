#include "integration/tools/command/kernels/limits.hpp"

#include "framegraph/text/reader.hpp"
#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace dermis::tools {
namespace {

constexpr size_t max_rules = 4096, max_patterns = 256;
constexpr double largest_limit = 1e15; // of a value

class RuleReader {
public:
  RuleReader(const Document& document, Diagnostics& diagnostics)
      : document_(document), diagnostics_(diagnostics) {}

  LimitRule read(NodeId node) {
    LimitRule rule;
    ObjectReader object(document_, node, "a rule", diagnostics_);
    rule.devices = patterns(object, "device");
    rule.drivers = patterns(object, "driver");
    const bool has_kernel = object.has("kernel"), has_graph = object.has("graph");
    const NodeId limits[] = {object.object("max", Need::optional),
                             object.object("min", Need::optional)};
    const bool complete = object.finish();
    ok_ &= complete;
    if (has_kernel == has_graph) {
      if (complete)
        reject(node,
               "a rule is either about kernels or about graphs: give one of 'kernel' and 'graph'");
      return rule;
    }
    rule.of_graphs = has_graph;
    rule.names = patterns(object, has_graph ? "graph" : "kernel");
    for (const size_t minimum : {0, 1})
      if (limits[minimum].valid())
        for (const NodeId value : children(document_, limits[minimum]))
          add_limit(value, minimum != 0, rule);
    if (rule.limits.empty() && complete && ok_)
      reject(node, "a rule needs a limit in 'max' or 'min'");
    return rule;
  }

  bool ok() const { return ok_; }

private:
  void reject(NodeId node, std::string text) {
    diagnostics_.add(DiagnosticId::invalid_value, document_.where(node), std::move(text));
    ok_ = false;
  }

  // Reads a pattern or a list of patterns.
  std::vector<std::string> patterns(ObjectReader& object, std::string_view key) {
    std::vector<std::string> out;
    const NodeId node = object.any(key, Need::optional);
    if (!node.valid()) return out;
    const std::string what = fmt::format("'{}' of a rule", key);
    if (document_[node].kind != NodeKind::array) {
      add_pattern(node, what, out);
      return out;
    }
    const std::vector<NodeId> all = children(document_, node);
    if (all.empty() || all.size() > max_patterns)
      reject(node, fmt::format("{} has {} patterns; 1 to {} are possible", what, all.size(),
                               max_patterns));
    for (const NodeId one : all)
      add_pattern(one, what, out);
    return out;
  }

  void add_pattern(NodeId node, const std::string& what, std::vector<std::string>& out) {
    const auto text = read_string(document_, node, what, diagnostics_);
    ok_ &= text.has_value();
    if (text) out.emplace_back(*text);
  }

  bool known_key(NodeId node, const LimitRule& rule) {
    const std::string_view key = document_.key(node);
    std::vector<std::string_view> keys;
    if (rule.of_graphs)
      keys.assign(GraphCounts::keys().begin(), GraphCounts::keys().end());
    else
      for (const KernelValueInfo& info : kernel_values())
        keys.push_back(info.key);
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) return true;
    const std::string suggestion = did_you_mean(key, keys);
    diagnostics_.add(
        DiagnosticId::unknown_key, document_.where_key(node),
        fmt::format("a {} has no value '{}'; {}", rule.of_graphs ? "graph" : "kernel", key,
                    suggestion.empty() ? "the values are " + list_words(keys) : suggestion));
    ok_ = false;
    return false;
  }

  void add_limit(NodeId node, bool minimum, LimitRule& rule) {
    if (!known_key(node, rule)) return;
    Limit limit;
    limit.minimum = minimum;
    limit.key = document_.key(node);
    limit.where = document_.where(node);
    const std::string what = fmt::format("limit '{}'", limit.key);
    if (document_[node].kind == NodeKind::object) {
      ObjectReader object(document_, node, what, diagnostics_);
      limit.goal = object.number("goal", 0, largest_limit).value_or(0);
      limit.now = object.number("now", 0, largest_limit).value_or(0);
      const bool good = object.finish();
      ok_ &= good;
      if (good && (minimum ? limit.now >= limit.goal : limit.now <= limit.goal))
        reject(node, fmt::format("{}: 'now' reaches the goal; write {} without 'goal' and 'now'",
                                 what, limit.goal));
    } else {
      const auto value = read_number(document_, node, what, 0, largest_limit, diagnostics_);
      ok_ &= value.has_value();
      limit.goal = limit.now = value.value_or(0);
    }
    rule.limits.push_back(std::move(limit));
  }

  const Document& document_;
  Diagnostics& diagnostics_;
  bool ok_ = true;
};

bool matches_any(const std::vector<std::string>& patterns, std::string_view text) {
  return patterns.empty() ||
         std::any_of(patterns.begin(), patterns.end(),
                     [&](const std::string& pattern) { return matches_pattern(pattern, text); });
}

bool is_about(const LimitRule& rule, const LimitedDevice& device) {
  return matches_any(rule.devices, device.name) && matches_any(rule.drivers, device.driver);
}

class Checker {
public:
  Checker(const std::vector<LimitRule>& rules, const LimitedDevice& device) {
    for (const LimitRule& rule : rules)
      if (is_about(rule, device)) rules_.push_back(&rule);
    result.device_known = !rules_.empty();
  }

  // `value_of` returns the value of a key.
  template <class ValueOf>
  void check(bool of_graphs, const std::string& name, const std::string& subject,
             ValueOf value_of) {
    std::map<std::pair<std::string, bool>, const Limit*> limits; // the last rule decides
    for (const LimitRule* rule : rules_)
      if (rule->of_graphs == of_graphs && matches_any(rule->names, name))
        for (const Limit& limit : rule->limits)
          limits[{limit.key, limit.minimum}] = &limit;
    for (const auto& [key, limit] : limits)
      judge({subject, limit->key, value_of(limit->key), *limit});
  }

  LimitsCheck result;

private:
  void judge(LimitFinding finding) {
    ++result.checked;
    const Limit& limit = finding.limit;
    const double sign = limit.minimum ? -1 : 1; // of "larger is worse"
    const bool fits = finding.value && sign * *finding.value <= sign * limit.now;
    if (!fits) return result.exceeded.push_back(std::move(finding));
    if (limit.now == limit.goal) return;
    if (sign * *finding.value < sign * limit.now) result.loose.push_back(finding);
    if (sign * *finding.value > sign * limit.goal) result.open.push_back(std::move(finding));
  }

  std::vector<const LimitRule*> rules_;
};

std::string name_of(const KernelRow& row) {
  const std::string details =
      fmt::format("{}{}{}", row.constants, row.constants.empty() || row.program.empty() ? "" : ", ",
                  row.program);
  return details.empty() ? row.kernel : fmt::format("{} ({})", row.kernel, details);
}

} // namespace

bool matches_pattern(std::string_view pattern, std::string_view text) {
  // Backtracks only to the last '*', which is enough for patterns of this kind.
  size_t p = 0, t = 0, star = std::string_view::npos, resumed = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      resumed = t;
    } else if (p < pattern.size() && pattern[p] == text[t]) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++resumed;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

std::optional<std::vector<LimitRule>> read_limits(const Document& document,
                                                  Diagnostics& diagnostics) {
  if (!check_version(document, "dermis_kernel_limits", 1, diagnostics)) return std::nullopt;
  ObjectReader object(document, document.root(), "the limits file", diagnostics);
  object.any("dermis_kernel_limits");
  RuleReader reader(document, diagnostics);
  std::vector<LimitRule> rules;
  if (const NodeId list = object.array("rules", 1, max_rules); list.valid())
    for (const NodeId node : children(document, list))
      rules.push_back(reader.read(node));
  const bool good = object.finish();
  return good && reader.ok() ? std::optional(std::move(rules)) : std::nullopt;
}

std::string LimitFinding::text() const {
  if (!value)
    return fmt::format("{}: the driver does not report {}, which is limited", subject, key);
  return fmt::format("{}: {} is {:g}, at {} {:g} is allowed{}", subject, key, *value,
                     limit.minimum ? "least" : "most", limit.now,
                     limit.now != limit.goal ? fmt::format(" (goal {:g})", limit.goal) : "");
}

LimitsCheck check_limits(const std::vector<LimitRule>& rules, const LimitedDevice& device,
                         const std::vector<KernelRow>& kernels,
                         const std::vector<GraphCounts>& graphs) {
  Checker checker(rules, device);
  for (const KernelRow& row : kernels)
    checker.check(false, row.kernel, name_of(row),
                  [&](const std::string& key) { return row.value(*find_kernel_value(key)); });
  for (const GraphCounts& graph : graphs)
    checker.check(true, graph.graph, "graph " + graph.graph,
                  [&](const std::string& key) { return graph.value(key); });
  return std::move(checker.result);
}

} // namespace dermis::tools
