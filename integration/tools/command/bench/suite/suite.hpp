#pragma once
// The frame of the bench suites. A suite is a value: its options and columns are tables, and one
// function measures rows. run_suite() does the rest: --quick, progress, the table of the terminal,
// JSON, CSV and HTML files, goals and the exit code.

#include "integration/examples/demo_engine/vulkan_host.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/session.hpp"
#include "integration/tools/command/verbs.hpp"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace dermis::tools {

inline constexpr uint32_t quick_subset = 64; // pixels per frame with a reference, with --quick

// bool: a flag. List: an option that may be repeated.
using OptionValue = std::variant<bool, uint64_t, Size, std::string, std::vector<std::string>>;

struct SuiteOption {
  std::string name;      // "size": --size
  std::string help;      // without the default
  OptionValue value;     // default; determines the type of the option
  std::string type = {}; // of text, for help: "FILE"; a list of "NAME" is separated by commas
  std::optional<OptionValue> quick = {};  // value with --quick, which then excludes the option
  uint64_t minimum = 0, maximum = 100000; // of a number
  std::string excludes = {};              // name of an option; "": none
};

// Options that several suites share.
SuiteOption file_option(std::string path, std::string help = "Description of the benchmark");
SuiteOption size_option(Size size);
SuiteOption
head_option(std::string help = "Folder of the head scan (LeePerrySmith.glb and its maps)");
SuiteOption cache_option();
SuiteOption pass_types_option();
// Restricts the suite to some names of a kind ("scenes").
SuiteOption only_option(const std::string& kind);

// A run of a suite.
struct SuiteRun {
  const Session& session;
  bool quick = false; // smoke test with small images and few repetitions; figures are meaningless
  std::map<std::string, OptionValue> options = {};
  Report report = {};        // facts, notes, plots and images; rows are emitted
  std::string device = {};   // for the facts; set by open_device()
  Diagnostics rejected = {}; // of an input file that cannot be used
  // Further outputs, path and text: written after the report, so that no row is lost with them.
  std::vector<std::pair<std::string, std::string>> files = {};

  template <class T> const T& option(const std::string& name) const {
    return std::get<T>(options.at(name));
  }
  const std::string& text(const std::string& name) const { return option<std::string>(name); }
  bool flag(const std::string& name) const { return option<bool>(name); }
  const std::vector<std::string>& list(const std::string& name) const {
    return option<std::vector<std::string>>(name);
  }
  uint64_t number(const std::string& name) const { return option<uint64_t>(name); }
  const Size& size() const { return option<Size>("size"); }
  // Returns the path of a file, which may be a shipped file.
  std::string file(const std::string& name = "file") const { return shipped(text(name)); }
  // Returns whether the list `name` has `word`; an empty list has every word.
  bool is_requested(const std::string& name, std::string_view word) const;
  GraphInputs pass_types() const;

  // Equal entries and equal notes are added once. A note names an omitted part and the reason.
  void add_info(std::string name, std::string value);
  void add_note(std::string note);
  // Progress in `unit`s ("frame"), titled with the suite's name or with `what`.
  Progress progress(std::string unit, uint64_t total, std::string what = {}) const;
  demo::Result<std::unique_ptr<demo::VulkanHost>> open_device();
  // Keeps the diagnostics of an input file for the answer; returns an error of kind input.
  demo::Error reject(const std::string& path, Diagnostics diagnostics);
  // Reads the file of the option "file".
  template <class File>
  demo::Result<File> read(std::optional<File> (*reader)(const std::string&, Diagnostics&)) {
    Diagnostics diagnostics;
    std::optional<File> found = reader(file(), diagnostics);
    if (!found) return reject(file(), std::move(diagnostics));
    return std::move(*found);
  }
};

struct Suite {
  std::string name;                     // "error-time"
  std::string what;                     // one line for help and index
  std::string title = {}, summary = {}; // of the page; a run may change the summary
  std::vector<SuiteOption> options = {};
  // Returns what this machine lacks for the suite, or "". Null means no requirements.
  std::string (*why_not)() = nullptr;
  std::vector<ReportColumn> columns = {};
  // Fills run.report. Returns errors of the measurement, or `stopped()` if interrupted.
  std::function<demo::Result<>(SuiteRun& run)> run = {};
};

// A column and how its value follows from a row: a member, or a function of the row.
template <class Row> struct Column {
  std::string key, title;
  std::function<ReportValue(const Row&)> value;
  ColumnStyle style = {};
};
template <class Row> using Emit = std::function<void(const Row&)>;

// Completes a suite with its columns and a function that measures and emits rows.
template <class Row>
Suite make_suite(Suite suite, std::vector<Column<Row>> columns,
                 demo::Result<> (*measure)(SuiteRun&, const Emit<Row>&)) {
  for (const Column<Row>& column : columns)
    suite.columns.push_back({column.key, column.title, column.style});
  suite.run = [columns = std::move(columns), measure](SuiteRun& run) {
    return measure(run, [&](const Row& row) {
      auto& cells = run.report.table.rows.emplace_back();
      for (const Column<Row>& column : columns)
        cells.push_back(column.value(row));
    });
  };
  return suite;
}

struct SuiteRequest {
  std::map<std::string, OptionValue> options; // of every option of the suite
  std::string json, csv, html;                // output files; "": none, "-": standard output
  bool quick = false;
};
SuiteRequest default_request(const Suite& suite);

// Measures the suite and writes its files. Returns `problems` if a row misses a required goal.
ExitCode run_suite(const Session& session, const Suite& suite, const SuiteRequest& request);

} // namespace dermis::tools
