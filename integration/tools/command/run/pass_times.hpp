#pragma once
// Collects device times of passes over frames and formats their medians as a table.

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/present.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

class PassTimes {
public:
  void begin_frame() { frames_.push_back(0); }
  // Adds a pass of the frame that began last.
  void add(std::string_view pass, double milliseconds);

  struct Row {
    std::string pass;
    double median = 0.0; // device time, milliseconds
    size_t frames = 0;   // number of measured frames
  };
  std::vector<Row> rows() const; // in order of first appearance
  double total() const;          // median of the sums of the frames; not all run all passes
  size_t frames() const { return frames_.size(); }
  bool empty() const { return samples_.empty(); }

private:
  struct Samples {
    std::string pass;
    std::vector<double> milliseconds;
  };
  std::vector<Samples> samples_;
  std::vector<double> frames_; // sums, milliseconds
};

// Suffix for titles of tables: caches and clocks are cold.
inline constexpr const char* first_frame = " (first frame, cold)";

// Formats pass, device time and fraction, with a sum. `title` heads the first column, followed by
// the number of measured frames.
std::string format_times(const PassTimes& times, const std::string& title);
// [{"pass": .., "milliseconds": .., "frames": ..}, ..]
void write_times(JsonWriter& writer, const PassTimes& times);

} // namespace dermis::tools
