#include "integration/files/exr.hpp"

#include "integration/files/bytes.hpp"
#include "integration/files/exr_layout.hpp"
#include "integration/files/zlib.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>
#include <string_view>

namespace dermis::tools {

namespace {

using namespace exr_layout;

// Reads on until the first step beyond the end; from then on everything is 0 and `good` is false.
struct ByteReader {
  std::span<const uint8_t> bytes;
  size_t at = 0;
  bool good = true;

  std::span<const uint8_t> take(uint64_t size) {
    if (size > bytes.size() - at) {
      good = false;
      at = bytes.size();
      return {};
    }
    at += size;
    return bytes.subspan(at - size, size);
  }
  uint32_t u32() {
    const auto b = take(4);
    return b.empty() ? 0 : uint32_t{b[0]} | uint32_t{b[1]} << 8 | uint32_t{b[2]} << 16 | uint32_t{b[3]} << 24;
  }
  uint64_t u64() {
    const uint64_t low = u32();
    return low | uint64_t{u32()} << 32;
  }
  std::string text() {
    const auto end = std::find(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), uint8_t{0});
    if (end == bytes.end()) {
      good = false;
      return {};
    }
    const auto found = take(static_cast<size_t>(end - bytes.begin()) - at);
    take(1);
    return {found.begin(), found.end()};
  }
};

// Deflate, the densest of the compressions, packs at most 258 bytes into 2 bits: no file holds more than this
// many times its own size, whatever size its header claims.
constexpr uint64_t most_packed = 258 * 8 / 2;

struct Channel {
  std::string name;
  PixelType type = PixelType::real;
  size_t offset = 0; // bytes from the start of a line to this channel's values
};

struct Header {
  std::vector<Channel> channels;
  Compression compression = Compression::none;
  int64_t left = 0, top = 0, width = 0, height = 0;
  size_t line_bytes = 0;
  bool has_channels = false, has_compression = false, has_window = false;
};

// Each returns why the file is not read, or "".
std::string read_channels(ByteReader in, Header& header) {
  while (in.good) {
    Channel channel{.name = in.text()};
    if (channel.name.empty()) break;
    const uint32_t type = in.u32();
    in.take(4); // a hint about perception
    const uint32_t step_x = in.u32(), step_y = in.u32();
    if (type > 2) return fmt::format("channel '{}' has an unknown type of value", channel.name);
    if (step_x != 1 || step_y != 1) return fmt::format("channel '{}' is subsampled", channel.name);
    channel.type = static_cast<PixelType>(type);
    header.channels.push_back(std::move(channel));
  }
  header.has_channels = true;
  return in.good && !header.channels.empty() ? "" : "the list of channels is damaged";
}

std::string read_attribute(const std::string& name, std::span<const uint8_t> value, Header& header) {
  ByteReader in{value};
  if (name == "channels") return read_channels(in, header);
  if (name == "compression") {
    const auto byte = in.take(1);
    if (byte.empty() || byte[0] > static_cast<uint8_t>(Compression::zip))
      return "its compression is not read; save it with ZIP compression or none";
    header.compression = static_cast<Compression>(byte[0]);
    header.has_compression = true;
  }
  if (name == "dataWindow") {
    const auto left = std::bit_cast<int32_t>(in.u32()), top = std::bit_cast<int32_t>(in.u32());
    const auto right = std::bit_cast<int32_t>(in.u32()), bottom = std::bit_cast<int32_t>(in.u32());
    header.left = left;
    header.top = top;
    header.width = int64_t{right} - left + 1;
    header.height = int64_t{bottom} - top + 1;
    header.has_window = in.good;
  }
  return {};
}

std::string read_header(ByteReader& in, Header& header) {
  if (in.u32() != magic) return "it is not an OpenEXR file";
  const uint32_t flags = in.u32();
  if ((flags & version_mask) != version) return fmt::format("its format version is {}", flags & version_mask);
  if ((flags & ~(version_mask | long_names)) != 0)
    return "it is tiled, deep or of several parts; save it as one part of scanlines";
  while (in.good) {
    const std::string name = in.text();
    if (name.empty()) break;
    in.text(); // the type follows from the name for all that are read here
    const uint32_t size = in.u32();
    const auto value = in.take(size);
    if (!in.good) break;
    if (std::string why = read_attribute(name, value, header); !why.empty()) return why;
  }
  if (!in.good || !header.has_channels || !header.has_compression || !header.has_window)
    return "its header is damaged or cut off";
  if (header.width < 1 || header.height < 1 || header.width > max_image_side ||
      header.height > max_image_side)
    return fmt::format("it measures {} x {} pixels; sides of 1 to {} are read", header.width, header.height,
                       max_image_side);
  for (Channel& channel : header.channels) {
    channel.offset = header.line_bytes;
    header.line_bytes += static_cast<size_t>(header.width) * bytes_of(channel.type);
  }
  if (header.line_bytes * static_cast<uint64_t>(header.height) > max_image_bytes)
    return fmt::format("its {} channels hold more than {} bytes", header.channels.size(), max_image_bytes);
  return {};
}

bool unpack_rle(std::span<const uint8_t> packed, std::span<uint8_t> out) {
  size_t from = 0, to = 0;
  while (from < packed.size()) {
    const auto count = std::bit_cast<int8_t>(packed[from++]);
    const size_t size = count < 0 ? static_cast<size_t>(-int{count}) : static_cast<size_t>(count) + 1;
    const size_t needed = count < 0 ? size : 1;
    if (size > out.size() - to || needed > packed.size() - from) return false;
    for (size_t i = 0; i < size; ++i)
      out[to + i] = packed[from + (count < 0 ? i : 0)];
    from += needed;
    to += size;
  }
  return to == out.size();
}

bool unpack(Compression compression, std::span<const uint8_t> stored, std::vector<uint8_t>& plain) {
  if (stored.size() == plain.size()) { // what does not shrink is stored as it is
    std::copy(stored.begin(), stored.end(), plain.begin());
    return true;
  }
  if (compression == Compression::none || stored.size() > plain.size()) return false;
  const bool good = compression == Compression::rle ? unpack_rle(stored, plain) : zlib_inflate(stored, plain);
  if (good) plain = restore(std::move(plain));
  return good;
}

float half_value(uint32_t bits) {
  const uint32_t exponent = bits >> 10 & 31, fraction = bits & 1023;
  const float sign = bits & 0x8000 ? -1.0f : 1.0f;
  if (exponent == 31) return fraction ? NAN : sign * INFINITY;
  if (exponent == 0) return sign * std::ldexp(static_cast<float>(fraction), -24);
  return sign * std::ldexp(static_cast<float>(1024 + fraction), static_cast<int>(exponent) - 25);
}

float value_at(std::span<const uint8_t> line, const Channel& channel, size_t x) {
  ByteReader in{line.subspan(channel.offset + x * bytes_of(channel.type), bytes_of(channel.type))};
  switch (channel.type) {
  case PixelType::half:
    return half_value(uint32_t{in.bytes[0]} | uint32_t{in.bytes[1]} << 8);
  case PixelType::uint:
    return static_cast<float>(in.u32());
  case PixelType::real:
    break;
  }
  return std::bit_cast<float>(in.u32());
}

// Positions in the file of the first accepted set that is there; empty: none.
std::vector<size_t> select_channels(const Header& header, std::span<const ChannelNames> accepted) {
  for (const ChannelNames& names : accepted) {
    if (names.size() == 1 && names[0] == "*") {
      if (header.channels.size() == 1) return {0};
      continue;
    }
    std::vector<size_t> positions;
    for (const std::string& name : names)
      for (size_t c = 0; c < header.channels.size(); ++c)
        if (header.channels[c].name == name && positions.size() < names.size()) positions.push_back(c);
    if (positions.size() == names.size()) return positions;
  }
  return {};
}

std::string describe_mismatch(const Header& header, std::span<const ChannelNames> accepted) {
  std::vector<std::string> present, wanted;
  for (const Channel& channel : header.channels)
    present.push_back(channel.name);
  for (const ChannelNames& names : accepted)
    wanted.push_back(names == ChannelNames{"*"} ? "a single channel"
                                                : fmt::format("{}", fmt::join(names, ",")));
  return fmt::format("it has the channels {}; expected {}", fmt::join(present, ","),
                     fmt::join(wanted, " or "));
}

std::string read_pixels(ByteReader in, const Header& header, const std::vector<size_t>& positions,
                        Image& image) {
  const std::span<const uint8_t> file = in.bytes;
  const auto height = static_cast<uint64_t>(header.height), lines = uint64_t{lines_of(header.compression)};
  const uint64_t chunks = (height + lines - 1) / lines;
  if (chunks * 8 > file.size() - in.at) return "its table of lines is cut off";
  if (header.line_bytes * height / most_packed > file.size()) return "its lines are cut off";
  image = Image::sized(static_cast<uint32_t>(header.width), static_cast<uint32_t>(header.height),
                       static_cast<uint32_t>(positions.size()));
  std::vector<bool> seen(chunks);
  std::vector<uint8_t> plain;
  for (uint64_t chunk = 0; chunk < chunks; ++chunk) {
    const uint64_t offset = in.u64();
    if (offset > file.size()) return "its lines are cut off";
    ByteReader body{file, static_cast<size_t>(offset)};
    const int64_t first = int64_t{std::bit_cast<int32_t>(body.u32())} - header.top;
    const auto stored = body.take(body.u32());
    if (!body.good) return "its lines are cut off";
    if (first < 0 || first >= header.height || static_cast<uint64_t>(first) % lines != 0 ||
        seen[static_cast<uint64_t>(first) / lines])
      return "its lines are out of place";
    seen[static_cast<uint64_t>(first) / lines] = true;
    const uint64_t count = std::min(lines, height - static_cast<uint64_t>(first));
    plain.resize(count * header.line_bytes);
    if (!unpack(header.compression, stored, plain)) return "its lines are damaged";
    for (uint64_t y = 0; y < count; ++y) {
      const std::span<const uint8_t> line(plain.data() + y * header.line_bytes, header.line_bytes);
      for (size_t c = 0; c < positions.size(); ++c)
        for (uint32_t x = 0; x < image.width; ++x)
          image.at(x, static_cast<uint32_t>(static_cast<uint64_t>(first) + y), static_cast<uint32_t>(c)) =
              value_at(line, header.channels[positions[c]], x);
    }
  }
  return {};
}

} // namespace

std::optional<Image> read_exr(const std::filesystem::path& path, std::span<const ChannelNames> accepted,
                              std::string& error) {
  try {
    const auto bytes = read_bytes(path, max_image_file_bytes, error);
    if (!bytes) return std::nullopt;
    ByteReader in{*bytes};
    Header header;
    Image image;
    std::string why = read_header(in, header);
    if (why.empty()) {
      const std::vector<size_t> positions = select_channels(header, accepted);
      why =
          positions.empty() ? describe_mismatch(header, accepted) : read_pixels(in, header, positions, image);
    }
    if (why.empty()) return image;
    error = fmt::format("'{}' cannot be read as an OpenEXR picture: {}", path.string(), why);
  } catch (const std::bad_alloc&) {
    error = fmt::format("'{}' does not fit into memory", path.string());
  }
  return std::nullopt;
}

} // namespace dermis::tools
