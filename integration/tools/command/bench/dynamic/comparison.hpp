#pragma once
// Rows of `dermis bench dynamic`, compared with each other and with published figures.

#include "integration/tools/command/bench/dynamic/dynamic_file.hpp"
#include "integration/tools/command/bench/dynamic/figures.hpp"
#include "integration/tools/command/bench/report/report.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// One technique over one sequence.
struct DynamicRow {
  std::string scene, framing;
  double d_px = 0;
  DynamicTechnique technique;
  double mean_spp = 0, peak_spp = 0;
  double group_spp = 0; // mean over pixels of the most samples of a pixel in the same 8x8 tile
  std::optional<double> reads_per_pixel = {};
  double mean_ms = 0, max_ms = 0, sampling_ms = 0;
  SequenceFigures figures = {};
  std::optional<double> flicker = {}; // not set if camera or surfaces move
  uint64_t history_bytes = 0;
  std::vector<double> spp = {}; // samples per pixel of each counted frame
};

// Adds facts over the `close` sequences with changing light: sap_residual against afis + ccv
// (samples and time as geometric means of ratios, PSNR as a mean difference), sap against the same,
// ocv against spvg, and peak against mean samples of split_half. Unmeasured comparisons are
// omitted.
void add_comparisons(Report& report, std::span<const DynamicRow> rows);

// Fills the second table: samples, time and 8-bit PSNR of flashing, regular and dynamic light as
// published (Xie et al. 2021, table 3) and as measured. The maxima are over frames: samples of AS
// over samples with the control, and PSNR with the control over PSNR of AS. Each scene also
// has a row of `fixed`.
void add_published(Report& report, std::span<const DynamicRow> rows);

} // namespace dermis::tools
