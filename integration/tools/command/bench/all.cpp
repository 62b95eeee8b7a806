// dermis bench all: runs every suite and writes an index page. A suite that an earlier run measured
// with the same command line into the same folder is not repeated.

#include "framegraph/text/document.hpp"
#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/suggest.hpp"
#include "integration/tools/command/bench/report/html.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>

namespace dermis::tools {
namespace {

struct Files {
  std::string json, csv, html;
};

struct Suite {
  std::string_view name, what;
  bool rows_as_table;    // also writes CSV
  bool shows_head;       // accepts --head
  bool has_quick;        // accepts --quick
  std::string_view line; // default options other than file names
  ExitCode (*run)(const Session&, const BenchAllOptions&, const Files&);
  // Returns what this machine lacks for the suite, or "". Null means no requirements.
  std::string (*why_not)() = nullptr;
};

template <class Options> Options with_files(const Files& files) {
  Options options;
  options.json = files.json;
  options.html = files.html;
  return options;
}

// From the shortest suite to the longest.
constexpr Suite suites[] = {
    {"record", "Cost of recording a frame on the host's thread", false, false, false, "",
     [](const Session& session, const BenchAllOptions&, const Files& files) {
       return bench_record(session, with_files<BenchRecordOptions>(files));
     }},
    {"skip", "Cost of frames that do not need all of a graph", false, false, true, "",
     [](const Session& session, const BenchAllOptions& all, const Files& files) {
       auto options = with_files<BenchSkipOptions>(files);
       options.quick = all.quick;
       return bench_skip(session, options);
     }},
    {"truth", "Known results compared with every technique", true, false, true, "",
     [](const Session& session, const BenchAllOptions& all, const Files& files) {
       auto options = with_files<BenchReferenceOptions>(files);
       options.quick = all.quick;
       options.csv = files.csv;
       return bench_reference(session, options);
     }},
    {"supplement", "Table 1 of the supplement on control variates", false, false, false, "",
     [](const Session& session, const BenchAllOptions&, const Files& files) {
       return bench_supplement(session, with_files<BenchSupplementOptions>(files));
     }},
    {"compile", "Time and memory of compiling random graphs", false, false, true, "",
     [](const Session& session, const BenchAllOptions& all, const Files& files) {
       auto options = with_files<BenchCompileOptions>(files);
       options.quick = all.quick;
       return bench_compile(session, options);
     }},
    {"stability", "Every technique with damaged and extreme inputs", false, false, true, "",
     [](const Session& session, const BenchAllOptions& all, const Files& files) {
       auto options = with_files<BenchStabilityOptions>(files);
       options.quick = all.quick;
       return bench_stability(session, options);
     }},
    {"budget", "How well frames keep a budget, and at what error", false, false, true, "",
     [](const Session& session, const BenchAllOptions& all, const Files& files) {
       auto options = with_files<BenchBudgetOptions>(files);
       options.cache = all.cache;
       options.quick = all.quick;
       return bench_budget(session, options);
     }},
    {"error-time", "Run time and error of every technique on every still scene", true, true, true,
     " --size 640x360",
     [](const Session& session, const BenchAllOptions& all, const Files& files) {
       auto options = with_files<BenchErrorTimeOptions>(files);
       options.csv = files.csv;
       options.head = all.head;
       options.cache = all.cache;
       options.quick = all.quick;
       return bench_error_time(session, options);
     }},
    {"dynamic", "Samples, time, error and flicker with changing light, camera or objects", true, true, true,
     "",
     [](const Session& session, const BenchAllOptions& all, const Files& files) {
       auto options = with_files<BenchDynamicOptions>(files);
       options.csv = files.csv;
       options.head = all.head;
       options.cache = all.cache;
       options.quick = all.quick;
       return bench_dynamic(session, options);
     }},
    {"restir", "Ray-traced light with each kind of reuse, and screen-space techniques", true, true, true, "",
     [](const Session& session, const BenchAllOptions& all, const Files& files) {
       auto options = with_files<BenchRestirOptions>(files);
       options.csv = files.csv;
       options.head = all.head;
       options.cache = all.cache;
       options.quick = all.quick;
       return bench_restir(session, options);
     },
     why_no_restir},
};

struct Outcome {
  std::string suite, line; // command line of the suite alone
  int64_t exit_code = 0;
  double seconds = 0;
  bool written = false;      // the files are those of this run
  std::string left_out = {}; // reason for leaving the suite out; "" if it ran
};

std::string line_of(const Suite& suite, const BenchAllOptions& options) {
  const bool quick = options.quick && suite.has_quick;
  std::string line = fmt::format("dermis bench {}{}", suite.name, quick ? " --quick" : suite.line);
  if (suite.shows_head && !options.head.empty()) line += fmt::format(" --head {}", options.head);
  return line + fmt::format(" --json {0}.json{1} --html {0}.html", suite.name,
                            suite.rows_as_table ? fmt::format(" --csv {}.csv", suite.name) : "");
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
    const auto is = [&](NodeId id, NodeKind kind) { return id.valid() && (*document)[id].kind == kind; };
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
  return !one.written ? "failed" : one.exit_code == 0 ? "done" : "done; some rows miss their limits";
}

std::string index_html(const Session& session, const std::vector<Outcome>& outcomes) {
  std::string body =
      "<h1>Measurements of Dermis</h1><p>Each suite has a page, and its rows as JSON or CSV.</p><dl>\n";
  for (const auto& [name, text] : machine_info(session.command, ""))
    body += fmt::format("<dt>{}<dd>{}\n", html_text(name), html_text(text));
  body += "</dl><div class=wide><table><thead><tr><th class=t>suite<th class=t>what<th class=t>rows<th "
          "class=t>state"
          "<th>time<th class=t>made by</thead><tbody>\n";
  for (const Suite& suite : suites) {
    const auto at = std::find_if(outcomes.begin(), outcomes.end(),
                                 [&](const Outcome& one) { return one.suite == suite.name; });
    if (at == outcomes.end() || !at->written) {
      body += fmt::format(
          "<tr><td class=t>{}<td class=t>{}<td class=t><td class=t>{}<td data-v=''>&ndash;<td class=t>\n",
          suite.name, suite.what, at == outcomes.end() ? "not measured" : html_text(state_text(*at)));
      continue;
    }
    const std::string csv = suite.rows_as_table ? fmt::format(" <a href='{}.csv'>CSV</a>", suite.name) : "";
    body +=
        fmt::format("<tr><td class=t><a href='{0}.html'>{0}</a><td class=t>{1}<td class=t><a href='{0}.json'>"
                    "JSON</a>{2}<td class=t>{3}<td data-v={4:.1f}>{5}<td class='t wrap'>{6}\n",
                    suite.name, suite.what, csv, state_text(*at), at->seconds, format_duration(at->seconds),
                    html_text(at->line));
  }
  return html_page("Measurements of Dermis", body + "</tbody></table></div>\n");
}

bool are_there(const Files& files) {
  const auto exists = [](const std::string& file) {
    return file.empty() || std::filesystem::is_regular_file(file);
  };
  return exists(files.json) && exists(files.csv) && exists(files.html);
}

// Returns ok for a suite that this machine cannot run.
ExitCode run_suite(const Session& session, const Suite& suite, const BenchAllOptions& options,
                   const Files& files, Outcome& outcome) {
  Session of_suite = session;
  // with --json, the suite's table does not belong to the output
  of_suite.quiet = session.quiet || session.json;
  of_suite.json = false;
  of_suite.command = outcome.line;
  const auto start = std::chrono::steady_clock::now();
  // removes old files, which would be mistaken for results of a failing run
  std::error_code ignored;
  for (const std::string& file : {files.json, files.csv, files.html})
    if (!file.empty()) std::filesystem::remove(file, ignored);
  if (suite.why_not != nullptr) outcome.left_out = suite.why_not();
  if (!outcome.left_out.empty()) return ExitCode::ok;
  const ExitCode code = suite.run(of_suite, options, files);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  outcome.exit_code = static_cast<int64_t>(code);
  outcome.written = are_there(files);
  return code;
}

std::string unknown_suite(const std::vector<std::string>& requested) {
  std::vector<std::string_view> names;
  for (const Suite& suite : suites)
    names.push_back(suite.name);
  for (const std::string& one : requested)
    if (std::find(names.begin(), names.end(), one) == names.end()) {
      const std::string suggestion = did_you_mean(one, names);
      return fmt::format("there is no suite '{}'; {}", one,
                         suggestion.empty() ? "suites: " + format_list(bench_suite_names()) : suggestion);
    }
  return "";
}

} // namespace

std::vector<std::string> bench_suite_names() {
  std::vector<std::string> names;
  for (const Suite& suite : suites)
    names.emplace_back(suite.name);
  return names;
}

ExitCode bench_all(const Session& session, const BenchAllOptions& options) {
  if (const std::string problem = unknown_suite(options.suites); !problem.empty())
    return fail(session, ExitCode::usage, problem);
  OutputFolder out;
  if (const std::string problem = out.open(options.out); !problem.empty())
    return fail(session, ExitCode::environment, problem);

  std::vector<Outcome> outcomes = read_index(out.path_of("index.json"));
  const auto requested = [&](const Suite& suite) {
    return options.suites.empty() ||
           std::find(options.suites.begin(), options.suites.end(), suite.name) != options.suites.end();
  };
  const auto total = std::count_if(std::begin(suites), std::end(suites), requested);
  ExitCode worst = ExitCode::ok;
  int64_t number = 0;
  for (const Suite& suite : suites) {
    if (!requested(suite)) continue;
    if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
    ++number;
    const std::string name(suite.name);
    const Files files{out.path_of(name + ".json"), suite.rows_as_table ? out.path_of(name + ".csv") : "",
                      out.path_of(name + ".html")};
    Outcome outcome{name, line_of(suite, options)};
    const auto before =
        std::find_if(outcomes.begin(), outcomes.end(), [&](const Outcome& one) { return one.suite == name; });
    if (before != outcomes.end() && before->line == outcome.line && !options.again && before->written &&
        are_there(files)) {
      say(session, fmt::format("{} of {}: {} is there from an earlier run\n", number, total, name));
      worst = std::max(worst, static_cast<ExitCode>(before->exit_code));
      continue;
    }
    say(session, fmt::format("{} of {}: {}\n", number, total, name));
    const ExitCode code = run_suite(session, suite, options, files, outcome);
    if (code == ExitCode::interrupted) return code;
    worst = std::max(worst, code);
    say(session, fmt::format("  {}, {}\n", state_text(outcome), format_duration(outcome.seconds)));
    if (before != outcomes.end()) outcomes.erase(before);
    outcomes.push_back(outcome);
    std::string problem = deliver_text(out.path_of("index.json"), index_json(outcomes));
    if (problem.empty()) problem = deliver_text(out.path_of("index.html"), index_html(session, outcomes));
    if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  }
  say(session, fmt::format("{}\n", out.path_of("index.html")));
  if (session.json) print(index_json(outcomes));
  return worst;
}

} // namespace dermis::tools
