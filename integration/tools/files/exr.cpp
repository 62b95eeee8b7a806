#include "integration/tools/files/exr.hpp"

#include "integration/tools/files/bytes.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfTestFile.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledInputFile.h>
#include <OpenEXR/ImfVersion.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace dermis::tools {

namespace {

// decoded; OpenEXR allocates a few chunks at a time
constexpr uint64_t max_chunk_bytes = uint64_t{512} << 20;

struct Method {
  const char* name;
  uint32_t lines; // scanlines per chunk
};
// In the order of Imf::Compression. The last two exist since OpenEXR 3.4.
constexpr std::array<Method, 12> methods = {{{"none", 1},
                                             {"RLE", 1},
                                             {"ZIPS", 1},
                                             {"ZIP", 16},
                                             {"PIZ", 32},
                                             {"PXR24", 16},
                                             {"B44", 32},
                                             {"B44A", 32},
                                             {"DWAA", 32},
                                             {"DWAB", 256},
                                             {"HTJ2K256", 256},
                                             {"HTJ2K32", 32}}};

class MemoryInput : public Imf::IStream {
public:
  MemoryInput(const std::string& name, std::span<const uint8_t> bytes)
      : Imf::IStream(name.c_str()), bytes_(bytes) {}
  bool read(char out[], int count) override {
    if (count < 0 || static_cast<uint64_t>(count) > bytes_.size() - at_)
      throw std::runtime_error("the file ends early");
    std::memcpy(out, bytes_.data() + at_, static_cast<size_t>(count));
    at_ += static_cast<size_t>(count);
    return at_ < bytes_.size();
  }
  uint64_t tellg() override { return at_; }
  void seekg(uint64_t position) override {
    if (position > bytes_.size())
      throw std::runtime_error("a part of the file lies beyond its end");
    at_ = static_cast<size_t>(position);
  }

private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
};

// Reads header attributes before OpenEXR allocates memory for them. After the first read beyond the
// end, `good` is false and all values are 0.
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
    return b.empty()
               ? 0
               : uint32_t{b[0]} | uint32_t{b[1]} << 8 | uint32_t{b[2]} << 16 | uint32_t{b[3]} << 24;
  }
  std::string_view text() {
    const auto end =
        std::find(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.end(), uint8_t{0});
    if (end == bytes.end()) {
      good = false;
      return {};
    }
    const auto found = take(static_cast<size_t>(end - bytes.begin()) - at);
    take(1);
    return {reinterpret_cast<const char*>(found.data()), found.size()};
  }
};

// Returns the reason to reject the file, or "". On success every attribute lies inside the file,
// the compression is one that OpenEXR reads, and no attribute that locates pixels is left to
// OpenEXR's defaults.
std::string check_attributes(std::span<const uint8_t> file, bool& tiled) {
  ByteReader in{file};
  if (in.u32() != static_cast<uint32_t>(Imf::MAGIC)) return "it is not an OpenEXR file";
  const auto flags = static_cast<int>(in.u32());
  if (Imf::getVersion(flags) != Imf::EXR_VERSION || !Imf::supportsFlags(Imf::getFlags(flags)))
    return fmt::format("its format version is {}, with flags {:#x}; version 2 is read",
                       Imf::getVersion(flags), static_cast<uint32_t>(Imf::getFlags(flags)));
  if (Imf::isMultiPart(flags)) return "it has several parts; save it as one part";
  if (Imf::isNonImage(flags)) return "it is deep; save it as flat scanlines or tiles";
  tiled = Imf::isTiled(flags);
  std::vector<std::string_view> missing = {"channels", "compression", "dataWindow",
                                           "displayWindow"};
  while (in.good) {
    const std::string_view name = in.text();
    if (!in.good || name.empty()) break;
    in.text(); // skips the type, which OpenEXR checks
    const auto value = in.take(in.u32());
    std::erase(missing, name);
    if (name != "compression" || value.empty() || value[0] < Imf::NUM_COMPRESSION_METHODS) continue;
    return fmt::format("its compression {} is not read; save it with ZIP, PIZ or none",
                       value[0] < methods.size() ? methods[value[0]].name
                                                 : fmt::format("(number {})", value[0]));
  }
  if (!in.good) return "its header is damaged or cut off";
  return missing.empty() ? "" : fmt::format("its header has no '{}'", missing.front());
}

struct Window {
  int64_t left, top, width, height;

  explicit Window(const Imath::Box2i& box)
      : left(box.min.x), top(box.min.y), width(int64_t{box.max.x} - box.min.x + 1),
        height(int64_t{box.max.y} - box.min.y + 1) {}
  uint64_t pixels() const { return static_cast<uint64_t>(width) * static_cast<uint64_t>(height); }
};

// Returns the reason to reject an image of these sizes, or "". Runs before pixels are allocated.
std::string check_sizes(const Imf::Header& header, bool tiled, size_t read_channels,
                        size_t file_bytes) {
  const Window data(header.dataWindow()), display(header.displayWindow());
  for (const auto& [name, window] : {std::pair("data", data), std::pair("display", display)})
    if (window.width < 1 || window.height < 1 || window.width > max_image_side ||
        window.height > max_image_side)
      return fmt::format("its {} window measures {} x {} pixels; sides of 1 to {} are read", name,
                         window.width, window.height, max_image_side);
  uint64_t pixel_bytes = 0, channels = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c, ++channels)
    pixel_bytes += c.channel().type == Imf::HALF ? 2 : 4;
  const uint64_t maximum = max_decoded_bytes(file_bytes);
  if (pixel_bytes > maximum || data.pixels() > maximum / pixel_bytes)
    return fmt::format("its {} channels hold more than {} bytes", channels, maximum);
  if (display.pixels() > maximum / (read_channels * sizeof(float)))
    return fmt::format("its display window holds more than {} bytes", maximum);
  uint64_t chunk = static_cast<uint64_t>(data.width) *
                   std::min(static_cast<uint64_t>(data.height),
                            uint64_t{methods[static_cast<size_t>(header.compression())].lines});
  if (tiled) {
    const Imf::TileDescription& tile = header.tileDescription();
    if (tile.xSize > max_image_side || tile.ySize > max_image_side)
      return fmt::format("its tiles measure {} x {} pixels; at most {} per side are read",
                         tile.xSize, tile.ySize, max_image_side);
    chunk = uint64_t{tile.xSize} * tile.ySize;
  }
  if (chunk > max_chunk_bytes / pixel_bytes)
    return fmt::format("one of its chunks holds more than {} bytes", max_chunk_bytes);
  return {};
}

// Returns the first accepted set of names whose channels are all present, or an empty list.
ChannelNames select_channels(const Imf::ChannelList& channels,
                             std::span<const ChannelNames> accepted) {
  for (const ChannelNames& names : accepted) {
    if (names == ChannelNames{"*"}) {
      auto next = channels.begin();
      if (next != channels.end() && ++next == channels.end()) return {channels.begin().name()};
    } else if (std::all_of(names.begin(), names.end(), [&](const std::string& name) {
                 return channels.findChannel(name) != nullptr;
               })) {
      return names;
    }
  }
  return {};
}

std::string describe_mismatch(const Imf::ChannelList& channels,
                              std::span<const ChannelNames> accepted) {
  std::vector<std::string> present, expected;
  for (auto c = channels.begin(); c != channels.end(); ++c)
    present.emplace_back(c.name());
  for (const ChannelNames& names : accepted)
    expected.push_back(names == ChannelNames{"*"} ? "a single channel"
                                                  : fmt::format("{}", fmt::join(names, ",")));
  return fmt::format("it has the channels {}; expected {}", fmt::join(present, ","),
                     fmt::join(expected, " or "));
}

// Rows of the data window, decoded in blocks.
struct Rows {
  Window data;
  const ChannelNames& names;
  int64_t step; // rows per call of `decode`
  std::function<void(const Imf::FrameBuffer&, int first, int last)> decode;
  std::vector<float> values = {};
  int64_t first = data.top, last = data.top - 1; // rows that `values` holds, both included

  const float* at(int64_t y) {
    if (y > last) {
      first = y - (y - data.top) % step;
      last = std::min(first + step, data.top + data.height) - 1;
      values.resize(static_cast<size_t>((last - first + 1) * data.width) * names.size());
      Imf::FrameBuffer target;
      for (size_t c = 0; c < names.size(); ++c)
        target.insert(
            names[c],
            Imf::Slice::Make(Imf::FLOAT, &values[c],
                             Imath::V2i(static_cast<int>(data.left), static_cast<int>(first)),
                             data.width, last - first + 1, names.size() * sizeof(float)));
      decode(target, static_cast<int>(first), static_cast<int>(last));
    }
    return values.data() + static_cast<size_t>((y - first) * data.width) * names.size();
  }
};

// Copies the data window into the display window. Pixels outside the data window are 0; pixels
// outside the display window are dropped. The image grows row by row, so that a damaged file
// allocates little.
Image place(Rows& rows, const Window& display) {
  const Window& data = rows.data;
  const size_t channels = rows.names.size(), row = static_cast<size_t>(display.width) * channels;
  const int64_t left = std::max(data.left, display.left),
                right = std::min(data.left + data.width, display.left + display.width);
  Image image{static_cast<uint32_t>(display.width),
              static_cast<uint32_t>(display.height),
              static_cast<uint32_t>(channels),
              {}};
  image.values.reserve(row * static_cast<size_t>(display.height));
  for (int64_t y = display.top; y < display.top + display.height; ++y) {
    const size_t begin = image.values.size();
    if (y >= data.top && y < data.top + data.height) {
      const float* from = rows.at(y) + static_cast<size_t>(left - data.left) * channels;
      image.values.resize(begin + static_cast<size_t>(left - display.left) * channels);
      image.values.insert(image.values.end(), from,
                          from + static_cast<size_t>(right - left) * channels);
    }
    image.values.resize(begin + row);
  }
  return image;
}

std::string decode(const std::string& name, std::span<const uint8_t> file,
                   std::span<const ChannelNames> accepted, Image& image) {
  bool tiled = false;
  if (std::string why = check_attributes(file, tiled); !why.empty()) return why;
  Imf::Header header;
  MemoryInput stream(name, file);
  stream.seekg(8); // after magic number and version
  int version = Imf::EXR_VERSION;
  header.readFrom(stream, version);
  header.sanityCheck(tiled);
  const ChannelNames names = select_channels(header.channels(), accepted);
  if (names.empty()) return describe_mismatch(header.channels(), accepted);
  for (const std::string& channel : names)
    if (const Imf::Channel& one = header.channels()[channel];
        one.xSampling != 1 || one.ySampling != 1)
      return fmt::format("channel '{}' is subsampled", channel);
  if (std::string why = check_sizes(header, tiled, names.size(), file.size()); !why.empty())
    return why;
  const Window data(header.dataWindow()), display(header.displayWindow());
  if (!header.dataWindow().intersects(header.displayWindow()))
    return "its data window lies outside of its display window";

  stream.seekg(0);
  constexpr int threads = 0;
  if (tiled) {
    Imf::TiledInputFile input(stream, threads);
    const auto side = static_cast<int64_t>(header.tileDescription().ySize);
    Rows rows{data, names, side, [&](const Imf::FrameBuffer& target, int first, int) {
                const int row = static_cast<int>((first - data.top) / side);
                input.setFrameBuffer(target);
                input.readTiles(0, input.numXTiles(0) - 1, row, row);
              }};
    image = place(rows, display);
  } else {
    Imf::InputFile input(stream, threads);
    constexpr int64_t lines = 256; // a multiple of every compression's scanlines per chunk
    Rows rows{data, names, lines, [&](const Imf::FrameBuffer& target, int first, int last) {
                input.setFrameBuffer(target);
                input.readPixels(first, last);
              }};
    image = place(rows, display);
  }
  return {};
}

} // namespace

std::optional<Image> read_exr(const std::filesystem::path& path,
                              std::span<const ChannelNames> accepted, std::string& error) {
  try {
    const auto bytes = read_bytes(path, max_image_file_bytes, error);
    if (!bytes) return std::nullopt;
    Image image;
    std::string why;
    try {
      why = decode(path.filename().string(), *bytes, accepted, image);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& problem) { // thrown by OpenEXR
      why = fmt::format("it is damaged or cut off: {}", problem.what());
    }
    if (why.empty()) return image;
    error = fmt::format("'{}' cannot be read as an OpenEXR picture: {}", path.string(), why);
  } catch (const std::bad_alloc&) {
    error = fmt::format("'{}' does not fit into memory", path.string());
  }
  return std::nullopt;
}

} // namespace dermis::tools
