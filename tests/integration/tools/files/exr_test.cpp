#include "integration/tools/files/bytes.hpp"
#include "integration/tools/files/exr.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/test_folder.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include <cstring>
#include <filesystem>

namespace dermis::tools {
namespace {

namespace fs = std::filesystem;
using Imath::Box2i;
using Imath::V2i;

const std::vector<ChannelNames> single = {{"*"}};

// Returns the value of a pixel of every written picture; never 0, and exact in a half float.
float value_at(int x, int y) {
  return 1 + static_cast<float>((x + 16) & 31) / 4 + static_cast<float>((y + 16) & 31) / 128;
}

struct Exr : ::testing::Test {
  const dermis::test::TestFolder temporary;
  const fs::path& folder = temporary.path();
  std::string error;

  static std::vector<float> values_of(const Box2i& window) {
    std::vector<float> values;
    for (int y = window.min.y; y <= window.max.y; ++y)
      for (int x = window.min.x; x <= window.max.x; ++x)
        values.push_back(value_at(x, y));
    return values;
  }
  static Imf::Header header_of(const Box2i& display, const Box2i& data,
                               Imf::Compression compression) {
    Imf::Header header(display, data);
    header.compression() = compression;
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    return header;
  }
  fs::path write(const Imf::Header& header) const {
    const std::vector<float> values = values_of(header.dataWindow());
    Imf::FrameBuffer source;
    source.insert("Y", Imf::Slice::Make(Imf::FLOAT, values.data(), header.dataWindow()));
    const fs::path path = folder / "a.exr";
    if (header.hasTileDescription()) {
      Imf::TiledOutputFile file(path.c_str(), header);
      file.setFrameBuffer(source);
      for (int level_y = 0; level_y < file.numYLevels(); ++level_y)
        for (int level_x = 0; level_x < file.numXLevels(); ++level_x)
          if (file.isValidLevel(level_x, level_y))
            file.writeTiles(0, file.numXTiles(level_x) - 1, 0, file.numYTiles(level_y) - 1, level_x,
                            level_y);
    } else {
      Imf::OutputFile file(path.c_str(), header);
      file.setFrameBuffer(source);
      file.writePixels(header.dataWindow().max.y - header.dataWindow().min.y + 1);
    }
    return path;
  }
  // Changes bytes after a text in the file.
  fs::path change(const fs::path& path, const std::string& after, size_t skip,
                  const std::vector<uint8_t>& to) {
    std::vector<uint8_t> bytes = *read_bytes(path, max_image_file_bytes, error);
    const auto found = std::search(bytes.begin(), bytes.end(), after.begin(), after.end());
    EXPECT_NE(found, bytes.end());
    std::copy(to.begin(), to.end(), found + static_cast<std::ptrdiff_t>(after.size() + skip));
    EXPECT_TRUE(write_bytes(folder / "changed.exr", bytes, error));
    return folder / "changed.exr";
  }
  void expect_rejected(const fs::path& path, const std::string& why) {
    EXPECT_FALSE(read_exr(path, single, error));
    EXPECT_THAT(error, HasSubstr(why));
  }
};

std::vector<uint8_t> words(std::initializer_list<int32_t> values) {
  std::vector<uint8_t> bytes(4 * values.size());
  std::memcpy(bytes.data(), values.begin(), bytes.size());
  return bytes;
}

const Box2i small(V2i(0, 0), V2i(69, 65));

TEST_F(Exr, EveryCompressionIsRead) {
  for (int c = 0; c < Imf::NUM_COMPRESSION_METHODS; ++c) {
    SCOPED_TRACE(c);
    const auto image =
        read_exr(write(header_of(small, small, static_cast<Imf::Compression>(c))), single, error);
    ASSERT_TRUE(image) << error;
    const std::vector<float> expected = values_of(small);
    // PXR24 keeps 16 bits of the fraction, B44 does not change floats, and DWA is lossy.
    const bool lossy = c == Imf::DWAA_COMPRESSION || c == Imf::DWAB_COMPRESSION;
    for (size_t i = 0; i < expected.size(); ++i)
      ASSERT_NEAR(image->values[i], expected[i], lossy ? 0.05f * expected[i] : 0.0f) << i;
  }
}

TEST_F(Exr, TilesOfEveryKindOfLevelsAreRead) {
  for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS})
    for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y, Imf::RANDOM_Y}) {
      Imf::Header header = header_of(small, small, Imf::ZIP_COMPRESSION);
      header.setTileDescription(Imf::TileDescription(16, 24, mode));
      header.lineOrder() = order;
      const auto image = read_exr(write(header), single, error);
      ASSERT_TRUE(image) << error;
      EXPECT_EQ(image->values, values_of(small)) << mode << order;
    }
}

TEST_F(Exr, DataWindowsArePlacedInDisplayWindows) {
  const Box2i displays[] = {Box2i(V2i(0, 0), V2i(31, 23)), Box2i(V2i(-5, -3), V2i(26, 20))};
  const Box2i windows[] = {
      Box2i(V2i(10, 5), V2i(41, 28)),    // Moved to the lower right.
      Box2i(V2i(-10, -5), V2i(21, 18)),  // Moved to the upper left.
      Box2i(V2i(4, 6), V2i(7, 8)),       // A part.
      Box2i(V2i(-20, -20), V2i(50, 40)), // Larger than the display window.
  };
  for (const Box2i& display : displays)
    for (const Box2i& data : windows)
      for (const bool tiled : {false, true})
        for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
          Imf::Header header = header_of(display, data, Imf::PIZ_COMPRESSION);
          if (tiled) header.setTileDescription(Imf::TileDescription(7, 5));
          header.lineOrder() = order;
          const auto image = read_exr(write(header), single, error);
          ASSERT_TRUE(image) << error;
          ASSERT_EQ(image->width, 32u);
          ASSERT_EQ(image->height, 24u);
          for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 32; ++x) {
              const V2i at = display.min + V2i(x, y);
              ASSERT_EQ(image->at(static_cast<uint32_t>(x), static_cast<uint32_t>(y), 0),
                        data.intersects(at) ? value_at(at.x, at.y) : 0.0f)
                  << at.x << "," << at.y << (tiled ? " tiled" : "");
            }
        }
}

TEST_F(Exr, DisjointWindowsAreRejected) {
  const Box2i far_away(V2i(100, 0), V2i(131, 23));
  expect_rejected(write(header_of(small, far_away, Imf::ZIP_COMPRESSION)),
                  "outside of its display window");
}

TEST_F(Exr, UnsupportedCompressionsAreNamed) {
  const fs::path path = write(header_of(small, small, Imf::ZIP_COMPRESSION));
  const std::string key("compression\0compression\0", 24);
  expect_rejected(change(path, key, 4, {10}),
                  "its compression HTJ2K256 is not read; save it with ZIP");
  expect_rejected(change(path, key, 4, {11}), "HTJ2K32");
  expect_rejected(change(path, key, 4, {200}), "its compression (number 200) is not read");
}

TEST_F(Exr, PartsAndDeepPixelsAreRejectedByName) {
  const fs::path path = write(header_of(small, small, Imf::ZIP_COMPRESSION));
  const std::string magic("\x76\x2f\x31\x01\x02", 5);
  expect_rejected(change(path, magic, 0, {0x10}), "several parts");
  expect_rejected(change(path, magic, 0, {0x08}), "deep");
  expect_rejected(change(path, magic, 0, {0x80}), "flags");
}

TEST_F(Exr, SubsampledChannelsAreRejected) {
  Imf::Header header = header_of(small, small, Imf::ZIP_COMPRESSION);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT, 2, 2));
  const std::vector<float> values = values_of(small);
  Imf::FrameBuffer source;
  source.insert("Y", Imf::Slice::Make(Imf::FLOAT, values.data(), small, 0, 0, 2, 2));
  {
    Imf::OutputFile file((folder / "a.exr").c_str(), header);
    file.setFrameBuffer(source);
    file.writePixels(66);
  }
  expect_rejected(folder / "a.exr", "channel 'Y' is subsampled");
}

TEST_F(Exr, SizesAreCheckedBeforeAllocation) {
  Imf::Header header = header_of(small, small, Imf::ZIP_COMPRESSION);
  header.setTileDescription(Imf::TileDescription(16, 16));
  const fs::path tiled = write(header);
  expect_rejected(change(tiled, std::string("tiles\0tiledesc\0", 15), 4, words({32769, 1})),
                  "tiles measure 32769 x 1");
  expect_rejected(change(tiled, std::string("tiles\0tiledesc\0", 15), 4, words({32768, 32768})),
                  "one of its chunks holds more than");

  const fs::path path = write(header_of(small, small, Imf::DWAB_COMPRESSION));
  const std::string data("dataWindow\0box2i\0", 17), display("displayWindow\0box2i\0", 20);
  expect_rejected(change(path, data, 4, words({0, 0, 32767, 32767})), "channels hold more than");
  expect_rejected(change(path, data, 4, words({0, 0, 32768, 0})), "data window measures 32769 x 1");
  expect_rejected(change(path, display, 4, words({0, 0, 32767, 32767})),
                  "display window holds more than");
  expect_rejected(change(path, display, 4, words({0, 0, 0, 70000})),
                  "display window measures 1 x 70001");
  expect_rejected(change(path, data, 4, words({-2147483647, 0, 2147483647, 0})), "changed.exr");
}

TEST_F(Exr, AttributesBeyondTheFileAreRejected) {
  const fs::path path = write(header_of(small, small, Imf::ZIP_COMPRESSION));
  for (const std::string& key :
       {std::string("channels\0chlist\0", 16), std::string("dataWindow\0box2i\0", 17),
        std::string("lineOrder\0lineOrder\0", 20)})
    for (const int32_t size : {0x7fffffff, -1, 0x00100000})
      expect_rejected(change(path, key, 0, words({size})), "header is damaged or cut off");
}

TEST_F(Exr, HeadersWithoutWindowsAreRejected) {
  const fs::path path = write(header_of(small, small, Imf::ZIP_COMPRESSION));
  expect_rejected(change(path, "dataWind", 0, {'o', 'x'}), "its header has no 'dataWindow'");
  expect_rejected(change(path, "displayWind", 0, {'o', 'x'}), "its header has no 'displayWindow'");
}

TEST_F(Exr, DamagedPicturesNeverCrash) {
  for (int c = 0; c < Imf::NUM_COMPRESSION_METHODS; ++c)
    for (const bool tiled : {false, true}) {
      Imf::Header header = header_of(small, small, static_cast<Imf::Compression>(c));
      if (tiled) header.setTileDescription(Imf::TileDescription(64, 64));
      const std::vector<uint8_t> whole = *read_bytes(write(header), max_image_file_bytes, error);
      for (size_t i = 0; i < 25; ++i) {
        std::vector<uint8_t> damaged = whole;
        const size_t at = i * 7919 % whole.size();
        damaged[at] ^= static_cast<uint8_t>(1u << (i % 8));
        ASSERT_TRUE(write_bytes(folder / "b.exr", damaged, error));
        error.clear();
        EXPECT_TRUE(read_exr(folder / "b.exr", single, error) || !error.empty()) << c;
        ASSERT_TRUE(write_bytes(folder / "b.exr", std::span(whole).first(at), error));
        expect_rejected(folder / "b.exr", "b.exr");
      }
    }
}

} // namespace
} // namespace dermis::tools
