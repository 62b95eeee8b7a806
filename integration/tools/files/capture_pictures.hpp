#pragma once
// The pictures of one captured frame: which there are, what their channels are called, how they are read and
// repaired.

#include "framegraph/text/document.hpp"
#include "integration/tools/files/capture.hpp"
#include "integration/tools/files/exr.hpp"

namespace dermis::tools {

struct PictureKind {
  const char* name; // file name without ".exr"
  Image CapturedFrame::*image;
  bool required, signed_values;
  std::vector<ChannelNames> channels; // accepted; the first is written
};

// All but `profile`, whose values are ids.
const std::vector<PictureKind>& picture_kinds();
const std::vector<ChannelNames>& profile_channels();

// Reads all pictures of `frame.description` from the folder: files, or links to files below it or one of
// `roots`. Errors are located in frame.json.
void read_pictures(const std::filesystem::path& folder, const Document& document, CapturedFrame& frame,
                   Diagnostics& diagnostics, FileRoots roots = {});

} // namespace dermis::tools
