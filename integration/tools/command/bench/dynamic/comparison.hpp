#pragma once
// What the rows of `dermis bench dynamic` say against each other and beside what was published.

#include "integration/tools/command/bench/report/report.hpp"

namespace dermis::tools {

// Adds facts: sap_residual against afis + ccv over the sequences `close` whose light changes (samples and
// time as ratios, geometric means; PSNR as a difference, mean), sap against the same, ocv against spvg, and
// the most against the mean of split_half. What was not measured is left out.
void add_comparisons(Report& report);

// Fills the second table: samples, time and 8-bit PSNR of flashing, regular and dynamic light as Xie and
// others (2021, table 3) have them, and ours.
void add_published(Report& report);

} // namespace dermis::tools
