// dermis bench stability: runs every technique on known difficult inputs.

#include "integration/tools/command/bench/stability/rows.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/bench/suite/techniques.hpp"
#include "integration/tools/command/interrupt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace dermis::tools {
namespace {

using Techniques = std::vector<TechniqueRequest>;

std::optional<Techniques> read_techniques(const std::string& path, Diagnostics& diagnostics) {
  return read_bench_file<Techniques>(
      path, diagnostics, [](BenchObject& root, Techniques& techniques) {
        root.entries("techniques", "technique", 1,
                     [&](BenchObject& entry) { entry.technique(techniques.emplace_back()); });
      });
}

std::vector<StabilityCase> all_cases() {
  std::vector<StabilityCase> all;
  for (auto& list : std::array{light_cases(), shape_cases(), depth_cases(), tile_cases(),
                               time_cases(), motion_cases(), guidance_cases(), random_cases()})
    for (StabilityCase& one : list)
      all.push_back(std::move(one));
  return all;
}

// Formats one line per case with the worst technique, and every failing row.
std::string summary_of(const std::vector<StabilityRow>& rows) {
  Table table;
  table.columns = {{"case"}, {"techniques", true}, {"largest error", true}, {"bound", true}, {"of"},
                   {"holds"}};
  std::vector<std::string> seen;
  for (const StabilityRow& row : rows) {
    if (std::find(seen.begin(), seen.end(), row.name) != seen.end()) continue;
    seen.push_back(row.name);
    const StabilityRow* worst = &row;
    uint32_t count = 0;
    bool all = true;
    for (const StabilityRow& other : rows) {
      if (other.name != row.name) continue;
      ++count;
      all = all && other.holds();
      if (other.max_abs_error > worst->max_abs_error) worst = &other;
    }
    table.rows.push_back(
        {row.name, fmt::format("{}", count), fmt::format("{:.2g}", worst->max_abs_error),
         fmt::format("{:.2g}", worst->bound), worst->technique, all ? "yes" : "NO"});
  }
  std::string text = format_table(table);
  for (const StabilityRow& row : rows)
    if (!row.holds())
      text += fmt::format("does not hold: {} with {}: {} pixels not finite, {} below 0, error "
                          "{:.3g}, bound {:.3g}\n",
                          row.name, row.technique, row.nonfinite_pixels, row.negative_pixels,
                          row.max_abs_error, row.bound);
  return text;
}

// Returns the usage error if --cases or --techniques has an unknown name.
demo::Result<> check_known(const SuiteRun& run, const Techniques& techniques,
                           const std::vector<StabilityCase>& cases,
                           const std::vector<StabilityRow>& formulas) {
  std::vector<std::string> case_names, technique_names;
  for (const TechniqueRequest& one : techniques)
    technique_names.push_back(one.technique);
  for (const StabilityCase& one : cases)
    case_names.emplace_back(one.name);
  for (const StabilityRow& row : formulas) {
    case_names.push_back(row.name);
    technique_names.push_back(row.technique);
  }
  if (auto known = check_names(run, "cases", std::move(case_names)); !known) return known;
  return check_names(run, "techniques", std::move(technique_names));
}

demo::Result<> measure_stability(SuiteRun& run, const Emit<StabilityRow>& emit) {
  auto read = run.read(read_techniques);
  if (!read) return read.error();
  Techniques techniques = read.take();
  std::vector<StabilityCase> cases = all_cases();
  std::vector<StabilityRow> rows = formula_rows(), moving = moving_rows(run.number("updates"));
  rows.insert(rows.end(), moving.begin(), moving.end());
  if (auto known = check_known(run, techniques, cases, rows); !known) return known;
  if (run.quick && run.list("techniques").empty()) keep_few(techniques);
  std::erase_if(techniques, [&](const TechniqueRequest& one) { return !is_usable(run, one); });
  std::erase_if(cases, [&](const StabilityCase& one) {
    return !run.is_requested("cases", one.name) || (run.quick && one.large);
  });
  std::erase_if(rows, [&](const StabilityRow& row) {
    return !run.is_requested("cases", row.name) || !run.is_requested("techniques", row.technique);
  });
  const auto host = run.open_device();
  if (!host) return host.error();
  const std::vector<CaptureProfile> profiles = stability_profiles();
  // A graph that cannot be used ends the bench before anything is measured.
  for (const TechniqueRequest& request : techniques) {
    auto made = TechniqueRun::create(**host, request, profiles, {});
    if (!made) return made.error();
    if (auto tried = (*made)->scatter(sound_frame()); !tried) return tried.error();
  }
  Progress progress = run.progress("case", cases.size() * techniques.size());
  uint64_t done = 0;
  for (const TechniqueRequest& request : techniques) {
    auto made = TechniqueRun::create(**host, request, profiles, {});
    if (!made) return made.error();
    const std::string name = name_of(request);
    for (const StabilityCase& one : cases) {
      progress.update(done++);
      if (interrupted()) return stopped();
      auto row = run_case(**made, one, name);
      if (!row && one.may_be_rejected && row.error().kind == demo::ErrorKind::input) {
        run.add_note(fmt::format("{} with {}: rejected, as the case permits", one.name, name));
        continue;
      }
      if (!row) return row.error();
      if (*row) rows.push_back(**row);
    }
  }
  if (rows.empty())
    return demo::Error{demo::ErrorKind::usage, "none of these techniques runs one of these cases"};
  for (const StabilityRow& row : rows)
    emit(row);
  run.report.text = summary_of(rows);
  return demo::success();
}

} // namespace

Suite stability_suite() {
  using Row = StabilityRow;
  SuiteOption techniques = only_option("techniques");
  techniques.help = "Only these techniques or formula, separated by commas";
  return make_suite<Row>(
      {.name = "stability",
       .what = "Test every technique with damaged and extreme inputs",
       .title = "Numerical stability",
       .summary =
           "Damaged light, depth, masks, velocities and histories; sizes, radii, slopes and frame "
           "numbers at their limits. Errors are relative to the brightest light of a case.",
       .options = {file_option("tests/benchmark/stability.json", "Techniques"),
                   only_option("cases"),
                   techniques,
                   {"updates", "Updates of moving averages in half floats", 1000000u, "", 1000u,
                    1000, uint64_t{1} << 40}}},
      {{"case", "case", &Row::name},
       {"technique", "technique", &Row::technique},
       {"frames", "frames", &Row::frames},
       {"nonfinite_pixels", "not finite, pixels", &Row::nonfinite_pixels},
       {"negative_pixels", "below 0, pixels", &Row::negative_pixels},
       {"max_abs_error", "largest error", &Row::max_abs_error},
       {"bound", "bound", &Row::bound},
       {"recovered_after_frames", "frames to recover", &Row::recovered_after_frames},
       {"holds", "holds", &Row::holds, {.goal = Goal::required}}},
      measure_stability);
}

} // namespace dermis::tools
