#pragma once
// Statistics of a frame that classification could report, as keys of the error table.

#include "integration/tools/files/capture.hpp"

namespace dermis::tools {

struct FrameKeys {
  double tile_contrast = 0; // RMS over tiles of the range of exposed luminance in a tile
  double cell_contrast = 0; // the same in cells of 4x4 tiles
  double gaps = 0;          // fraction of the tiles with subsurface that also have other pixels
};
FrameKeys keys_of(const CapturedFrame& frame, double exposure);

} // namespace dermis::tools
