#pragma once
// Formats human-readable text: tables, units, colour and progress.

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

enum class ColorMode : uint8_t { automatic, always, never };

// Returns whether to use colour on this file descriptor. Automatic means on a terminal, unless
// NO_COLOR is set or TERM is "dumb".
bool use_color(ColorMode mode, int file_descriptor);

// Colours the severity and the caret lines of a formatted diagnostic.
std::string color_diagnostic(std::string_view formatted);

struct Table {
  struct Column {
    std::string title;
    bool right_aligned = false;
  };
  std::vector<Column> columns;
  std::vector<std::vector<std::string>> rows; // each as long as `columns`; an empty row is a rule
};

// Formats titles, a rule and rows, with two spaces between columns and no trailing spaces. Ends in
// a newline.
std::string format_table(const Table& table);

std::string format_milliseconds(double milliseconds);           // "0.012 ms", "12.3 ms"
std::string format_duration(double seconds);                    // "4.2 s", "3 min 05 s"
std::string format_bytes(uint64_t bytes);                       // "512 B", "3.2 MiB"
std::string format_decibels(double decibels);                   // "41.23 dB"
std::string format_list(const std::vector<std::string>& words); // "sap, hybrid, off"
// "1 frame", "8 frames"; with `being` "1 frame is", "8 frames are".
std::string format_count(uint64_t count, std::string_view unit, bool being = false);

enum class ProgressStyle : uint8_t {
  none,
  bar,   // one line that is redrawn, for terminals
  lines, // one line every few seconds, for logs
};

// Returns bar if stderr is a terminal, none with --quiet or --json, and lines otherwise.
ProgressStyle progress_style(bool quiet, bool json);

// Shows the progress of work on stderr. Work shorter than two seconds shows nothing. Thread: any
// for update(), one for other functions.
class Progress {
public:
  // `total` steps of `unit` ("frame", "pixel"), titled `what`.
  Progress(ProgressStyle style, std::string what, std::string unit, uint64_t total);
  ~Progress(); // removes the bar
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(uint64_t done); // steps done so far

private:
  using Clock = std::chrono::steady_clock;
  void draw(uint64_t done, double elapsed_seconds);

  ProgressStyle style_;
  std::string what_, unit_;
  uint64_t total_;
  Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  Clock::time_point last_drawn_ = start_;
  bool bar_visible_ = false;
};

} // namespace dermis::tools
