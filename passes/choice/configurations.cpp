#include "passes/choice/configurations.hpp"

#include "framegraph/compile/availability.hpp"
#include "framegraph/compile/written_size.hpp"
#include "framegraph/model/expression.hpp"
#include "framegraph/model/frame_settings.hpp"
#include "passes/choice/tile_selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

bool scatters_in_part(const PassType& type) {
  return type.name == "subsurface.separable_selected";
}

std::string value_text(const PassTypeSetting& setting, const SettingValue& value) {
  switch (setting.type) {
  case SettingType::boolean:
    return value.integer != 0 ? "true" : "false";
  case SettingType::real:
    return fmt::format("{}", value.real);
  case SettingType::enumeration:
  case SettingType::choice:
    if (value.integer >= 0 && static_cast<size_t>(value.integer) < setting.options.size())
      return std::string(setting.options[static_cast<size_t>(value.integer)]);
    break;
  case SettingType::integer:
    break;
  }
  return fmt::format("{}", value.integer);
}

// Returns the values that a pass runs with; values that follow a setting of the graph come from the
// configuration.
std::vector<SettingValue> values_of(const Plan& plan, const PlanPass& pass, const PassType& type,
                                    const std::vector<SettingValue>& settings) {
  std::vector<SettingValue> out;
  for (size_t i = 0; i < type.settings.size(); ++i) {
    const PlanSetting& setting = plan.settings[pass.first_setting + i];
    out.push_back(setting.from.valid() ? settings[setting.from.value] : setting.value);
  }
  return out;
}

// Returns the integer rounded towards 0 to two significant digits.
int64_t with_two_digits(int64_t value) {
  int64_t power = 1;
  while (std::abs(value / power) >= 100)
    power *= 10;
  return value / power * power;
}

// Returns the value as work_name() states it. A host may change numbers in each frame, and each
// name takes memory, so real numbers have one digit, because costs hardly depend on them, and
// integers two. Real numbers that change the kernel, as by a slider, have two.
std::string rounded_value_text(const PassTypeSetting& setting, const SettingValue& value) {
  if (setting.per_frame && setting.type == SettingType::real)
    return fmt::format("{:.1g}", value.real);
  if (setting.per_frame && setting.type == SettingType::integer)
    return fmt::format("{}", with_two_digits(value.integer));
  if (setting.type == SettingType::real) return fmt::format("{:.2g}", value.real);
  return value_text(setting, value);
}

int32_t level_of(const PassType& type, const std::vector<SettingValue>& values) {
  if (find_port(type, "level_tiles", PortSide::read) < 0) return -1;
  const int level = find_setting(type, "level");
  return level < 0 ? 0 : static_cast<int32_t>(values[static_cast<size_t>(level)].integer);
}

// Returns whether the time of the pass follows the units of samples. In guided sampling they limit
// the samples of a tile if the port is bound.
bool takes_units(const Plan& plan, const PlanPass& pass, const PassType& type) {
  if (type.name != "subsurface.guided") return runs_by_budget(type);
  const int port = find_port(type, "samples_per_tile", PortSide::read);
  const auto first = plan.accesses.begin() + pass.first_access;
  return std::any_of(first, first + pass.access_count, [&](const PlanAccess& access) {
    return access.port == static_cast<uint32_t>(port);
  });
}

PassLoad load_of(const Plan& plan, const PlanPass& pass, const PassType& type,
                 const std::vector<SettingValue>& values) {
  PassLoad load;
  load.level = level_of(type, values);
  if (load.level > 0) {
    const auto level = static_cast<uint32_t>(load.level);
    load.multiple = static_cast<uint32_t>(pixels_per_texel(0, level) /
                                          pixels_per_texel(plan.pixel_grid, level));
  }
  const TexelSize written = first_written_size(plan, pass, type);
  switch (type.dispatch.domain) {
  case DispatchRule::Domain::rectangle:
    load.groups = PassLoad::Groups::rectangle;
    load.rule = type.dispatch;
    break;
  case DispatchRule::Domain::indirect:
    load.groups = scatters_in_part(type)          ? PassLoad::Groups::selected_tiles
                  : takes_units(plan, pass, type) ? PassLoad::Groups::sample_units
                  : copies_all_tiles(type)        ? PassLoad::Groups::copied_tiles
                                                  : PassLoad::Groups::listed_tiles;
    break;
  case DispatchRule::Domain::written_image:
    load.count =
        std::max<uint64_t>(group_count(type.dispatch, written.width, written.height).total(), 1);
    break;
  case DispatchRule::Domain::one:
  case DispatchRule::Domain::host:
    break;
  case DispatchRule::Domain::none:
    load.launches = false;
    break;
  }
  return load;
}

RunningPass running(const PassType& type, const std::vector<SettingValue>& values) {
  RunningPass out{type.name, {}};
  for (size_t i = 0; i < values.size(); ++i)
    out.settings.push_back(
        {std::string(type.settings[i].name), value_text(type.settings[i], values[i])});
  return out;
}

void describe(const PassTypeRegistry& pass_types, const Plan& plan, const ErrorModel& errors,
              CostEstimator& costs, Configuration& configuration) {
  std::vector<RunningPass> passes, without_samples;
  configuration.passes.clear();
  configuration.takes_samples = configuration.selects_tiles = configuration.accumulates = false;
  for (const PlanPass& pass : plan.passes) {
    const PassType& type = pass_types[pass.type];
    const std::vector<SettingValue> values = values_of(plan, pass, type, configuration.settings);
    PassLoad load = load_of(plan, pass, type, values);
    load.cost = costs.add(work_name(type, values), load.launches);
    configuration.passes.push_back(load);
    passes.push_back(running(type, values));
    const bool by_budget = runs_by_budget(type);
    configuration.takes_samples = configuration.takes_samples || by_budget;
    configuration.selects_tiles = configuration.selects_tiles || scatters_in_part(type);
    configuration.accumulates = configuration.accumulates || !type.mixes.empty();
    if (!by_budget) without_samples.push_back(passes.back());
  }
  configuration.technique = find_technique(errors, passes);
  configuration.without_samples = find_technique(errors, without_samples);
}

std::vector<bool> passes_on(const Graph& graph, const std::vector<SettingValue>& values) {
  std::vector<bool> on;
  for (const PassDeclaration& pass : graph.passes)
    on.push_back(!pass.when.valid() || evaluate(graph, pass.when, values));
  return on;
}

// A plan depends on which passes run, and on the values of choices that formats follow.
struct PlanKey {
  std::vector<bool> on;
  std::vector<int64_t> formats;
  bool operator==(const PlanKey&) const = default;
};
PlanKey plan_key(const Graph& graph, const PassTypeRegistry& pass_types,
                 const std::vector<uint32_t>& choices, const std::vector<SettingValue>& values) {
  PlanKey key{passes_on(graph, values), {}};
  for (const uint32_t choice : choices)
    if (selects_formats(graph, pass_types, {choice})) key.formats.push_back(values[choice].integer);
  return key;
}

std::vector<uint32_t> choices_of(const Graph& graph) {
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < graph.settings.size(); ++i)
    if (graph.settings[i].by_budget) out.push_back(i);
  return out;
}

// Advances `digits` like an odometer with one wheel per choice and one position per option. Returns
// false after the last combination.
bool count_up(const Graph& graph, const std::vector<uint32_t>& choices,
              std::vector<size_t>& digits) {
  for (size_t i = choices.size(); i-- > 0;) {
    if (++digits[i] < graph.settings[choices[i]].options.size()) return true;
    digits[i] = 0;
  }
  return false;
}

// Returns whether another option of the setting turns passes on or off, or changes a value of a
// running pass.
bool matters(const Graph& graph, const Plan& plan, std::vector<SettingValue> values,
             uint32_t setting) {
  const auto follows = [&](const PlanSetting& value) {
    return value.from.valid() && value.from.value == setting;
  };
  if (std::any_of(plan.settings.begin(), plan.settings.end(), follows)) return true;
  const std::vector<bool> on = passes_on(graph, values);
  for (size_t option = 0; option < graph.settings[setting].options.size(); ++option) {
    values[setting].integer = static_cast<int64_t>(option);
    if (passes_on(graph, values) != on) return true;
  }
  return false;
}

std::string name_of(const Graph& graph, const Plan& plan, const std::vector<uint32_t>& choices,
                    const std::vector<SettingValue>& values) {
  std::string name;
  for (const uint32_t choice : choices) {
    if (!matters(graph, plan, values, choice)) continue;
    const SettingDeclaration& setting = graph.settings[choice];
    name += fmt::format("{}{}={}", name.empty() ? "" : ", ", setting.name,
                        setting.options[static_cast<size_t>(values[choice].integer)]);
  }
  return name.empty() ? "the graph" : name;
}

} // namespace

bool runs_by_budget(const PassType& type) {
  return type.name == "subsurface.tile_refine" || type.name == "subsurface.afis_tiles" ||
         scatters_in_part(type);
}

bool copies_all_tiles(const PassType& type) {
  return type.name == "subsurface.copy_tiles" || type.name == "subsurface.combine_copies";
}

std::string work_name(const PassType& type, std::span<const SettingValue> values) {
  std::string name(type.name);
  for (size_t i = 0; i < values.size(); ++i)
    name += fmt::format(" {}={}", type.settings[i].name,
                        rounded_value_text(type.settings[i], values[i]));
  return name;
}

std::vector<Work> works_of(const PassTypeRegistry& pass_types, const Plan& plan,
                           const std::vector<SettingValue>& settings) {
  std::vector<Work> works;
  for (const PlanPass& pass : plan.passes) {
    const PassType& type = pass_types[pass.type];
    const std::vector<SettingValue> values = values_of(plan, pass, type, settings);
    works.push_back({work_name(type, values), load_of(plan, pass, type, values)});
  }
  return works;
}

std::optional<Combinations> enumerate_combinations(const CompileInput& input,
                                                   Diagnostics& diagnostics,
                                                   const std::vector<bool>& pinned) {
  const Graph& graph = *input.graph;
  std::vector<SettingValue> base = input.settings;
  if (base.empty())
    for (const SettingDeclaration& setting : graph.settings)
      base.push_back(setting.default_value);
  for (uint32_t i = 0; i < graph.settings.size(); ++i)
    base[i] = available_option(graph.settings[i], base[i], input.device->features, input.bound);
  std::vector<uint32_t> open = choices_of(graph);
  std::erase_if(open, [&](uint32_t choice) { return choice < pinned.size() && pinned[choice]; });
  size_t count = 1;
  for (const uint32_t choice : open) {
    count *= graph.settings[choice].options.size();
    if (count <= max_configurations) continue;
    diagnostics.add(
        DiagnosticId::too_many_configurations, graph.settings[choice].where,
        fmt::format("the options of the choices with \"by\": \"budget\" combine to more than {} "
                    "configurations",
                    max_configurations));
    return std::nullopt;
  }

  Combinations out;
  std::vector<PlanKey> keys; // by plan
  const auto add = [&](std::vector<SettingValue> values) {
    PlanKey key = plan_key(graph, *input.pass_types, open, values);
    const auto known = std::find(keys.begin(), keys.end(), key);
    out.plans.push_back(static_cast<uint32_t>(known - keys.begin()));
    if (known == keys.end()) {
      out.first.push_back(static_cast<uint32_t>(out.settings.size()));
      keys.push_back(std::move(key));
    }
    out.settings.push_back(std::move(values));
  };
  add(base);
  std::vector<size_t> digits(open.size(), 0);
  do {
    std::vector<SettingValue> values = base;
    bool available = true;
    for (size_t i = 0; i < open.size(); ++i) {
      values[open[i]].integer = static_cast<int64_t>(digits[i]);
      available =
          available && !missing_requirements(graph.settings[open[i]], values[open[i]].integer,
                                             input.device->features, input.bound)
                            .any();
    }
    if (available) add(std::move(values));
  } while (count_up(graph, open, digits));
  return out;
}

std::vector<Configuration> make_configurations(const CompileInput& input,
                                               const Combinations& combinations,
                                               std::span<const Plan* const> plans,
                                               const ErrorModel& errors, CostEstimator& costs) {
  const std::vector<uint32_t> choices = choices_of(*input.graph);
  std::vector<Configuration> out;
  for (size_t i = 0; i < combinations.settings.size(); ++i) {
    Configuration made;
    made.settings = combinations.settings[i];
    made.plan = combinations.plans[i];
    made.name = name_of(*input.graph, *plans[made.plan], choices, made.settings);
    describe(*input.pass_types, *plans[made.plan], errors, costs, made);
    const bool twice = std::any_of(out.begin(), out.end(), [&](const Configuration& other) {
      return is_same_work(other, made);
    });
    if (!twice) out.push_back(std::move(made));
  }
  return out;
}

void describe_configurations(const PassTypeRegistry& pass_types, std::span<const Plan* const> plans,
                             const ErrorModel& errors, CostEstimator& costs,
                             std::span<Configuration> configurations) {
  for (Configuration& configuration : configurations)
    describe(pass_types, *plans[configuration.plan], errors, costs, configuration);
}

bool is_same_work(const Configuration& a, const Configuration& b) {
  return a.plan == b.plan && a.technique == b.technique && a.without_samples == b.without_samples &&
         std::ranges::equal(
             a.passes, b.passes, {}, [](const PassLoad& x) { return x.cost.value; },
             [](const PassLoad& x) { return x.cost.value; });
}

uint64_t groups_of(const PassLoad& pass, const FrameLoad& load) {
  switch (pass.groups) {
  case PassLoad::Groups::rectangle:
    return group_count(pass.rule, load.width, load.height).total();
  case PassLoad::Groups::listed_tiles:
    // The pyramid is not built if light is copied.
    return pass.level < 0 ? load.listed_tiles
                          : pass.multiple * (load.listed_tiles -
                                             std::min(load.copied_tiles, load.listed_tiles));
  case PassLoad::Groups::copied_tiles:
    return load.copied_tiles;
  case PassLoad::Groups::sample_units:
  case PassLoad::Groups::selected_tiles:
    return load.sample_units;
  case PassLoad::Groups::fixed:
    break;
  }
  return pass.count;
}

double calibrated_ms(const Configuration& configuration, const CostEstimator& costs,
                     const FrameLoad& load) {
  double sum = 0;
  for (const PassLoad& pass : configuration.passes)
    sum += costs.calibrated_cost(pass.cost).ms(static_cast<double>(groups_of(pass, load)));
  return sum;
}

TimeForecast forecast_time(const Configuration& configuration, const CostEstimator& costs,
                           std::span<const CostFactors> factors, const FrameLoad& load) {
  TimeForecast sum;
  sum.measured = !factors.empty();
  for (const PassLoad& pass : configuration.passes) {
    const AffineCost& cost = costs.calibrated_cost(pass.cost);
    const bool samples = pass.groups == PassLoad::Groups::sample_units ||
                         pass.groups == PassLoad::Groups::selected_tiles;
    const uint64_t groups = groups_of(pass, load);
    const double ms = cost.ms(samples ? 0 : static_cast<double>(groups));
    const double unit_ms = samples ? cost.group_ms : 0;
    CostFactors factor; // all 1
    if (!factors.empty()) factor = factors[pass.cost.value];
    const double known_ms = factors.empty() ? ms : std::max(ms, min_calibrated_ms);
    sum.calibrated_ms += known_ms;
    sum.expected_ms += factor.expected * known_ms;
    sum.pessimistic_ms += factor.pessimistic * known_ms;
    sum.optimistic_ms += factor.optimistic * known_ms;
    sum.undisturbed_ms += factor.undisturbed * known_ms;
    sum.usual_ms += factor.usual * known_ms;
    sum.unit_ms += factor.expected * unit_ms;
    sum.undisturbed_unit_ms += factor.undisturbed * unit_ms;
    // Passes without groups are not observed. Samples may be absent for long, because none fit.
    sum.measured = sum.measured && (samples || groups == 0 || factor.measured);
  }
  return sum;
}

double concentration(const Configuration& configuration) {
  return configuration.selects_tiles ? tile_concentration : 1;
}

double expected_rmse(const ErrorModel& errors, const Configuration& configuration,
                     const FrameKey& key, uint32_t given, uint32_t demand) {
  const double all = expected_rmse(errors, configuration.technique, key);
  if (!configuration.takes_samples) return all;
  const double none = expected_rmse(errors, configuration.without_samples, key);
  const double fraction = demand > 0 ? std::min(1.0, double(given) / double(demand)) : 0.0;
  const double left = std::pow(1 - fraction, concentration(configuration));
  return std::sqrt(all * all + left * (none * none - all * all));
}

} // namespace dermis::choice
