#pragma once
// The results of a bench and their output formats: JSON and CSV for programs, one self-contained
// HTML page. All benches use these structs.

#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace dermis::tools {

using ReportVariant = std::variant<std::monostate, bool, int64_t, double, std::string>;

// monostate means not measured: null in JSON, empty in CSV, a dash in tables.
struct ReportValue : ReportVariant {
  ReportValue() = default;
  ReportValue(bool value) : ReportVariant(value) {}
  ReportValue(double value) : ReportVariant(value) {}
  ReportValue(std::string value) : ReportVariant(std::move(value)) {}
  ReportValue(std::string_view value) : ReportVariant(std::string(value)) {}
  ReportValue(const char* value) : ReportVariant(std::string(value)) {}
  template <std::integral T> ReportValue(T value) : ReportVariant(static_cast<int64_t>(value)) {}
  template <class T> ReportValue(const std::optional<T>& value) {
    if (value) *this = ReportValue(*value);
  }
};

// The meaning of a flag in a column.
enum class Goal : uint8_t {
  none,
  best,     // true: marks the row as one of the best
  advisory, // false: marks the row, which misses its limits
  required, // false: as `advisory`, and the suite fails
};

struct ColumnStyle {
  int digits = 3;      // significant digits of numbers in tables
  bool in_text = true; // also in the terminal's table
  bool groups = false; // a change of the value starts a group of rows in the terminal's table
  Goal goal = Goal::none;
};

struct ReportColumn {
  std::string key;   // in JSON and CSV; "a.b" is member b of the object a in JSON
  std::string title; // in tables, with the unit; "": only in JSON and CSV
  ColumnStyle style = {};
};

struct ReportTable {
  std::vector<ReportColumn> columns;
  std::vector<std::vector<ReportValue>> rows; // each as long as `columns`
};

struct PlotPoint {
  double x = 0, y = 0; // > 0
  std::string label;   // tooltip
  bool on_front = false;
};
struct PlotSeries {
  std::string name; // series of equal name have equal colour in all plots
  std::vector<PlotPoint> points;
  bool baseline = false; // not one of the project's techniques; drawn in grey
};
// Both axes are logarithmic. Points on the front are filled and joined by a line.
struct Plot {
  std::string title, x_title, y_title;
  std::vector<PlotSeries> series;
  bool over_frames = false; // x is the frame number from 0: linear axis, a line through each series
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
  std::vector<std::string> notes;                        // omitted parts, with reasons
  // additional members of the JSON document
  std::vector<std::pair<std::string, ReportValue>> constants = {};
  ReportTable table;
  std::vector<Plot> plots;
  std::string plots_title, plots_text; // "": default title and text
  std::vector<ReportPictures> pictures;
  std::string more_title,
      // title and text of a second table, only in HTML: published figures next to measured ones
      more_text;
  ReportTable more;
  std::string text = {}; // replaces the table in the terminal
};

// Returns facts that every bench states: command, processor, threads, and the device if given.
std::vector<std::pair<std::string, std::string>> machine_info(const std::string& command,
                                                              const std::string& device);

// Returns the value as a table shows it.
std::string cell_text(const ReportValue& value, const ReportColumn& column);
// Returns whether the column holds text.
bool is_text(const ReportTable& table, size_t column);
// Counts rows in which a flag of this goal is false, and rows with such a flag.
struct GoalCount {
  size_t missed = 0, rows = 0;
};
GoalCount count_goals(const ReportTable& table, Goal goal);
// Returns a line on the goals that the rows meet or miss; "" for a table without goals.
std::string verdict_of(const ReportTable& table);

// Returns the table, the notes and the facts for a terminal.
std::string report_as_text(const Report& report);
std::string report_as_json(const Report& report);
std::string report_as_csv(const Report& report);
// Returns a page without external resources, in the reader's light or dark scheme. With scripts
// enabled, a click on a title sorts the table.
std::string report_as_html(const Report& report);

// Writes the requested files: "" omits a file, "-" is standard output. A file that cannot be
// written does not prevent the others. Returns the first problem, or "".
std::string deliver_report(const Report& report, const std::string& json, const std::string& csv,
                           const std::string& html);

// Returns whether a technique is not one of the project's own, by its name in the reports.
bool is_baseline(std::string_view technique);

// A series of the page's plots. Each has its own colour; baselines are all grey and differ in the
// dashes of their lines.
struct SeriesName {
  std::string name;
  bool baseline = false;
};
// Returns the index of a name, or names.size() if it is missing.
size_t place_of(const std::vector<SeriesName>& names, std::string_view name);
// CSS class, such as "s2 base b0"
std::string series_class(const std::vector<SeriesName>& names, size_t place);

// Returns the SVG of a plot; `names` holds the names of all series of the page in order.
std::string plot_as_svg(const Plot& plot, const std::vector<SeriesName>& names);

} // namespace dermis::tools
