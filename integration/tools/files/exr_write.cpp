#include "integration/tools/files/exr.hpp"

#include "integration/tools/files/bytes.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <set>

namespace dermis::tools {

namespace {

class MemoryOutput : public Imf::OStream {
public:
  explicit MemoryOutput(const std::string& name) : Imf::OStream(name.c_str()) {}
  void write(const char data[], int count) override {
    const auto size = static_cast<size_t>(count);
    bytes.resize(std::max(bytes.size(), at_ + size));
    std::memcpy(bytes.data() + at_, data, size);
    at_ += size;
  }
  uint64_t tellp() override { return at_; }
  void seekp(uint64_t position) override { at_ = static_cast<size_t>(position); }

  std::vector<uint8_t> bytes;

private:
  size_t at_ = 0;
};

void encode(const Image& image, const ChannelNames& names, MemoryOutput& out) {
  Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer source;
  for (size_t c = 0; c < names.size(); ++c) {
    header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
    source.insert(names[c], Imf::Slice::Make(Imf::FLOAT, &image.values[c], header.dataWindow(),
                                             names.size() * sizeof(float)));
  }
  constexpr int threads = 0;
  Imf::OutputFile file(out, header, threads); // the destructor completes the chunk table
  file.setFrameBuffer(source);
  file.writePixels(static_cast<int>(image.height));
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
    error = fmt::format("'{}' cannot be written: {} names for {} channels of {} x {} pixels",
                        path.string(), count, image.channels, image.width, image.height);
    return false;
  }
  MemoryOutput out(path.filename().string());
  try {
    encode(image, names, out);
  } catch (const std::exception& problem) {
    error = fmt::format("'{}' cannot be written: {}", path.string(), problem.what());
    return false;
  }
  return write_bytes(path, out.bytes, error);
}

} // namespace dermis::tools
