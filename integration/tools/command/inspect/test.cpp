// dermis test: compiles graphs with the inputs of their expectation files and compares the results.

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/expect/junit.hpp"
#include "integration/tools/command/expect/observe.hpp"
#include "integration/tools/command/expect/text_diff.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/files/bytes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace dermis::tools {
namespace {

namespace files = std::filesystem;

constexpr std::string_view suffix = ".expect.json";

bool is_expectation(const files::path& path) {
  return path.filename().string().ends_with(suffix) &&
         path.filename().string().size() > suffix.size();
}

// Returns the expectation files that `paths` name, without duplicates; files of a folder are
// sorted. Returns an empty list and sets `problem` on failure.
std::vector<std::string> find_files(const std::vector<std::string>& paths, std::string& problem) {
  std::vector<std::string> out;
  for (const std::string& path : paths) {
    std::error_code error;
    std::vector<std::string> found;
    if (!files::is_directory(path, error)) {
      found.push_back(path);
      if (!is_expectation(path))
        problem = fmt::format("'{}' is not an expectation file; expected a folder or a file "
                              "NAME{} next to the graph NAME.json",
                              path, suffix);
    } else {
      for (files::recursive_directory_iterator entry(path, error), end; !error && entry != end;
           entry.increment(error))
        if (entry->is_regular_file(error) && is_expectation(entry->path()))
          found.push_back(entry->path().lexically_normal().string());
      if (error) problem = fmt::format("cannot list the folder '{}': {}", path, error.message());
      if (!error && found.empty())
        problem = fmt::format("there is no file NAME{} in '{}'", suffix, path);
    }
    if (!problem.empty()) return {};
    std::sort(found.begin(), found.end());
    for (const std::string& one : found)
      if (std::find(out.begin(), out.end(), one) == out.end()) out.push_back(one);
  }
  return out;
}

struct TestRun {
  TestSuite suite;
  Diagnostics diagnostics; // of the expectation file
  std::string text;        // of the file, rewritten
  bool rewritten = false;  // and different from the original
  size_t updated = 0;      // number of cases
};

std::string joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& one : lines)
    out += one + "\n";
  return out;
}

// Compares, or with `update` adopts the observation. Problems that no update can resolve stay
// failures.
TestResult judge(const ExpectedCase& expected, const Observation& observed, bool update,
                 std::optional<MachineInfo>& fresh) {
  if (!observed.problem.empty()) return {expected.name, false, observed.problem, ""};
  if (!observed.violations.empty())
    return {expected.name, false, "the verifier rejects the plan: this is a defect of the compiler",
            joined(observed.violations)};
  const std::string note = observed.not_verified.empty()
                               ? ""
                               : fmt::format("the plan is not verified: {}", observed.not_verified);
  if (!expected.info) {
    if (!update)
      return {expected.name, false, "the case has no \"expect\"; --update writes one", ""};
    fresh = observed.info;
    return {expected.name, true, note, ""};
  }
  const MachineInfo found = narrow(observed.info, *expected.info);
  if (found == *expected.info) return {expected.name, true, note, ""};
  if (update) {
    // A case that gained or lost a plan is rewritten as a whole.
    MachineInfo of_plan = *expected.info;
    of_plan.diagnostics.clear();
    const bool was_planned = of_plan != MachineInfo{};
    fresh = was_planned && observed.info.passes ? found : observed.info;
    return {expected.name, true, note, ""};
  }
  return {expected.name, false, "the result (+) differs from the expectation (-)",
          diff_lines(info_json(*expected.info), info_json(found)) + joined(observed.messages)};
}

// Loads the graph with the overlays of a case. Returns nullopt and fills `observation` on failure.
std::optional<LoadedGraph> load_case(const std::string& path, const ExpectedCase& one,
                                     const OpenFile& open,
                                     const std::vector<std::string>& pass_types,
                                     Observation& observation) {
  Diagnostics diagnostics;
  std::optional<Document> graph = read_document(path, diagnostics);
  std::vector<Document> overlays;
  for (const std::string& name : one.overlays) {
    FileText file = open(name);
    if (!file.problem.empty())
      observation.problem = fmt::format("overlay '{}': {}", name, file.problem);
    if (!file.problem.empty()) return std::nullopt;
    if (auto overlay = parse_document(file.name, std::move(file.text), diagnostics))
      overlays.push_back(std::move(*overlay));
  }
  std::optional<LoadedGraph> loaded;
  if (graph && overlays.size() == one.overlays.size())
    loaded = load_graph(std::move(*graph), std::move(overlays), open, diagnostics, pass_types);
  if (!loaded) observation = observe_messages(diagnostics);
  return loaded;
}

TestRun run_file(const std::string& path, const TestOptions& options,
                 const std::vector<std::string>& roots) {
  TestRun run;
  run.suite.name = path;
  const std::optional<Document> document = read_document(path, run.diagnostics);
  if (!document) return run;
  const auto cases = read_expectations(*document, run.diagnostics);
  if (!cases) return run;
  const std::string graph_path = path.substr(0, path.size() - suffix.size()) + ".json";
  std::error_code ignored;
  // Overlays are usually located in a folder next to the folder of the graphs, which may have
  // subfolders.
  std::vector<std::string> folders = roots;
  const files::path of_graph = files::absolute(graph_path, ignored).parent_path();
  for (const char* above : {"..", "../.."})
    folders.push_back((of_graph / above).lexically_normal().string());
  const OpenFile open = open_included(graph_path, folders);
  std::vector<std::optional<MachineInfo>> fresh(cases->size());
  for (size_t i = 0; i < cases->size(); ++i) {
    Observation observed;
    if (!files::is_regular_file(graph_path, ignored))
      observed.problem =
          fmt::format("the graph '{}' next to the expectation file does not exist", graph_path);
    else if (const auto loaded =
                 load_case(graph_path, (*cases)[i], open, options.pass_types, observed))
      observed = observe(*loaded, (*cases)[i]);
    run.suite.results.push_back(judge((*cases)[i], observed, options.update, fresh[i]));
    run.updated += fresh[i].has_value();
  }
  const std::string& before = run.diagnostics.files[document->file.value].text;
  run.text = rewrite_info(*document, before, *cases, fresh);
  run.rewritten = run.text != before;
  return run;
}

bool good(const TestRun& run) {
  return !run.diagnostics.has_errors() &&
         std::all_of(run.suite.results.begin(), run.suite.results.end(),
                     [](const TestResult& one) { return one.ok; });
}

std::string answer_json(const std::vector<TestRun>& runs, bool all_good) {
  JsonWriter answer;
  answer.open_object().member("ok", all_good).key("files").open_array();
  for (const TestRun& run : runs) {
    answer.open_object().member("file", run.suite.name).member("ok", good(run));
    answer.member("updated", static_cast<uint64_t>(run.updated)).key("cases").open_array();
    for (const TestResult& one : run.suite.results)
      answer.open_object()
          .member("case", one.name)
          .member("ok", one.ok)
          .member("message", one.message)
          .member("details", one.details)
          .close();
    answer.close().key("diagnostics").json(format_as_json(run.diagnostics)).close();
  }
  answer.close().close();
  return std::move(answer).finish();
}

void print_result(const Session& session, const TestRun& run) {
  print_diagnostics(session, run.diagnostics);
  if (session.json) return;
  for (const TestResult& one : run.suite.results)
    if (!one.message.empty())
      print_message(for_terminal(fmt::format("{}: case '{}': {}\n{}", run.suite.name, one.name,
                                             one.message, one.details)));
  const size_t count = run.suite.results.size();
  if (run.updated > 0)
    say(session, fmt::format("{}: {} of {} cases updated\n", run.suite.name, run.updated, count));
  else if (good(run))
    say(session,
        fmt::format("{}: {} case{} as expected\n", run.suite.name, count, count == 1 ? "" : "s"));
}

// An unreadable file is also a result, so that a CI server shows it.
std::vector<TestSuite> suites_of(const std::vector<TestRun>& runs) {
  std::vector<TestSuite> suites;
  for (const TestRun& run : runs) {
    suites.push_back(run.suite);
    if (run.diagnostics.has_errors())
      suites.back().results.push_back({"(the file itself)", false,
                                       "the expectations cannot be read",
                                       joined(observe_messages(run.diagnostics).messages)});
  }
  return suites;
}

} // namespace

ExitCode test(const Session& session, const TestOptions& options) {
  std::string problem;
  const std::vector<std::string> paths = find_files(options.paths, problem);
  if (!problem.empty()) return fail(session, ExitCode::problems, problem);
  std::vector<std::string> roots = options.roots;
  std::error_code ignored;
  for (const std::string& path : options.paths)
    if (files::is_directory(path, ignored)) roots.push_back(path);
  OutputFolder junit_folder;
  if (!options.junit.empty()) problem = junit_folder.open_for(options.junit);
  if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  std::vector<TestRun> runs;
  for (const std::string& path : paths) {
    runs.push_back(run_file(path, options, roots));
    if (runs.back().rewritten) problem = deliver_text(path, runs.back().text);
    if (!problem.empty()) return fail(session, ExitCode::environment, problem);
    print_result(session, runs.back());
  }
  if (!options.junit.empty()) problem = deliver_text(options.junit, junit_xml(suites_of(runs)));
  if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  const auto bad =
      std::count_if(runs.begin(), runs.end(), [](const TestRun& run) { return !good(run); });
  if (session.json) {
    print(answer_json(runs, bad == 0));
    return bad == 0 ? ExitCode::ok : ExitCode::problems;
  }
  if (bad == 0) return ExitCode::ok;
  return fail(
      session, ExitCode::problems,
      fmt::format("{} of {} expectation files fail{}", bad, runs.size(),
                  options.update ? "" : "; if the change is intended, update them with --update"));
}

} // namespace dermis::tools
