#pragma once
// Reads and writes OpenEXR images through the OpenEXR library.
// Reading accepts one part of scanlines or tiles (the largest of several levels) and every
// compression of OpenEXR 3.1. Writing uses scanlines, ZIP compression and 32-bit floats. Files are
// untrusted: sizes are checked before memory is allocated.

#include "integration/tools/files/image.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// Channel names in the requested order. The name "*" as the only entry means the only channel of a
// one-channel file.
using ChannelNames = std::vector<std::string>;
inline const ChannelNames rgb_names = {"R", "G", "B"};

// Reads the channels of the first entry of `accepted` whose names are all present; other channels
// are ignored. Half, float and uint channels become float. The image covers the file's display
// window: pixels outside the data window are 0, and pixels outside the display window are dropped.
// NaN and infinities are returned as stored.
// Returns nullopt and sets `error` to one sentence with the file and the reason on failure:
// missing, too large, malformed, incomplete, deep, multi-part, subsampled, unsupported compression,
// or no accepted set of channels.
std::optional<Image> read_exr(const std::filesystem::path& path,
                              std::span<const ChannelNames> accepted, std::string& error);

// Writes all channels under the given names, which must be distinct, one per channel. Atomic;
// bytes.hpp describes failures.
bool write_exr(const std::filesystem::path& path, const Image& image, const ChannelNames& names,
               std::string& error);

} // namespace dermis::tools
