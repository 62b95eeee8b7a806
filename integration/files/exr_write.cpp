#include "integration/files/exr.hpp"

#include "integration/files/bytes.hpp"
#include "integration/files/exr_layout.hpp"
#include "integration/files/zlib.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <set>
#include <string_view>

namespace dermis::tools {

namespace {

using namespace exr_layout;

struct ByteWriter {
  std::vector<uint8_t> bytes;

  void raw(const void* data, size_t size) {
    const auto* first = static_cast<const uint8_t*>(data);
    bytes.insert(bytes.end(), first, first + size);
  }
  // Little-endian, whatever the machine.
  void u32(uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<uint8_t>(value >> shift));
  }
  void u64(uint64_t value) {
    u32(static_cast<uint32_t>(value));
    u32(static_cast<uint32_t>(value >> 32));
  }
  void f32(float value) {
    uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    u32(bits);
  }
  void text(std::string_view value) { // with its closing zero
    raw(value.data(), value.size());
    bytes.push_back(0);
  }
  void attribute(std::string_view name, std::string_view type, uint32_t size) {
    text(name);
    text(type);
    u32(size);
  }
};

void write_header(ByteWriter& out, const Image& image, const ChannelNames& sorted) {
  out.u32(magic);
  out.u32(version);
  size_t list = 1;
  for (const std::string& name : sorted)
    list += name.size() + 1 + 16;
  out.attribute("channels", "chlist", static_cast<uint32_t>(list));
  for (const std::string& name : sorted) {
    out.text(name);
    out.u32(static_cast<uint32_t>(PixelType::real));
    out.u32(0); // not perceptually linear, reserved
    out.u32(1);
    out.u32(1);
  }
  out.bytes.push_back(0);
  out.attribute("compression", "compression", 1);
  out.bytes.push_back(static_cast<uint8_t>(Compression::zip));
  for (const char* window : {"dataWindow", "displayWindow"}) {
    out.attribute(window, "box2i", 16);
    out.u64(0);
    out.u32(image.width - 1);
    out.u32(image.height - 1);
  }
  out.attribute("lineOrder", "lineOrder", 1);
  out.bytes.push_back(0); // increasing y
  out.attribute("pixelAspectRatio", "float", 4);
  out.f32(1);
  out.attribute("screenWindowCenter", "v2f", 8);
  out.u64(0);
  out.attribute("screenWindowWidth", "float", 4);
  out.f32(1);
  out.bytes.push_back(0);
}

// The lines [first, last) as the format orders them: by line, then by channel.
std::vector<uint8_t> gather(const Image& image, const std::vector<size_t>& order, uint32_t first,
                            uint32_t last) {
  ByteWriter out;
  for (uint32_t y = first; y < last; ++y)
    for (const size_t channel : order)
      for (uint32_t x = 0; x < image.width; ++x)
        out.f32(image.at(x, y, static_cast<uint32_t>(channel)));
  return std::move(out.bytes);
}

} // namespace

bool write_exr(const std::filesystem::path& path, const Image& image, const ChannelNames& names,
               std::string& error) {
  const size_t count = names.size();
  const bool named = std::set<std::string>(names.begin(), names.end()).size() == count &&
                     std::all_of(names.begin(), names.end(), [](const std::string& n) {
                       return !n.empty() && n.size() < 32 && n.find('\0') == std::string::npos;
                     });
  if (!named || count == 0 || count != image.channels || image.width == 0 || image.height == 0 ||
      image.width > max_image_side || image.height > max_image_side ||
      image.values.size() != size_t{image.width} * image.height * count) {
    error = fmt::format("'{}' cannot be written: {} names for {} channels of {} x {} pixels", path.string(),
                        count, image.channels, image.width, image.height);
    return false;
  }
  std::vector<size_t> order(count); // the format wants channels in the order of their names
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return names[a] < names[b]; });
  ChannelNames sorted;
  for (const size_t channel : order)
    sorted.push_back(names[channel]);

  ByteWriter out;
  write_header(out, image, sorted);
  constexpr uint32_t lines = lines_of(Compression::zip);
  const uint32_t chunks = (image.height + lines - 1) / lines;
  const size_t table = out.bytes.size();
  out.bytes.resize(table + size_t{8} * chunks);
  ByteWriter offsets;
  for (uint32_t chunk = 0; chunk < chunks; ++chunk) {
    const uint32_t first = chunk * lines;
    const std::vector<uint8_t> plain = gather(image, order, first, std::min(image.height, first + lines));
    const std::vector<uint8_t> packed = zlib_deflate(prepare(plain));
    const std::vector<uint8_t>& stored = !packed.empty() && packed.size() < plain.size() ? packed : plain;
    offsets.u64(out.bytes.size());
    out.u32(first);
    out.u32(static_cast<uint32_t>(stored.size()));
    out.raw(stored.data(), stored.size());
  }
  std::copy(offsets.bytes.begin(), offsets.bytes.end(),
            out.bytes.begin() + static_cast<std::ptrdiff_t>(table));
  return write_bytes(path, out.bytes, error);
}

} // namespace dermis::tools
