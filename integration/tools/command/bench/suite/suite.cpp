#include "integration/tools/command/bench/suite/suite.hpp"

#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

namespace dermis::tools {
namespace {

constexpr Size quick_size{96, 54};

// Facts of the machine precede those of the suite.
void complete_info(SuiteRun& run, double seconds) {
  auto info = machine_info(run.session.command, run.device);
  std::vector<std::pair<std::string, std::string>>& own = run.report.info;
  own.insert(own.begin(), info.begin(), info.end());
  if (run.quick)
    run.add_info(
        "quick",
        "a smoke test with small images and few repetitions, scenes or techniques; figures "
        "are meaningless");
  run.add_info("took", format_duration(seconds));
}

} // namespace

SuiteOption file_option(std::string path, std::string help) {
  return {"file", std::move(help), std::move(path), "FILE"};
}

SuiteOption size_option(Size size) {
  return {.name = "size", .help = "", .value = size, .quick = quick_size};
}

SuiteOption head_option(std::string help) {
  return {"head", std::move(help), "", "DIR"};
}

SuiteOption cache_option() {
  return {"cache", "Folder of cached references; \"\": references are not kept",
          "build/bench_truth", "DIR"};
}

SuiteOption pass_types_option() {
  return {"pass-types", "File of the host's pass types (dermis_export_pass_types); may be repeated",
          std::vector<std::string>(), "FILE"};
}

SuiteOption only_option(const std::string& kind) {
  return {kind, fmt::format("Only these {}, separated by commas", kind), std::vector<std::string>(),
          "NAME"};
}

bool SuiteRun::is_requested(const std::string& name, std::string_view word) const {
  const auto& words = list(name);
  return words.empty() || std::find(words.begin(), words.end(), word) != words.end();
}

GraphInputs SuiteRun::pass_types() const {
  return {.overlays = {}, .roots = {}, .pass_types = list("pass-types")};
}

void SuiteRun::add_info(std::string name, std::string value) {
  std::pair<std::string, std::string> added{std::move(name), std::move(value)};
  if (std::find(report.info.begin(), report.info.end(), added) == report.info.end())
    report.info.push_back(std::move(added));
}

void SuiteRun::add_note(std::string note) {
  if (std::find(report.notes.begin(), report.notes.end(), note) == report.notes.end())
    report.notes.push_back(std::move(note));
}

Progress SuiteRun::progress(std::string unit, uint64_t total, std::string what) const {
  return {progress_style(session.quiet, false), what.empty() ? report.bench : std::move(what),
          std::move(unit), total};
}

demo::Result<std::unique_ptr<demo::VulkanHost>> SuiteRun::open_device() {
  auto host = demo::create_vulkan_host({});
  if (host) device = (*host)->properties.deviceName;
  return host;
}

demo::Error SuiteRun::reject(const std::string& path, Diagnostics diagnostics) {
  rejected = std::move(diagnostics);
  return {demo::ErrorKind::input, fmt::format("'{}' cannot be used", path)};
}

SuiteRequest default_request(const Suite& suite) {
  SuiteRequest request;
  for (const SuiteOption& option : suite.options)
    request.options.emplace(option.name, option.value);
  return request;
}

ExitCode run_suite(const Session& given, const Suite& suite, const SuiteRequest& request) {
  // An error is the document on standard output only where the rows would be.
  Session session = given;
  session.json = request.json == "-";
  const auto start = std::chrono::steady_clock::now();
  if (const std::string reason = suite.why_not != nullptr ? suite.why_not() : ""; !reason.empty())
    return fail(session, ExitCode::environment, reason);
  SuiteRun run{session, request.quick, request.options};
  for (const SuiteOption& option : suite.options)
    if (request.quick && option.quick) run.options.at(option.name) = *option.quick;
  // Before minutes or hours of measuring.
  std::array<OutputFolder, 4> folders;
  std::vector<std::string> files{request.json, request.csv, request.html};
  if (run.options.contains("out")) files.push_back(run.text("out"));
  for (size_t i = 0; i < files.size(); ++i)
    if (const std::string problem = files[i].empty() ? "" : folders[i].open_for(files[i]);
        !problem.empty())
      return fail(session, ExitCode::environment, problem);
  Report& report = run.report;
  report.bench = suite.name;
  report.title = suite.title;
  report.summary = suite.summary;
  report.table.columns = suite.columns;
  const auto done = suite.run(run);
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!done) return fail(session, done.error(), &run.rejected);
  complete_info(run,
                std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());

  const GoalCount goals = count_goals(report.table, Goal::required);
  const std::string verdict = verdict_of(report.table);
  bool prints = !session.quiet && request.json != "-" && request.csv != "-" && request.html != "-";
  for (const auto& [path, text] : run.files)
    prints = prints && path != "-";
  if (prints) print(report_as_text(report) + (verdict.empty() ? "" : verdict + "\n"));
  session.json = false; // standard output may have the rows
  std::string problem = deliver_report(report, request.json, request.csv, request.html);
  for (const auto& [path, text] : run.files)
    if (std::string unwritten = deliver_text(path, text); problem.empty())
      problem = std::move(unwritten);
  if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  return goals.missed == 0 ? ExitCode::ok : fail(session, ExitCode::problems, verdict);
}

} // namespace dermis::tools
