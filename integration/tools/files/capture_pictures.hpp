#pragma once
// The images of one captured frame: their names, accepted channels, reading and repair.

#include "framegraph/text/document.hpp"
#include "integration/tools/files/capture.hpp"
#include "integration/tools/files/exr.hpp"

namespace dermis::tools {

struct PictureKind {
  const char* name; // file name without ".exr"
  Image CapturedFrame::*image;
  bool required, signed_values;
  std::vector<ChannelNames> channels; // accepted sets; the first is written
};

// Returns all kinds except `profile`, whose values are ids.
const std::vector<PictureKind>& picture_kinds();
const std::vector<ChannelNames>& profile_channels();

// Reads all images of `frame.description` from the folder. A file may be a link into the folder or
// one of `roots`. Errors are located in frame.json.
void read_pictures(const std::filesystem::path& folder, const Document& document,
                   CapturedFrame& frame, Diagnostics& diagnostics, FileRoots roots = {});

} // namespace dermis::tools
