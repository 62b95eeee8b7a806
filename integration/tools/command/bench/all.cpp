// dermis bench all: runs every suite and writes an index page. A suite that an earlier run measured
// with the same command line into the same folder is not repeated.

#include "framegraph/text/document.hpp"
#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/suggest.hpp"
#include "integration/tools/command/bench/report/html.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

namespace dermis::tools {
namespace {

struct Outcome {
  std::string suite, line; // command line of the suite alone
  int64_t exit_code = 0;
  double seconds = 0;
  bool written = false;      // the files are those of this run
  std::string left_out = {}; // reason for leaving the suite out; "" if it ran
};

// Returns the request of a suite that writes its files into a folder.
SuiteRequest request_of(const Suite& suite, const BenchAllOptions& all, const OutputFolder& out) {
  SuiteRequest request = default_request(suite);
  if (request.options.contains("head")) request.options["head"] = all.head;
  if (request.options.contains("cache")) request.options["cache"] = all.cache;
  request.quick = all.quick;
  request.json = out.path_of(suite.name + ".json");
  request.csv = out.path_of(suite.name + ".csv");
  request.html = out.path_of(suite.name + ".html");
  return request;
}

std::string line_of(const Suite& suite, const BenchAllOptions& all) {
  std::string line = fmt::format("dermis bench {}{}", suite.name, all.quick ? " --quick" : "");
  if (default_request(suite).options.contains("head") && !all.head.empty())
    line += fmt::format(" --head {}", all.head);
  return line + fmt::format(" --json {0}.json --csv {0}.csv --html {0}.html", suite.name);
}

// Reads index.json of an earlier run. Returns an empty list if it is missing or written by another
// program.
std::vector<Outcome> read_index(const std::string& file) {
  Diagnostics ignored;
  std::vector<Outcome> found;
  const auto document = std::filesystem::exists(file) ? read_document(file, ignored) : std::nullopt;
  const NodeId list = document ? document->find(document->root(), "suites") : NodeId{};
  if (!list.valid() || (*document)[list].kind != NodeKind::array) return found;
  for (NodeId one = (*document)[list].first_child; one.valid(); one = (*document)[one].next) {
    const NodeId name = document->find(one, "suite"), line = document->find(one, "line"),
                 code = document->find(one, "exit_code"), seconds = document->find(one, "seconds"),
                 written = document->find(one, "written");
    const auto is = [&](NodeId id, NodeKind kind) {
      return id.valid() && (*document)[id].kind == kind;
    };
    if (is(name, NodeKind::string) && is(line, NodeKind::string) && is(code, NodeKind::integer) &&
        seconds.valid())
      found.push_back({std::string(document->text(name)), std::string(document->text(line)),
                       (*document)[code].integer, (*document)[seconds].real,
                       written.valid() && (*document)[written].integer != 0, ""});
  }
  return found;
}

std::string index_json(const std::vector<Outcome>& outcomes) {
  JsonWriter out;
  out.open_object().member("dermis_bench", "all").key("suites").open_array();
  for (const Outcome& one : outcomes)
    out.open_object(true)
        .member("suite", one.suite)
        .member("line", one.line)
        .member("exit_code", one.exit_code)
        .member("seconds", one.seconds)
        .member("written", one.written)
        .member("left_out", one.left_out)
        .close();
  out.close().close();
  return std::move(out).finish();
}

std::string state_text(const Outcome& one) {
  if (!one.left_out.empty()) return "left out: " + one.left_out;
  return !one.written         ? "failed"
         : one.exit_code == 0 ? "done"
                              : "done; some rows miss their limits";
}

std::string index_html(const Session& session, const std::vector<Outcome>& outcomes) {
  std::string body = "<h1>Measurements of Dermis</h1><p>Each suite has a page, and its rows as "
                     "JSON or CSV.</p><dl>\n";
  for (const auto& [name, text] : machine_info(session.command, ""))
    body += fmt::format("<dt>{}<dd>{}\n", html_text(name), html_text(text));
  body +=
      "</dl><div class=wide><table><thead><tr><th class=t>suite<th class=t>what<th class=t>rows<th "
      "class=t>state"
      "<th>time<th class=t>made by</thead><tbody>\n";
  for (const Suite& suite : bench_suites()) {
    const auto at = std::find_if(outcomes.begin(), outcomes.end(),
                                 [&](const Outcome& one) { return one.suite == suite.name; });
    if (at == outcomes.end() || !at->written) {
      body += fmt::format("<tr><td class=t>{}<td class=t>{}<td class=t><td class=t>{}<td "
                          "data-v=''>&ndash;<td class=t>\n",
                          suite.name, suite.what,
                          at == outcomes.end() ? "not measured" : html_text(state_text(*at)));
      continue;
    }
    body += fmt::format(
        "<tr><td class=t><a href='{0}.html'>{0}</a><td class=t>{1}<td class=t><a href='"
        "{0}.json'>JSON</a> <a href='{0}.csv'>CSV</a><td class=t>{2}<td data-v={3:.1f}>{4}"
        "<td class='t wrap'>{5}\n",
        suite.name, suite.what, state_text(*at), at->seconds, format_duration(at->seconds),
        html_text(at->line));
  }
  return html_page("Measurements of Dermis", body + "</tbody></table></div>\n");
}

bool are_there(const SuiteRequest& request) {
  const std::string files[] = {request.json, request.csv, request.html};
  return std::all_of(std::begin(files), std::end(files), [](const std::string& file) {
    std::error_code ignored;
    return std::filesystem::is_regular_file(file, ignored);
  });
}

// Returns ok for a suite that this machine cannot run.
ExitCode measure_suite(const Session& session, const Suite& suite, const SuiteRequest& request,
                       Outcome& outcome) {
  Session of_suite = session;
  // with --json, the suite's table does not belong to the output
  of_suite.quiet = session.quiet || session.json;
  of_suite.json = false;
  of_suite.command = outcome.line;
  const auto start = std::chrono::steady_clock::now();
  if (suite.why_not != nullptr) outcome.left_out = suite.why_not();
  if (!outcome.left_out.empty()) return ExitCode::ok;
  // removes old files, which would be mistaken for results of a failing run
  std::error_code ignored;
  for (const std::string& file : {request.json, request.csv, request.html})
    std::filesystem::remove(file, ignored);
  const ExitCode code = run_suite(of_suite, suite, request);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.exit_code = static_cast<int64_t>(code);
  outcome.written = are_there(request);
  return code;
}

std::string unknown_suite(const std::vector<std::string>& requested) {
  const std::vector<std::string> known = bench_suite_names();
  const std::vector<std::string_view> names(known.begin(), known.end());
  for (const std::string& one : requested)
    if (std::find(names.begin(), names.end(), one) == names.end()) {
      const std::string suggestion = did_you_mean(one, names);
      return fmt::format("there is no suite '{}'; {}", one,
                         suggestion.empty() ? "suites: " + format_list(known) : suggestion);
    }
  return "";
}

} // namespace

ExitCode bench_all(const Session& session, const BenchAllOptions& options) {
  if (const std::string problem = unknown_suite(options.suites); !problem.empty())
    return fail(session, ExitCode::usage, problem);
  OutputFolder out;
  if (const std::string problem = out.open(options.out); !problem.empty())
    return fail(session, ExitCode::environment, problem);

  std::vector<Outcome> outcomes = read_index(out.path_of("index.json"));
  std::vector<Suite> suites = bench_suites();
  std::erase_if(suites, [&](const Suite& suite) {
    return !options.suites.empty() && std::find(options.suites.begin(), options.suites.end(),
                                                suite.name) == options.suites.end();
  });
  ExitCode worst = ExitCode::ok;
  for (size_t i = 0; i < suites.size(); ++i) {
    if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
    const Suite& suite = suites[i];
    const SuiteRequest request = request_of(suite, options, out);
    Outcome outcome{suite.name, line_of(suite, options)};
    const auto before = std::find_if(outcomes.begin(), outcomes.end(),
                                     [&](const Outcome& one) { return one.suite == suite.name; });
    if (before != outcomes.end() && before->line == outcome.line && !options.again &&
        before->written && are_there(request)) {
      say(session, fmt::format("{} of {}: {} is there from an earlier run\n", i + 1, suites.size(),
                               suite.name));
      worst = std::max(worst, static_cast<ExitCode>(before->exit_code));
      continue;
    }
    say(session, fmt::format("{} of {}: {}\n", i + 1, suites.size(), suite.name));
    const ExitCode code = measure_suite(session, suite, request, outcome);
    if (code == ExitCode::interrupted) return code;
    worst = std::max(worst, code);
    say(session, fmt::format("  {}, {}\n", state_text(outcome), format_duration(outcome.seconds)));
    if (before != outcomes.end()) outcomes.erase(before);
    outcomes.push_back(outcome);
    std::string problem = deliver_text(out.path_of("index.json"), index_json(outcomes));
    if (problem.empty())
      problem = deliver_text(out.path_of("index.html"), index_html(session, outcomes));
    if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  }
  say(session, fmt::format("{}\n", out.path_of("index.html")));
  if (session.json) print(index_json(outcomes));
  return worst;
}

} // namespace dermis::tools
