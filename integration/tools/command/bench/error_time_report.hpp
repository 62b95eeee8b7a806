#pragma once
// Results of dermis bench error-time and their report.

#include "integration/tools/command/bench/plan_file.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/still_error.hpp"
#include "integration/tools/command/bench/technique.hpp"

namespace dermis::tools {

// One technique on one subject.
struct ErrorTimeRow {
  size_t technique = 0, subject = 0;
  double spent_ms = 0;  // duration of the timed runs, including host work
  uint32_t to_warm = 0; // remaining runs that are not timed
  StillError error;
  TechniqueCounts counts;
  std::vector<double> device_ms, sampling_ms;
  std::optional<double> psnr_db_self;
};

struct ErrorTimeBench {
  const Session& session;
  const BenchErrorTimeOptions& options;
  const ErrorTimeFile& file;
  demo::VulkanHost& host;
  std::vector<Subject> subjects = {};
  std::vector<CaptureProfile> profiles = {}; // of all subjects, renumbered
  std::vector<std::unique_ptr<TechniqueRun>> techniques = {};
  std::vector<float> sap_tables = {};
  std::vector<ErrorTimeRow> measured = {};
  std::vector<std::string> notes = {};
  ReportPictures maps = {};
};

// Builds the report: rows, a plot per subject with its Pareto front, and images. `seconds` is the
// total duration.
Report make_error_time_report(const ErrorTimeBench& bench, double seconds);
// Formats the table for a terminal.
std::string text_of_error_time(const Report& report);

} // namespace dermis::tools
