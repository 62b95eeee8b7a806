#pragma once
// OpenEXR pictures through OpenEXR's own library. Read: one part of scanlines or tiles (of several levels the
// largest), every compression of OpenEXR 3.1. Written: scanlines, ZIP compression, 32-bit floats.
// Files are hostile until checked: sizes are checked before memory is allocated for them.

#include "integration/tools/files/image.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// Names of channels in the order wanted. The name "*" alone stands for the only channel of a file that has
// one.
using ChannelNames = std::vector<std::string>;
inline const ChannelNames rgb_names = {"R", "G", "B"};

// Reads the channels of the first entry of `accepted` whose names are all present; other channels are
// ignored. Half, float and uint channels become float. The picture is the file's display window: pixels
// outside of the data window are 0, and what the data window has outside of it is dropped. Empty on failure
// (missing, too large, malformed, incomplete, deep, multi-part, subsampled, another compression, no accepted
// set of channels present) with one sentence in `error` that names the file and the reason. Values are as
// stored: NaN and infinities pass.
std::optional<Image> read_exr(const std::filesystem::path& path, std::span<const ChannelNames> accepted,
                              std::string& error);

// Writes all channels under the given names (one each, all different). Atomic; see bytes.hpp for failures.
bool write_exr(const std::filesystem::path& path, const Image& image, const ChannelNames& names,
               std::string& error);

} // namespace dermis::tools
