// dermis kernels: prints what the driver's compiler made of the kernels of graphs, and what their
// plans do per frame; checks the values against a limits file.

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/kernels/limits.hpp"
#include "integration/tools/command/kernels/report.hpp"
#include "integration/tools/command/kernels/survey.hpp"
#include "integration/tools/command/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>

namespace dermis::tools {
namespace {

// Writes one file per row: "sap_subsurface_sap_up.txt", and "sap_subsurface_sap_up_2.txt" for a
// second pipeline of the kernel. Returns the problem, or "".
std::string write_assembly(const std::string& path, KernelSurvey& survey) {
  OutputFolder folder;
  if (std::string problem = folder.open(path); !problem.empty()) return problem;
  size_t written = 0;
  std::map<std::string, size_t> files; // by kernel and program
  for (KernelRow& row : survey.kernels) {
    if (row.assembly.empty()) continue;
    std::string name = row.kernel + (row.program.empty() ? "" : "_" + row.program);
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '/' || c == ' '; }, '_');
    const size_t number = ++files[name];
    name += number > 1 ? fmt::format("_{}.txt", number) : ".txt";
    if (std::string problem = deliver_text(folder.path_of(name), row.assembly); !problem.empty())
      return problem;
    row.assembly_file = name;
    ++written;
  }
  return written > 0 ? "" : fmt::format("{} delivers no assembly", survey.driver);
}

} // namespace

ExitCode kernels(const Session& session, const KernelsOptions& options) {
  Diagnostics diagnostics;
  std::optional<std::vector<LimitRule>> rules;
  if (!options.limits.empty()) {
    const std::optional<Document> document = read_document(options.limits, diagnostics);
    if (document) rules = read_limits(*document, diagnostics);
    if (!rules)
      return fail(session, ExitCode::problems,
                  fmt::format("{}: the limits cannot be used", options.limits), &diagnostics);
  }
  demo::Result<KernelSurvey> survey = survey_kernels(options, session, diagnostics);
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!survey) return fail(session, survey.error(), &diagnostics);
  print_beside_document(session, diagnostics);
  if (!options.assembly.empty())
    if (const std::string problem = write_assembly(options.assembly, *survey); !problem.empty())
      return fail(session, ExitCode::environment, problem);
  std::optional<LimitsCheck> check;
  if (rules)
    check = check_limits(*rules, {survey->device, survey->driver}, survey->kernels, survey->graphs);
  const bool none = check && check->device_known && check->checked == 0;
  const bool good = !check || check->is_good();
  if (session.json) {
    print(kernels_as_json(*survey, options, check, diagnostics));
    return good ? ExitCode::ok : ExitCode::problems;
  }
  say(session, kernels_as_text(*survey, options));
  if (!check) return ExitCode::ok;
  say(session, limits_as_text(*check, diagnostics));
  if (good) return ExitCode::ok;
  if (!check->device_known)
    return fail(session, ExitCode::problems,
                fmt::format("{} has no rule for {} with {}", options.limits, survey->device,
                            survey->driver));
  if (none)
    return fail(session, ExitCode::problems,
                fmt::format("{}: no rule for this device names one of these kernels or graphs",
                            options.limits));
  return fail(session, ExitCode::problems,
              fmt::format("{} of {} exceeded:\n{}", format_count(check->exceeded.size(), "limit"),
                          options.limits, findings_as_text(check->exceeded, diagnostics)));
}

} // namespace dermis::tools
