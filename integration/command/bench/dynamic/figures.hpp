#pragma once
// Error and steadiness of a technique over a sequence, at pixels whose truth is known.

#include <cstdint>
#include <vector>

namespace dermis::tools {

// Light at the reference's pixels of one frame, 3 values a pixel.
struct FrameLight {
  std::vector<double> found, truth;
};

struct SequenceFigures {
  double psnr_db_frame = 0;       // of the mean of the frames' mean square errors
  double psnr_db_sdr8 = 0;        // tonemapped, 8 bit
  double psnr_db_accumulated = 0; // moving mean (weight .1) against that of the truth
  double flicker = 0;             // RMS of the change from frame to frame less that of the truth
  std::vector<double> psnr_db;    // of each frame, from the first
};

// `counted`: the first frame that counts. `still`: frames share their pixels; else psnr_db_accumulated and
// flicker stay 0. `exposure`: factor on all light.
SequenceFigures sequence_figures(const std::vector<FrameLight>& frames, uint32_t counted, bool still,
                                 double exposure);

} // namespace dermis::tools
