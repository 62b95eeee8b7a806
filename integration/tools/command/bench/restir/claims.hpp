#pragma once
// Expected error reduction by reuse, for equal numbers of frames and independent of device time.

#include "integration/tools/command/bench/restir/restir_report.hpp"

#include <span>
#include <string>

namespace dermis::tools {

// Describes the expectations in words.
std::string expectation_text();
// Sets max_mse of the rows of one scene per number of paths:
// - spatial reuse: the error without reuse
// - temporal reuse: half of the error without reuse
// - spatiotemporal reuse: half of the smaller error of no reuse and of spatial reuse with its shift
// - a sequential shift: the larger error of its two parts
// Limits without the factor of a half include a margin of 10 % for statistical error.
void expect_of_reuse(std::span<RestirRow> rows);
} // namespace dermis::tools
