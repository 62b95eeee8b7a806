#include "passes/choice/error_model.hpp"

#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

constexpr size_t max_points = 64, max_techniques = 256, max_pass_types = 16;
constexpr double largest_through = 10; // maximum error relative to the light that a slab transmits
constexpr double min_d_px = 1e-3, largest_d_px = 1e4, min_rmse = 1e-9, largest_rmse = 1e3;
constexpr double max_spread = 1e3;

std::vector<ErrorPoint> read_curve(const Document& document, ObjectReader& owner,
                                   std::string_view key, Diagnostics& diagnostics) {
  std::vector<ErrorPoint> curve;
  const NodeId list = owner.array(key, 1, max_points);
  if (!list.valid()) return curve;
  for (const NodeId node : children(document, list)) {
    const std::string what = fmt::format("point of '{}' of {}", key, owner.what());
    if (!expect_kind(document, node, what, NodeKind::array, diagnostics)) continue;
    const std::vector<NodeId> pair = children(document, node);
    if (pair.size() != 2 && pair.size() != 3) {
      diagnostics.add(
          DiagnosticId::out_of_range, document.where(node),
          fmt::format("{} has {} values; expected 2 or 3: d in pixels, RMSE and its spread", what,
                      pair.size()));
      continue;
    }
    const auto d_px =
        read_number(document, pair[0], "d of a " + what, min_d_px, largest_d_px, diagnostics);
    const auto rmse =
        read_number(document, pair[1], "RMSE of a " + what, min_rmse, largest_rmse, diagnostics);
    const auto spread = pair.size() == 2 ? std::optional<double>(1)
                                         : read_number(document, pair[2], "spread of a " + what, 1,
                                                       max_spread, diagnostics);
    if (!d_px || !rmse || !spread) continue;
    if (!curve.empty() && *d_px <= curve.back().d_px)
      diagnostics.add(DiagnosticId::error_curve, document.where(node),
                      fmt::format("{} has d = {} after d = {}; d must increase from point to point",
                                  what, *d_px, curve.back().d_px));
    curve.push_back({*d_px, *rmse, *spread});
  }
  return curve;
}

double read_exponent(ObjectReader& owner, std::string_view key) {
  return owner.number(key, -max_relief_power, max_relief_power, Need::optional).value_or(0);
}

PassTypeMatch read_pass_type(const Document& document, NodeId node, const std::string& of,
                             Diagnostics& diagnostics) {
  PassTypeMatch match;
  ObjectReader object(document, node, fmt::format("pass type of {}", of), diagnostics);
  match.type = object.string("type").value_or("");
  const NodeId set = object.object("set", Need::optional);
  if (set.valid())
    for (const NodeId value : children(document, set)) {
      const Node& member = document[value];
      SettingMatch& condition = match.settings.emplace_back();
      condition.setting = document.key(value);
      if (member.kind == NodeKind::string)
        condition.value = document.text(value);
      else if (member.kind == NodeKind::integer)
        condition.value = fmt::format("{}", member.integer);
      else if (member.kind == NodeKind::boolean)
        condition.value = member.integer != 0 ? "true" : "false";
      else if (member.kind == NodeKind::real)
        condition.value = fmt::format("{}", member.real);
      else
        diagnostics.add(DiagnosticId::wrong_type, document.where(value),
                        fmt::format("setting '{}' of {} expects a number, a string, true or false",
                                    condition.setting, object.what()));
    }
  object.finish();
  return match;
}

std::vector<ReliefPoint> read_relief(const Document& document, ObjectReader& root,
                                     Diagnostics& diagnostics) {
  std::vector<ReliefPoint> curve;
  const NodeId list = root.array("relief", 1, max_points, Need::optional);
  if (!list.valid()) return curve;
  const std::string what = "point of 'relief'";
  for (const NodeId node : children(document, list)) {
    if (!expect_kind(document, node, what, NodeKind::array, diagnostics)) continue;
    const std::vector<NodeId> pair = children(document, node);
    if (pair.size() != 2) {
      diagnostics.add(
          DiagnosticId::out_of_range, document.where(node),
          fmt::format("{} has {} values; expected 2: d in pixels and relief", what, pair.size()));
      continue;
    }
    const auto d_px =
        read_number(document, pair[0], "d of a " + what, min_d_px, largest_d_px, diagnostics);
    const auto relief =
        read_number(document, pair[1], "relief of a " + what, relief_floor, 1, diagnostics);
    if (!d_px || !relief) continue;
    if (!curve.empty() && *d_px <= curve.back().d_px)
      diagnostics.add(DiagnosticId::error_curve, document.where(node),
                      fmt::format("{} has d = {} after d = {}; d must increase from point to point",
                                  what, *d_px, curve.back().d_px));
    curve.push_back({*d_px, *relief});
  }
  return curve;
}

void write_relief(JsonWriter& json, const ErrorModel& model) {
  if (model.relief.empty()) return;
  json.key("relief").open_array(true);
  for (const ReliefPoint& point : model.relief)
    json.open_array(true).value(point.d_px).value(point.relief).close();
  json.close();
}

void write_curve(JsonWriter& json, std::string_view key, const std::vector<ErrorPoint>& curve) {
  json.key(key).open_array(true);
  for (const ErrorPoint& point : curve) {
    json.open_array(true).value(point.d_px).value(point.rmse);
    if (point.spread != 1) json.value(point.spread);
    json.close();
  }
  json.close();
}

// Returns the value at d, linear between points on logarithmic axes. Values are positive.
template <class Point>
double interpolate(const std::vector<Point>& curve, double d_px, double Point::*value) {
  if (d_px <= curve.front().d_px) return curve.front().*value;
  for (size_t i = 1; i < curve.size(); ++i) {
    const Point &low = curve[i - 1], &high = curve[i];
    if (d_px > high.d_px) continue;
    const double part = std::log(d_px / low.d_px) / std::log(high.d_px / low.d_px);
    return low.*value * std::pow(high.*value / low.*value, part);
  }
  return curve.back().*value;
}

bool holds(const SettingMatch& condition, const RunningPass& pass) {
  return std::any_of(pass.settings.begin(), pass.settings.end(), [&](const SettingMatch& value) {
    return value.setting == condition.setting && value.value == condition.value;
  });
}

bool runs(const PassTypeMatch& match, const std::vector<RunningPass>& passes) {
  return std::any_of(passes.begin(), passes.end(), [&](const RunningPass& pass) {
    return pass.type == match.type &&
           std::all_of(match.settings.begin(), match.settings.end(),
                       [&](const SettingMatch& condition) { return holds(condition, pass); });
  });
}

} // namespace

std::optional<ErrorModel> read_error_model(const Document& document, Diagnostics& diagnostics) {
  const uint64_t errors = diagnostics.errors();
  if (!check_version(document, "dermis_errors", 2, diagnostics)) return std::nullopt;
  ErrorModel model;
  ObjectReader root(document, document.root(), "error table", diagnostics);
  root.any("dermis_errors");
  model.scenes = root.string("scenes").value_or("");
  model.unscattered = read_curve(document, root, "unscattered", diagnostics);
  model.unscattered_through =
      root.number("unscattered_through", 0, largest_through, Need::optional).value_or(0);
  model.unscattered_relief_power = read_exponent(root, "unscattered_relief_power");
  model.relief = read_relief(document, root, diagnostics);
  const NodeId techniques = root.array("techniques", 0, max_techniques);
  if (techniques.valid())
    for (const NodeId node : children(document, techniques)) {
      TechniqueError& technique = model.techniques.emplace_back();
      ObjectReader object(document, node, "technique", diagnostics);
      technique.name = object.string("name").value_or("");
      const std::string what = fmt::format("technique '{}'", technique.name);
      const NodeId pass_types = object.array("pass_types", 1, max_pass_types);
      if (pass_types.valid())
        for (const NodeId type : children(document, pass_types))
          technique.pass_types.push_back(read_pass_type(document, type, what, diagnostics));
      technique.curve = read_curve(document, object, "rmse", diagnostics);
      technique.relief_power = read_exponent(object, "relief_power");
      technique.through = object.number("through", 0, largest_through, Need::optional).value_or(0);
      technique.by_rays = object.boolean("by_rays", Need::optional).value_or(false);
      if (!object.finish()) continue;
      const auto is_known = [&](const TechniqueError& other) {
        return &other != &technique && other.name == technique.name;
      };
      if (std::ranges::any_of(model.techniques, is_known))
        diagnostics.add(DiagnosticId::duplicate_name, document.where(node),
                        fmt::format("two techniques are called '{}'", technique.name));
    }
  root.finish();
  if (diagnostics.errors() != errors) return std::nullopt;
  return model;
}

std::string write_error_model(const ErrorModel& model, std::string_view note) {
  JsonWriter json;
  json.open_object().member("$schema", "../schema/errors.schema.json").member("dermis_errors", 2);
  json.member("note", note).member("scenes", std::string_view(model.scenes));
  write_curve(json, "unscattered", model.unscattered);
  if (model.unscattered_relief_power != 0)
    json.member("unscattered_relief_power", model.unscattered_relief_power);
  if (model.unscattered_through > 0) json.member("unscattered_through", model.unscattered_through);
  write_relief(json, model);
  json.key("techniques").open_array();
  for (const TechniqueError& technique : model.techniques) {
    json.open_object(true).member("name", std::string_view(technique.name));
    json.key("pass_types").open_array();
    for (const PassTypeMatch& match : technique.pass_types) {
      json.open_object().member("type", std::string_view(match.type)).key("set").open_object();
      for (const SettingMatch& setting : match.settings)
        json.member(setting.setting, std::string_view(setting.value));
      json.close().close();
    }
    json.close();
    write_curve(json, "rmse", technique.curve);
    if (technique.relief_power != 0) json.member("relief_power", technique.relief_power);
    if (technique.through > 0) json.member("through", technique.through);
    if (technique.by_rays) json.member("by_rays", true);
    json.close();
  }
  json.close().close();
  return std::move(json).finish();
}

int32_t find_technique(const ErrorModel& model, const std::vector<RunningPass>& passes) {
  int32_t found = -1;
  size_t maximum = 0;
  for (size_t t = 0; t < model.techniques.size(); ++t) {
    const TechniqueError& technique = model.techniques[t];
    size_t conditions = 0;
    bool all = true;
    for (const PassTypeMatch& match : technique.pass_types) {
      all = all && runs(match, passes);
      conditions += 1 + match.settings.size();
    }
    if (!all || conditions <= maximum) continue;
    maximum = conditions;
    found = static_cast<int32_t>(t);
  }
  return found;
}

double expected_rmse(const ErrorModel& model, int32_t technique, const FrameKey& key) {
  const TechniqueError* row =
      technique < 0 ? nullptr : &model.techniques[static_cast<size_t>(technique)];
  const double at_usual_relief =
      interpolate(row ? row->curve : model.unscattered, key.d_px, &ErrorPoint::rmse);
  const double power = row ? row->relief_power : model.unscattered_relief_power;
  if (key.relief < 0 || model.relief.empty() || power == 0) return at_usual_relief;
  const double usual = interpolate(model.relief, key.d_px, &ReliefPoint::relief);
  return at_usual_relief * std::pow((key.relief + relief_floor) / usual, power);
}

double spread_at(const std::vector<ErrorPoint>& curve, double d_px) {
  return interpolate(curve, d_px, &ErrorPoint::spread);
}

double missed_rmse(const ErrorModel& model, int32_t technique, double transmitted_rms) {
  return transmitted_rms * (technique < 0
                                ? model.unscattered_through
                                : model.techniques[static_cast<size_t>(technique)].through);
}

} // namespace dermis::choice
