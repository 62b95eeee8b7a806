// dermis bench stability: runs every technique on known difficult inputs.

#include "integration/tools/command/bench/quick.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/selection.hpp"
#include "integration/tools/command/bench/stability/rows.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace dermis::tools {
namespace {

constexpr size_t max_techniques = 256;

std::optional<std::vector<TechniqueRequest>> read_techniques(const std::string& path,
                                                             Diagnostics& diagnostics) {
  const auto document = read_document(path, diagnostics);
  if (!document || !check_version(*document, "dermis_benchmark", 1, diagnostics)) return std::nullopt;
  ObjectReader object(*document, document->root(), "the bench file", diagnostics);
  object.integer("dermis_benchmark", 1, 1);
  std::vector<TechniqueRequest> techniques;
  if (const NodeId list = object.array("techniques", 1, max_techniques); list.valid())
    for (const NodeId node : children(*document, list)) {
      ObjectReader entry(*document, node, fmt::format("technique {}", techniques.size()), diagnostics);
      techniques.push_back(read_technique(*document, entry, diagnostics));
      entry.finish();
    }
  object.finish();
  if (diagnostics.has_errors()) return std::nullopt;
  return techniques;
}

std::vector<StabilityCase> requested_cases(const std::vector<std::string>& only, bool quick) {
  std::vector<StabilityCase> requested;
  for (const auto& list : {light_cases(), shape_cases(), depth_cases(), tile_cases(), time_cases(),
                           motion_cases(), guidance_cases(), random_cases()})
    for (const StabilityCase& one : list)
      if (is_selected(only, one.name) && !(quick && one.large)) requested.push_back(one);
  return requested;
}

Report make_report(const Session& session, const std::vector<StabilityRow>& rows,
                   const std::vector<std::string>& notes, const std::string& device) {
  Report report;
  report.bench = "stability";
  report.title = "Numerical stability";
  report.summary = "Damaged light, depth, masks, velocities and histories; sizes, radii, slopes and frame "
                   "numbers at their limits. Errors are relative to the brightest light of a case.";
  report.info = machine_info(session.command, device);
  report.notes = notes;
  report.table.columns = {{"case", "case"},
                          {"technique", "technique"},
                          {"frames", "frames"},
                          {"nonfinite_pixels", "not finite, pixels"},
                          {"negative_pixels", "below 0, pixels"},
                          {"max_abs_error", "largest error"},
                          {"bound", "bound"},
                          {"recovered_after_frames", "frames to recover"},
                          {"holds", "holds"}};
  for (const StabilityRow& row : rows) {
    ReportValue recovered;
    if (row.recovered_after_frames) recovered = int64_t{*row.recovered_after_frames};
    report.table.rows.push_back({row.name, row.technique, static_cast<int64_t>(row.frames),
                                 static_cast<int64_t>(row.nonfinite_pixels),
                                 static_cast<int64_t>(row.negative_pixels), row.max_abs_error, row.bound,
                                 recovered, row.holds()});
  }
  return report;
}

// Formats one line per case with the worst technique, and every failing row.
std::string text_of(const std::vector<StabilityRow>& rows, const std::vector<std::string>& notes) {
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
    table.rows.push_back({row.name, fmt::format("{}", count), fmt::format("{:.2g}", worst->max_abs_error),
                          fmt::format("{:.2g}", worst->bound), worst->technique, all ? "yes" : "NO"});
  }
  std::string text = format_table(table);
  for (const std::string& note : notes)
    text += fmt::format("left out: {}\n", note);
  for (const StabilityRow& row : rows)
    if (!row.holds())
      text += fmt::format(
          "does not hold: {} with {}: {} pixels not finite, {} below 0, error {:.3g}, bound {:.3g}\n",
          row.name, row.technique, row.nonfinite_pixels, row.negative_pixels, row.max_abs_error, row.bound);
  return text;
}

} // namespace

ExitCode bench_stability(const Session& session, const BenchStabilityOptions& requested) {
  const BenchStabilityOptions options = quickened(requested);
  Diagnostics diagnostics;
  auto techniques = read_techniques(options.file, diagnostics);
  if (!techniques)
    return fail(session, ExitCode::problems,
                fmt::format("the file of techniques '{}' cannot be used", options.file), &diagnostics);
  if (options.quick && options.techniques.empty()) quicken(*techniques);
  auto host = demo::create_vulkan_host({});
  if (!host) return fail(session, static_cast<ExitCode>(host.error().kind), host.error().text);
  const std::vector<StabilityCase> cases = requested_cases(options.cases, options.quick);
  std::vector<StabilityRow> rows;
  std::vector<std::string> notes;
  for (std::vector<StabilityRow>& list : std::array{formula_rows(), moving_rows(options.updates)})
    for (StabilityRow& row : list)
      if (is_selected(options.cases, row.name) && is_selected(options.techniques, row.technique))
        rows.push_back(std::move(row));
  const std::vector<CaptureProfile> profiles = stability_profiles();
  Progress progress(progress_style(session.quiet, false), "stability", "case",
                    cases.size() * techniques->size());
  uint64_t done = 0;
  for (const TechniqueRequest& request : *techniques) {
    if (!is_selected(options.techniques, request.technique)) {
      done += cases.size();
      continue;
    }
    auto run = TechniqueRun::create(**host, request, profiles, {});
    if (!run) return fail(session, static_cast<ExitCode>(run.error().kind), run.error().text);
    const std::string name = fmt::format("{} {}", request.technique, request.setting);
    for (const StabilityCase& one : cases) {
      progress.update(done++);
      if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
      auto row = run_case(**run, one, name);
      if (!row && one.may_be_rejected && row.error().kind == demo::ErrorKind::input) {
        notes.push_back(fmt::format("{} with {}: rejected, as the case permits", one.name, name));
        continue;
      }
      if (!row) return fail(session, static_cast<ExitCode>(row.error().kind), row.error().text);
      if (*row) rows.push_back(**row);
    }
  }
  if (rows.empty()) return fail(session, ExitCode::usage, "no case and technique has these names");
  const auto broken =
      std::count_if(rows.begin(), rows.end(), [](const StabilityRow& row) { return !row.holds(); });
  if (!session.quiet && options.json != "-" && options.html != "-")
    print(text_of(rows, notes) + fmt::format("{} of {} rows do not hold\n", broken, rows.size()));
  Report report = make_report(session, rows, notes, (*host)->properties.deviceName);
  if (options.quick) report.info.push_back(quick_fact());
  const std::string problem = deliver_report(report, options.json, "", options.html);
  if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  return broken == 0 ? ExitCode::ok : ExitCode::problems;
}

} // namespace dermis::tools
