#pragma once
// Error and flicker of a technique over a sequence, at pixels with a reference.

#include <cstdint>
#include <vector>

namespace dermis::tools {

// Light at the reference's pixels of one frame, 3 values per pixel.
struct FrameLight {
  std::vector<double> found, reference;
  // exponential moving average of `found`, reprojected along moving surfaces; otherwise empty
  std::vector<double> accumulated = {};
};

struct SequenceFigures {
  double psnr_db_frame = 0; // of the mean over frames of the mean square error
  double psnr_db_sdr8 = 0;  // tonemapped, 8 bits
  // PSNR of an exponential moving average (weight of a new frame: 0.1). With a static camera its
  // reference is the same average of the references, otherwise the reference of the frame. Both
  // are equal if the light of each surface point is constant.
  double psnr_db_accumulated = 0;
  double flicker = 0;          // RMS of the frame-to-frame change minus the reference's change
  std::vector<double> psnr_db; // per frame, from the first
};

// `counted` is the first counted frame. `still` means that a pixel shows the same point in
// all frames; otherwise flicker stays 0, and psnr_db_accumulated stays 0 for frames without
// accumulated light. `exposure` is a factor on all light.
SequenceFigures sequence_figures(const std::vector<FrameLight>& frames, uint32_t counted,
                                 bool still, double exposure);

} // namespace dermis::tools
