#pragma once
// The state of `dermis bench error-time`, which its parts share.

#include "integration/tools/command/bench/error_time/error_time_file.hpp"
#include "integration/tools/command/bench/error_time/pictures.hpp"
#include "integration/tools/command/bench/still_error.hpp"
#include "integration/tools/command/bench/suite/suite.hpp"
#include "integration/tools/command/bench/technique.hpp"
#include "integration/tools/command/statistics.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace dermis::tools {

// One technique on one subject.
struct ErrorTimeRow {
  const Subject* subject = nullptr;
  const TechniqueRequest* request = nullptr;
  double spent_ms = 0;  // duration of the timed runs, including host work
  uint32_t to_warm = 0; // remaining runs that are not timed
  StillError error = {};
  TechniqueCounts counts = {};
  std::vector<double> device_ms = {}, sampling_ms = {};
  std::optional<double> psnr_db_self = {};
  // set by complete_rows
  std::optional<Spread> device = {};
  std::optional<double> time_ratio = {}, rmse_ratio = {}; // to the baseline
  bool on_front = false;
  std::optional<PairedRatio> pictures_ratio = {}; // to the RMSE of the first folder of pictures
};

struct ErrorTimeBench {
  SuiteRun& run;
  const ErrorTimeFile& file;
  demo::VulkanHost& host;
  Size size;
  std::vector<Subject> subjects = {};
  std::vector<CaptureProfile> profiles = {}; // of all subjects, renumbered
  std::vector<std::unique_ptr<TechniqueRun>> techniques = {};
  std::vector<float> sap_tables = {};
  std::vector<ErrorTimeRow> measured = {};     // all rows of a subject are neighbours
  std::vector<TechniqueRequest> pictures = {}; // folders of --pictures in place of techniques
  std::vector<Subject> means = {};             // subjects of the rows with geometric means
  ReportPictures maps = {};
};

// Renders and generates the subjects that the options select. Errors: those of demo::render; usage
// (no scene is selected).
demo::Result<> add_subjects(ErrorTimeBench& bench);

// Summarises the family: geometric means of RMSE per class and half, and over classes of equal
// weight. Appends a row per mean, and replaces the table of the terminal.
void add_family_summary(ErrorTimeBench& bench);

} // namespace dermis::tools
