#pragma once
// Rows of earlier runs of the bench, to fit a table to scenes that were measured in parts or on
// another machine.

#include "integration/tools/command/bench/error_table/table_fit.hpp"

#include "framegraph/text/document.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct ErrorTableRow {
  MeasuredError error;
  uint32_t frames = 1;
};

struct MeasuredRows {
  std::string device; // human-readable
  std::vector<ErrorTableRow> rows;
};

// Reads what `bench error-table --json` wrote. Returns nullopt with errors in `diagnostics`.
std::optional<MeasuredRows> read_measured_rows(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
