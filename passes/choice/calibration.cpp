#include "passes/choice/calibration.hpp"

#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/reader.hpp"

#include <fmt/format.h>

#include <string>
#include <unordered_set>

namespace dermis::choice {
namespace {

constexpr double max_us = 1e9;
constexpr double max_uncertainty = 100;

} // namespace

std::optional<Calibration> read_calibration(const Document& document, Diagnostics& diagnostics) {
  const uint64_t errors = diagnostics.errors();
  if (!check_version(document, "dermis_calibration", 2, diagnostics)) return std::nullopt;
  Calibration out;
  ObjectReader root(document, document.root(), "calibration", diagnostics);
  root.any("dermis_calibration");
  out.device = root.string("device").value_or("");
  out.uncertainty = root.number("uncertainty", 1, max_uncertainty, Need::optional)
                        .value_or(other_device_uncertainty);
  std::unordered_set<std::string> works;
  const NodeId costs = root.array("costs", 0, max_calibrated_costs);
  if (costs.valid())
    for (const NodeId node : children(document, costs)) {
      ObjectReader object(document, node, "cost", diagnostics);
      Cost& cost = out.costs.emplace_back();
      cost.work = object.string("work").value_or("");
      const bool named = object.ok();
      cost.base_us = object.number("base_us", 0, max_us).value_or(0);
      cost.group_us = object.number("group_us", 0, max_us).value_or(0);
      cost.spread = object.number("spread", 0, 1).value_or(0);
      cost.uncertainty =
          object.number("uncertainty", 1, max_uncertainty, Need::optional).value_or(0);
      object.finish();
      if (named && cost.work.empty())
        diagnostics.add(DiagnosticId::bad_name, document.where(node),
                        "'work' of a cost is empty, expected a pass type and its settings");
      if (named && !works.insert(cost.work).second)
        diagnostics.add(DiagnosticId::duplicate_name, document.where(node),
                        fmt::format("two costs are those of '{}'", cost.work));
    }
  root.finish();
  if (diagnostics.errors() != errors) return std::nullopt;
  return out;
}

std::string write_calibration(const Calibration& calibration) {
  JsonWriter json;
  json.open_object();
  json.member("$schema", "../schema/calibration.schema.json").member("dermis_calibration", 2);
  json.member("device", std::string_view(calibration.device));
  json.member("uncertainty", calibration.uncertainty);
  json.key("costs").open_array();
  for (const Cost& cost : calibration.costs) {
    json.open_object(true);
    json.member("work", std::string_view(cost.work));
    json.member("base_us", cost.base_us)
        .member("group_us", cost.group_us)
        .member("spread", cost.spread);
    if (cost.uncertainty > 0) json.member("uncertainty", cost.uncertainty);
    json.close();
  }
  json.close().close();
  return std::move(json).finish();
}

} // namespace dermis::choice
