#pragma once
// OpenEXR pictures: one part of scanlines; no, RLE or ZIP compression in, ZIP and 32-bit floats out.
// Files are hostile until checked: every size and offset is tested before it is used.

#include "integration/files/image.hpp"

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
// ignored. Half, float and uint channels become float. Empty on failure (missing, too large, malformed,
// incomplete, tiled, deep, multi-part, subsampled, another compression, no accepted set of channels present)
// with one sentence in `error` that names the file and the reason. Values are as stored: NaN and infinities
// pass.
std::optional<Image> read_exr(const std::filesystem::path& path, std::span<const ChannelNames> accepted,
                              std::string& error);

// Writes all channels under the given names (one each, all different). Atomic; see bytes.hpp for failures.
bool write_exr(const std::filesystem::path& path, const Image& image, const ChannelNames& names,
               std::string& error);

} // namespace dermis::tools
