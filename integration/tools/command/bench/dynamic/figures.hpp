#pragma once
// Error and flicker of a technique over a sequence, at pixels with a reference.

#include <cstdint>
#include <vector>

namespace dermis::tools {

// Light at the reference's pixels of one frame, 3 values per pixel.
struct FrameLight {
  std::vector<double> found, reference;
  // moving mean of `found` along moving surfaces; otherwise empty
  std::vector<double> accumulated = {};
};

struct SequenceFigures {
  double psnr_db_frame = 0; // of the mean over frames of the mean square error
  double psnr_db_sdr8 = 0;  // tonemapped, 8 bits
  // PSNR of the moving mean (weight 0.1). If frames share their pixels, the reference is the moving
  // mean of the references, otherwise the frame's reference; both agree for light that rests on its
  // surface.
  double psnr_db_accumulated = 0;
  double flicker = 0;          // RMS of the frame-to-frame change minus the reference's change
  std::vector<double> psnr_db; // per frame, from the first
};

// `counted` is the first counted frame. `still` means that frames share their pixels; otherwise
// flicker stays 0, and psnr_db_accumulated stays 0 for frames without accumulated light. `exposure`
// is a factor on all light.
SequenceFigures sequence_figures(const std::vector<FrameLight>& frames, uint32_t counted,
                                 bool still, double exposure);

} // namespace dermis::tools
