#pragma once
// Compares rows of `dermis bench dynamic` with each other and with published figures.

#include "integration/tools/command/bench/report/report.hpp"

namespace dermis::tools {

// Adds facts over the `close` sequences with changing light: sap_residual against afis + ccv
// (samples and time as geometric means of ratios, PSNR as a mean difference), sap against the same,
// ocv against spvg, and peak against mean samples of split_half. Unmeasured comparisons are
// omitted.
void add_comparisons(Report& report);

// Fills the second table: samples, time and 8-bit PSNR of flashing, regular and dynamic light as
// published (Xie et al. 2021, table 3) and as measured.
void add_published(Report& report);

} // namespace dermis::tools
