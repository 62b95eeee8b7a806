// dermis bench truth: compares known results with those of formulas, the reference and the
// techniques.

#include "integration/tools/command/bench/quick.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/truth/truth_file.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/verbs.hpp"
#include "integration/tools/files/capture_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace dermis::tools {
namespace {

demo::Result<std::vector<float>> scatter_exactly(const CapturedFrame& frame) {
  const ReferenceFrame reference = make_reference_frame(frame);
  const subsurface::ReferenceInput input = reference.input();
  std::vector<float> light(reference.light);
  if (subsurface::is_planar(input)) {
    const std::vector<double> everywhere = subsurface::reference_everywhere(input);
    std::copy(everywhere.begin(), everywhere.end(), light.begin());
    return light;
  }
  // Only the evaluated pixels: a band around the middle row.
  std::vector<uint32_t> pixels;
  for (uint32_t i = 0; i < reference.profile.size(); ++i)
    if (is_looked_at(i % reference.width, i / reference.width)) pixels.push_back(i);
  const std::vector<double> values = subsurface::reference_at(input, pixels);
  for (size_t i = 0; i < pixels.size(); ++i)
    for (size_t c = 0; c < 3; ++c)
      light[3 * size_t{pixels[i]} + c] = static_cast<float>(values[3 * i + c]);
  return light;
}

Report make_report(const Session& session, const std::vector<PropertyRow>& rows,
                   const std::vector<std::string>& notes, const std::string& device) {
  Report report;
  report.bench = "truth";
  report.title = "Known results";
  report.summary = "Required and measured results of planes, edges, discs and steps. Rows without a "
                   "tolerance are only reported.";
  report.info = machine_info(session.command, device);
  report.notes = notes;
  report.table.columns = {{"law", "law"},
                          {"technique", "technique"},
                          {"expected", "expected", 7},
                          {"measured", "measured", 7},
                          {"tolerance", "tolerance"},
                          {"holds", "holds"}};
  for (const PropertyRow& row : rows) {
    ReportValue tolerance, holds;
    if (row.tolerance) {
      tolerance = *row.tolerance;
      holds = row.holds();
    }
    report.table.rows.push_back({row.property, row.technique, row.expected, row.measured, tolerance, holds});
  }
  return report;
}

std::string text_of(const std::vector<PropertyRow>& rows) {
  Table table;
  table.columns = {{"law"},  {"technique"}, {"expected", true}, {"measured", true}, {"tolerance", true},
                   {"holds"}};
  for (const PropertyRow& row : rows) {
    if (!table.rows.empty() && row.technique != table.rows.back()[1]) table.rows.emplace_back();
    table.rows.push_back({row.property, row.technique, fmt::format("{:.6f}", row.expected),
                          fmt::format("{:.6f}", row.measured),
                          row.tolerance ? fmt::format("{:.2g}", *row.tolerance) : "-",
                          !row.tolerance ? ""
                          : row.holds()  ? "yes"
                                         : "NO"});
  }
  return format_table(table);
}

} // namespace

ExitCode bench_reference(const Session& session, const BenchReferenceOptions& options) {
  Diagnostics diagnostics;
  std::optional<PropertyFile> file = read_property_file(options.file, diagnostics);
  if (!file)
    return fail(session, ExitCode::problems, fmt::format("the bench file '{}' cannot be used", options.file),
                &diagnostics);
  if (options.quick) quicken(*file);
  auto host = demo::create_vulkan_host({});
  if (!host) return fail(session, static_cast<ExitCode>(host.error().kind), host.error().text);

  std::vector<std::string> notes;
  std::vector<PropertyRow> rows = formula_properties();
  Progress progress(progress_style(session.quiet, false), "truth", "technique", file->techniques.size() + 1);
  const std::vector<CaptureProfile> profiles = property_profiles();
  const auto measure = [&](const PropertySubject& subject) -> ExitCode {
    const auto measured = plane_properties(subject);
    if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
    if (!measured) return fail(session, static_cast<ExitCode>(measured.error().kind), measured.error().text);
    rows.insert(rows.end(), measured->begin(), measured->end());
    return ExitCode::ok;
  };
  const auto stop = [](Scatter scatter) -> Scatter {
    return [scatter = std::move(scatter)](const CapturedFrame& frame) -> demo::Result<std::vector<float>> {
      if (interrupted()) return demo::Error{demo::ErrorKind::environment, "stopped"};
      return scatter(frame);
    };
  };
  if (const ExitCode code = measure({"truth", stop(scatter_exactly), file->reference}); code != ExitCode::ok)
    return code;
  uint64_t done = 1;
  for (const PropertyTechnique& technique : file->techniques) {
    progress.update(done++);
    const std::string name = fmt::format("{} {}", technique.request.technique, technique.request.setting);
    if (!std::filesystem::exists(technique.request.graph)) {
      notes.push_back(fmt::format("technique {}: graph '{}' does not exist", name, technique.request.graph));
      continue;
    }
    auto run = TechniqueRun::create(**host, technique.request, profiles, {});
    if (!run) return fail(session, static_cast<ExitCode>(run.error().kind), run.error().text);
    const PropertySubject subject{
        name, stop([&](const CapturedFrame& frame) { return (*run)->scatter(frame); }), technique.tolerances};
    if (const ExitCode code = measure(subject); code != ExitCode::ok) return code;
  }

  Report report = make_report(session, rows, notes, (*host)->properties.deviceName);
  if (options.quick) report.info.push_back(quick_fact());
  const auto broken =
      std::count_if(rows.begin(), rows.end(), [](const PropertyRow& row) { return !row.holds(); });
  if (!session.quiet && options.json != "-" && options.csv != "-" && options.html != "-") {
    std::string text = text_of(rows);
    for (const std::string& note : notes)
      text += fmt::format("left out: {}\n", note);
    print(text + fmt::format("{} of {} rows do not hold\n", broken, rows.size()));
  }
  const std::string problem = deliver_report(report, options.json, options.csv, options.html);
  if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  return broken == 0 ? ExitCode::ok : ExitCode::problems;
}

} // namespace dermis::tools
