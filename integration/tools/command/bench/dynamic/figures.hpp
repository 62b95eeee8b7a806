#pragma once
// Error and steadiness of a technique over a sequence, at pixels whose truth is known.

#include <cstdint>
#include <vector>

namespace dermis::tools {

// Light at the reference's pixels of one frame, 3 values a pixel.
struct FrameLight {
  std::vector<double> found, reference;
  std::vector<double> accumulated = {}; // found so far along surfaces, where these move; else empty
};

struct SequenceFigures {
  double psnr_db_frame = 0; // of the mean of the frames' mean square errors
  double psnr_db_sdr8 = 0;  // tonemapped, 8 bit
  // Of the moving mean (weight .1): where frames share their pixels against that of the truth, else against
  // the frame's truth, which light that rests on its surface gives both.
  double psnr_db_accumulated = 0;
  double flicker = 0;          // RMS of the change from frame to frame less that of the truth
  std::vector<double> psnr_db; // of each frame, from the first
};

// `counted`: the first frame that counts. `still`: frames share their pixels; else flicker stays 0, and
// psnr_db_accumulated where frames have no light accumulated. `exposure`: factor on all light.
SequenceFigures sequence_figures(const std::vector<FrameLight>& frames, uint32_t counted, bool still,
                                 double exposure);

} // namespace dermis::tools
