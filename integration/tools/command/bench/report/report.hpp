#pragma once
// What a bench found, and how it is written: JSON and CSV for programs, one self-contained HTML page for
// people. Every bench fills the same structs.

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace dermis::tools {

// monostate: not measured; null in JSON, empty in CSV, a dash in HTML.
using ReportValue = std::variant<std::monostate, bool, int64_t, double, std::string>;

struct ReportColumn {
  std::string key;   // in JSON and CSV
  std::string title; // in HTML, with the unit; "": not shown there
  int digits = 3;    // significant, of numbers in HTML
};

struct ReportTable {
  std::vector<ReportColumn> columns;
  std::vector<std::vector<ReportValue>> rows; // each as long as `columns`

  ReportValue& at(size_t row, std::string_view key); // the column must exist
  const ReportValue& at(size_t row, std::string_view key) const;
  // As printed for people: words as they are, numbers with so many digits, "-" where there is nothing.
  std::string text_at(size_t row, std::string_view key, int digits = 0) const;
};

struct PlotPoint {
  double x = 0, y = 0; // > 0
  std::string label;   // shown when pointed at
  bool on_front = false;
};
struct PlotSeries {
  std::string name; // the same name has the same colour in all plots
  std::vector<PlotPoint> points;
  bool baseline = false; // what ours is measured against: grey
};
// Both axes logarithmic. Points on the front are filled and joined by a line.
struct Plot {
  std::string title, x_title, y_title;
  std::vector<PlotSeries> series;
  bool over_frames = false; // x counts frames from 0: an even axis, a line through each series
};

struct ReportPicture {
  std::string caption;
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgb;
};
struct ReportPictures {
  std::string title, explanation;
  std::vector<ReportPicture> pictures;
};

struct Report {
  std::string bench; // "error-time"
  std::string title, summary;
  std::vector<std::pair<std::string, std::string>> info; // machine, command, repetitions
  std::vector<std::string> notes;                        // what was left out and why
  ReportTable table;
  std::vector<Plot> plots;
  std::string plots_title, plots_text; // "": those of time against error, or over frames
  std::vector<ReportPictures> pictures;
  std::string more_title,
      more_text; // of a second table, in HTML alone: where what was published is set beside ours
  ReportTable more;
};

// Facts that every bench states: command, processor, threads, and where given the device.
std::vector<std::pair<std::string, std::string>> machine_info(const std::string& command,
                                                              const std::string& device);

std::string report_as_json(const Report& report);
std::string report_as_csv(const Report& report);
// Nothing is loaded from elsewhere; follows the reader's light or dark scheme. Works without scripts; with
// them tables sort by a click on a title.
std::string report_as_html(const Report& report);

// Writes what is asked for: "" leaves one out, "-" is standard output. Returns what went wrong, "" for
// nothing.
std::string deliver_report(const Report& report, const std::string& json, const std::string& csv,
                           const std::string& html);

// Is it what others do, and not one of the project's own techniques? By its name in the reports.
bool is_baseline(std::string_view technique);

// A series of the page's plots: each has a look of its own, baselines by their lines alone.
struct SeriesName {
  std::string name;
  bool baseline = false;
};
// Index of a name; names.size() where there is none.
size_t place_of(const std::vector<SeriesName>& names, std::string_view name);
std::string series_class(const std::vector<SeriesName>& names, size_t place); // of the style: "s2 base b0"

// SVG of a plot; `names` holds those of all series of the page in order.
std::string plot_as_svg(const Plot& plot, const std::vector<SeriesName>& names);

} // namespace dermis::tools
