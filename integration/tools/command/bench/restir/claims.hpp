#pragma once
// What reuse is expected to do to the error, whatever the device takes for it: by the number of frames alone.

#include "integration/tools/command/bench/restir/restir_report.hpp"

#include <span>
#include <string>

namespace dermis::tools {

// For people.
std::string expectation_text();
// Sets mse_at_most of the rows of one scene and number of paths at a time: spatial reuse no more than none;
// temporal reuse and spatiotemporal reuse half of that, and of spatial reuse by the same shift; a sequence no
// more than the worse of its two parts.
void expect_of_reuse(std::span<RestirRow> rows);
// Rows whose "holds" is false.
size_t rows_that_err_more(const ReportTable& table);

} // namespace dermis::tools
