#include "integration/tools/command/run/choice_table.hpp"

#include "framegraph/compile/shared_heaps.hpp"
#include "passes/choice/budget_controller.hpp"
#include "passes/choice/calibration.hpp"
#include "passes/choice/defaults.hpp"
#include "passes/choice/missing_rows.hpp"
#include "passes/choice/time_margin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace dermis::tools {
namespace {

constexpr std::array distances_px{0.5, 1.0, 2.0, 4.0, 8.0};
constexpr uint64_t tile_side = 8;
constexpr double covered = 0.5;       // fraction of the tiles
constexpr double units_per_tile = 4;  // largest request
constexpr double budget_step = 1.002; // between the budgets that are tried
constexpr double same_ms = 1.02;      // ratio of times below which the budget decides alike

std::optional<Document> document_of(const demo::NamedText& given, std::string_view built_in,
                                    const char* what, Diagnostics& diagnostics) {
  return given.text.empty() ? parse_document(what, std::string(built_in), diagnostics)
                            : parse_document(given.name, given.text, diagnostics);
}

std::optional<choice::ErrorModel> errors_of(const demo::NamedText& given,
                                            Diagnostics& diagnostics) {
  const auto document =
      document_of(given, choice::default_errors_text(), "error table", diagnostics);
  return document ? choice::read_error_model(*document, diagnostics) : std::nullopt;
}

std::vector<choice::Calibration> calibrations_of(const demo::NamedText& given,
                                                 Diagnostics& diagnostics) {
  std::vector<choice::Calibration> out;
  for (const auto device :
       {choice::DeviceClass::cpu, choice::DeviceClass::small_gpu, choice::DeviceClass::large_gpu}) {
    const auto document =
        document_of(given, choice::default_calibration_text(device), "calibration", diagnostics);
    auto read = document ? choice::read_calibration(*document, diagnostics) : std::nullopt;
    if (!read) return {};
    out.push_back(std::move(*read));
    if (!given.text.empty()) break;
  }
  return out;
}

std::vector<choice::Forecast> forecasts_of(std::span<const choice::Configuration> configurations,
                                           const choice::CostEstimator& costs,
                                           const choice::ErrorModel& errors,
                                           const choice::FrameLoad& load, double d_px) {
  std::vector<choice::Forecast> out;
  for (const choice::Configuration& configuration : configurations) {
    choice::Forecast& one = out.emplace_back();
    one.time = forecast_time(configuration, costs, {}, load);
    one.margin = choice::calibrated_margin;
    one.takes_samples = configuration.takes_samples;
    one.demand =
        (configuration.selects_tiles ? 1 : units_per_tile) * static_cast<double>(load.listed_tiles);
    one.concentration = concentration(configuration);
    one.rmse = expected_rmse(errors, configuration.technique, {d_px});
    one.unsampled_rmse = expected_rmse(errors, configuration.without_samples, {d_px});
  }
  return out;
}

double full_ms(const choice::Forecast& forecast) {
  return forecast.time.expected_ms +
         (forecast.takes_samples ? forecast.demand * forecast.time.unit_ms : 0);
}

// Returns what a new view runs with this budget.
choice::Decision selected(std::span<const choice::Forecast> forecasts, double budget_ms) {
  choice::DecisionState state;
  restart(state, forecasts.size(), 0);
  std::vector<choice::Assessment> scratch(forecasts.size());
  choice::FrameInput frame;
  frame.budget_ms = budget_ms;
  return decide(forecasts, frame, state, scratch);
}

// Returns a configuration that takes about as much time as `index`, or less, and has no more error;
// "": none.
std::string better_than(size_t index, std::span<const choice::Forecast> forecasts,
                        std::span<const choice::Configuration> configurations) {
  const choice::Forecast& own = forecasts[index];
  size_t found = index;
  for (size_t i = 0; i < forecasts.size(); ++i) {
    const double ms = full_ms(forecasts[i]);
    if (i == index || ms > same_ms * full_ms(own) || forecasts[i].rmse > own.rmse) continue;
    if (found == index || forecasts[i].rmse < forecasts[found].rmse) found = i;
  }
  return found == index ? "" : configurations[found].name;
}

ChoiceTable table_of(const std::string& device, double d_px,
                     std::span<const choice::Forecast> forecasts,
                     std::span<const choice::Configuration> configurations) {
  ChoiceTable table{device, d_px, {}};
  double least = full_ms(forecasts.front()), largest = least;
  for (size_t i = 0; i < forecasts.size(); ++i) {
    const double ms = full_ms(forecasts[i]);
    table.rows.push_back({.configuration = configurations[i].name,
                          .ms = ms,
                          .rmse = forecasts[i].rmse,
                          .better = better_than(i, forecasts, configurations)});
    least = std::min(least, ms);
    largest = std::max(largest, ms);
  }
  // A configuration may cost nothing.
  const double smallest = std::max(least / 2, 1e-6 * largest);
  for (double ms = smallest; ms < 2 * largest; ms *= budget_step) {
    const choice::Decision decision = selected(forecasts, ms);
    ChoiceRow& row = table.rows[decision.configuration];
    if (row.selected) continue;
    row.selected = true;
    row.first_ms = ms > smallest ? ms : 0;
    row.first_rmse = decision.rmse;
  }
  std::stable_sort(table.rows.begin(), table.rows.end(),
                   [](const ChoiceRow& a, const ChoiceRow& b) { return a.ms < b.ms; });
  return table;
}

void add_memory(const ChoiceConfigurations& made, ChoiceTables& tables) {
  for (uint32_t p = 0; p < made.plans.size(); ++p) {
    ChoiceMemory& memory = tables.memory.emplace_back();
    const auto runs = [&](const choice::Configuration& one) { return one.plan == p; };
    const auto first = std::find_if(made.all.begin(), made.all.end(), runs);
    if (first != made.all.end()) memory.configuration = first->name;
    for (const Heap& heap : made.plans[p]->heaps)
      (heap.persistent ? memory.history_bytes : memory.transient_bytes) += heap.size;
  }
  const SharedHeaps shared = share_heaps(made.plans, HistoryMemory::shared);
  tables.transient_bytes = shared.transient_bytes;
  tables.history_bytes = shared.history_bytes;
}

std::string describe_memory(const ChoiceTables& tables) {
  const auto row = [](std::string_view name, uint64_t transient_bytes, uint64_t history_bytes) {
    constexpr double bytes_per_mib = 1024 * 1024;
    return fmt::format("{:<34}{:>16.1f}{:>16.1f}\n", name, double(transient_bytes) / bytes_per_mib,
                       double(history_bytes) / bytes_per_mib);
  };
  std::string text =
      fmt::format("{:<34}{:>16}{:>16}\n", "plan of", "transients, MiB", "histories, MiB");
  for (const ChoiceMemory& one : tables.memory)
    text += row(one.configuration, one.transient_bytes, one.history_bytes);
  return text +
         row("a view, whose plans share memory", tables.transient_bytes, tables.history_bytes);
}

// Returns the error at the least budget, if samples or tiles that do not fit make it larger.
std::string with_less(const ChoiceRow& row) {
  constexpr double equal = 1.005;
  return row.first_rmse > equal * row.rmse ? fmt::format(", RMSE {:.2e} there", row.first_rmse)
                                           : "";
}

void add_missing(const Diagnostics& found, Diagnostics& missing) {
  for (const Diagnostic& one : found.list)
    if (std::none_of(missing.list.begin(), missing.list.end(),
                     [&](const Diagnostic& other) { return other.text == one.text; }))
      missing.list.push_back(one);
}

} // namespace

std::optional<ChoiceTables> choice_tables(const LoadedGraph& loaded, const Size& size,
                                          const CompileChoices& choices,
                                          const std::vector<bool>& pinned,
                                          const demo::Budget& budget, Diagnostics& diagnostics) {
  const auto errors = errors_of(budget.errors, diagnostics);
  const auto calibrations = calibrations_of(budget.calibration, diagnostics);
  if (!errors || calibrations.empty()) return std::nullopt;
  const DeviceProfile device = generic_profile();
  const CompileInput input = compile_input(loaded, device, size, choices);
  choice::CostEstimator none;
  auto made = choice_configurations(input, pinned, *errors, none, diagnostics);
  if (!made) return std::nullopt;
  const uint64_t tiles =
      ((size.width + tile_side - 1) / tile_side) * ((size.height + tile_side - 1) / tile_side);
  const choice::FrameLoad load{.width = size.width,
                               .height = size.height,
                               .listed_tiles = static_cast<uint64_t>(covered * double(tiles))};
  ChoiceTables out;
  add_memory(*made, out);
  for (const choice::Calibration& calibration : calibrations) {
    choice::CostEstimator costs(calibration.costs, calibration.uncertainty);
    describe_configurations(loaded.pass_types, made->plans, *errors, costs, made->all);
    Diagnostics missing;
    report_missing_rows(loaded.graph, loaded.pass_types, made->plans, *errors, costs, made->all,
                        missing);
    add_missing(missing, out.missing);
    for (const double d_px : distances_px)
      out.tables.push_back(table_of(calibration.device, d_px,
                                    forecasts_of(made->all, costs, *errors, load, d_px),
                                    made->all));
  }
  return out;
}

std::string starting_at(const ChoiceRow& row) {
  return row.first_ms > 0 ? fmt::format("{:.3g} ms{}", row.first_ms, with_less(row)) : "any budget";
}

std::string describe_tables(const ChoiceTables& tables) {
  std::string text = describe_memory(tables) +
                     "\nhalf of the tiles have subsurface; RMSE relative to the light's 99.9th "
                     "percentile\n";
  for (const ChoiceTable& table : tables.tables) {
    text += fmt::format("\n{}, d = {} px\n{:<34}{:>10}{:>10}  {}\n", table.device, table.d_px,
                        "configuration", "ms", "RMSE", "selected by budgets from");
    for (const ChoiceRow& row : table.rows)
      text += fmt::format("{:<34}{:>10.3g}{:>10.2e}  {}\n", row.configuration, row.ms, row.rmse,
                          row.selected          ? starting_at(row)
                          : !row.better.empty() ? "none: " + row.better + " is better"
                                                : "none");
  }
  return text;
}

void write_tables(JsonWriter& writer, const ChoiceTables& tables) {
  writer.open_object().key("plans").open_array();
  for (const ChoiceMemory& one : tables.memory)
    writer.open_object(true)
        .member("configuration", std::string_view(one.configuration))
        .member("transient_bytes", one.transient_bytes)
        .member("history_bytes", one.history_bytes)
        .close();
  writer.close().member("transient_bytes", tables.transient_bytes);
  writer.member("history_bytes", tables.history_bytes).key("tables").open_array();
  for (const ChoiceTable& table : tables.tables) {
    writer.open_object().member("device", std::string_view(table.device));
    writer.member("d_px", table.d_px).key("configurations").open_array();
    for (const ChoiceRow& row : table.rows) {
      writer.open_object(true).member("configuration", std::string_view(row.configuration));
      writer.member("ms", row.ms).member("rmse", row.rmse).key("selected_from_ms");
      if (row.selected)
        writer.value(row.first_ms).member("first_rmse", row.first_rmse);
      else
        writer.null();
      writer.member("better", std::string_view(row.better)).close();
    }
    writer.close().close();
  }
  writer.close().close();
}

} // namespace dermis::tools
