#pragma once
// Device times of passes over frames: medians, and the table that shows them.

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/present.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

class PassTimes {
public:
  void add(std::string_view pass, double milliseconds);

  struct Row {
    std::string pass;
    double median = 0.0; // milliseconds of device time
    size_t frames = 0;   // that it was measured in
  };
  std::vector<Row> rows() const; // in the order in which passes first came
  double total() const;          // sum of the medians
  bool empty() const { return samples_.empty(); }

private:
  struct Samples {
    std::string pass;
    std::vector<double> milliseconds;
  };
  std::vector<Samples> samples_;
};

// For titles of tables: nothing has warmed caches and clocks up.
inline constexpr const char* first_frame = " (first frame, cold)";

// Pass, device time and share, with a sum. `title` heads the first column, with how many frames were
// measured.
std::string format_times(const PassTimes& times, const std::string& title);
// [{"pass": .., "milliseconds": .., "frames": ..}, ..]
void write_times(JsonWriter& writer, const PassTimes& times);

} // namespace dermis::tools
