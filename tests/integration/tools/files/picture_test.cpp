#include "integration/tools/files/bytes.hpp"
#include "integration/tools/files/exr.hpp"
#include "integration/tools/files/png.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/test_folder.hpp"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

namespace dermis::tools {
namespace {

namespace fs = std::filesystem;

struct Pictures : ::testing::Test {
  const dermis::test::TestFolder temporary;
  const fs::path& folder = temporary.path();
  std::string error;

  size_t files() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder), {}));
  }
  std::vector<uint8_t> bytes_of(const fs::path& path) {
    return read_bytes(path, max_image_file_bytes, error).value_or(std::vector<uint8_t>{});
  }
};

const std::vector<ChannelNames> rgb = {{"R", "G", "B"}};

Image sample(uint32_t width, uint32_t height, uint32_t channels) {
  Image image = Image::sized(width, height, channels);
  for (size_t i = 0; i < image.values.size(); ++i)
    image.values[i] = std::sin(float(i)) * 100;
  return image;
}

TEST_F(Pictures, ExrRoundTripIsBitForBit) {
  Image image = sample(37, 21, 3);
  image.values[5] = std::numeric_limits<float>::infinity();
  image.values[6] = 1e-42f;
  ASSERT_TRUE(write_exr(folder / "a.exr", image, {"R", "G", "B"}, error)) << error;
  const auto back = read_exr(folder / "a.exr", rgb, error);
  ASSERT_TRUE(back) << error;
  EXPECT_EQ(back->width, 37u);
  EXPECT_EQ(back->height, 21u);
  EXPECT_EQ(back->values, image.values);
  EXPECT_EQ(files(), 1u); // No temporary file remains.
}

TEST_F(Pictures, ExrChannelsAreFoundByName) {
  ASSERT_TRUE(write_exr(folder / "a.exr", sample(4, 4, 2), {"Z", "Y"}, error)) << error;
  const std::vector<ChannelNames> requested_channels = {{"A"}, {"Y"}};
  const auto back = read_exr(folder / "a.exr", requested_channels, error);
  ASSERT_TRUE(back) << error;
  EXPECT_EQ(back->channels, 1u);
  EXPECT_EQ(back->values[1], sample(4, 4, 2).values[3]);
}

TEST_F(Pictures, OnlyChannelIsAcceptedUnderAnyName) {
  const std::vector<ChannelNames> any = {{"*"}};
  ASSERT_TRUE(write_exr(folder / "one.exr", sample(4, 4, 1), {"whatever"}, error));
  EXPECT_TRUE(read_exr(folder / "one.exr", any, error));
  ASSERT_TRUE(write_exr(folder / "two.exr", sample(4, 4, 2), {"a", "b"}, error));
  EXPECT_FALSE(read_exr(folder / "two.exr", any, error));
  EXPECT_THAT(error, HasAll("a,b", "a single channel"));
}

TEST_F(Pictures, MissingChannelsAreNamed) {
  ASSERT_TRUE(write_exr(folder / "a.exr", sample(4, 4, 2), {"R", "G"}, error));
  EXPECT_FALSE(read_exr(folder / "a.exr", rgb, error));
  EXPECT_THAT(error, HasAll("G,R", "R,G,B", "a.exr"));
}

TEST_F(Pictures, MissingFilesAndFoldersAreRejected) {
  EXPECT_FALSE(read_exr(folder / "none.exr", rgb, error));
  EXPECT_THAT(error, HasSubstr("does not exist"));
  EXPECT_FALSE(read_exr(folder, rgb, error));
  EXPECT_THAT(error, HasSubstr("not a regular file"));
}

TEST_F(Pictures, TruncatedExrsAreRejectedAtEveryLength) {
  ASSERT_TRUE(write_exr(folder / "a.exr", sample(19, 23, 3), {"R", "G", "B"}, error));
  const std::vector<uint8_t> whole = bytes_of(folder / "a.exr");
  for (size_t length = 0; length < whole.size(); length += length < 400 ? 1 : 97) {
    ASSERT_TRUE(write_bytes(folder / "cut.exr", std::span(whole).first(length), error));
    EXPECT_FALSE(read_exr(folder / "cut.exr", rgb, error)) << length;
    EXPECT_THAT(error, HasSubstr("cut.exr"));
  }
}

TEST_F(Pictures, DamagedExrsNeverCrash) {
  ASSERT_TRUE(write_exr(folder / "a.exr", sample(9, 7, 3), {"R", "G", "B"}, error));
  const std::vector<uint8_t> whole = bytes_of(folder / "a.exr");
  for (size_t at = 0; at < whole.size(); at += at < 350 ? 1 : 7) {
    std::vector<uint8_t> damaged = whole;
    damaged[at] ^= static_cast<uint8_t>(1u << (at % 8));
    ASSERT_TRUE(write_bytes(folder / "b.exr", damaged, error));
    // Reading returns, whether it rejects or reads the file.
    read_exr(folder / "b.exr", rgb, error);
  }
}

TEST_F(Pictures, ExrsOfHugeSizeAreRejectedBeforeDecoding) {
  ASSERT_TRUE(write_exr(folder / "a.exr", sample(9, 7, 3), {"R", "G", "B"}, error));
  std::vector<uint8_t> bytes = bytes_of(folder / "a.exr");
  const std::string key("dataWindow\0box2i\0", 17);
  const auto found = std::search(bytes.begin(), bytes.end(), key.begin(), key.end());
  ASSERT_NE(found, bytes.end());
  const int32_t box[4] = {0, 0, 2000000, 2000000};
  std::memcpy(&*found + key.size() + 4, box, sizeof box);
  ASSERT_TRUE(write_bytes(folder / "b.exr", bytes, error));
  EXPECT_FALSE(read_exr(folder / "b.exr", rgb, error));
}

// Returns a file of one 4 x 2 picture without compression or with RLE, byte by byte: half "H", uint
// "U".
std::vector<uint8_t> hand_made(uint8_t compression,
                               const std::vector<std::vector<uint8_t>>& lines) {
  std::vector<uint8_t> out;
  auto u32 = [&](uint32_t v) {
    for (int i = 0; i < 4; ++i)
      out.push_back(static_cast<uint8_t>(v >> (8 * i)));
  };
  auto text = [&](const std::string& s) {
    out.insert(out.end(), s.c_str(), s.c_str() + s.size() + 1);
  };
  u32(20000630);
  u32(2);
  text("channels"), text("chlist"), u32(37);
  text("H"), u32(1), u32(0), u32(1), u32(1);
  text("U"), u32(0), u32(0), u32(1), u32(1);
  out.push_back(0);
  text("compression"), text("compression"), u32(1), out.push_back(compression);
  for (const char* window : {"dataWindow", "displayWindow"}) // Windows that do not start at 0.
    text(window), text("box2i"), u32(16), u32(5), u32(7), u32(8), u32(8);
  out.push_back(0);
  const size_t table = out.size();
  size_t offset = table + 16;
  for (const auto& line : lines) {
    u32(static_cast<uint32_t>(offset)), u32(0);
    offset += 8 + line.size();
  }
  for (uint32_t y = 0; y < lines.size(); ++y) {
    u32(7 + y), u32(static_cast<uint32_t>(lines[y].size()));
    out.insert(out.end(), lines[y].begin(), lines[y].end());
  }
  return out;
}

// 4 half floats (1, -2, smallest subnormal, infinity), then 4 uints.
const std::vector<uint8_t> plain_line = {0x00, 0x3c, 0x00, 0xc0, 1, 0, 0x00, 0x7c, 1,    0, 0, 0,
                                         2,    0,    0,    0,    3, 0, 0,    0,    0xff, 0, 0, 0};

TEST_F(Pictures, HalvesAndUintsBecomeFloats) {
  ASSERT_TRUE(write_bytes(folder / "a.exr", hand_made(0, {plain_line, plain_line}), error));
  const std::vector<ChannelNames> both = {{"U", "H"}};
  const auto image = read_exr(folder / "a.exr", both, error);
  ASSERT_TRUE(image) << error;
  const std::vector<float> row = {1, 1, 2, -2, 3, std::ldexp(1.0f, -24), 255, INFINITY};
  EXPECT_EQ(std::vector<float>(image->values.begin() + 8, image->values.end()), row);
}

TEST_F(Pictures, RunLengthsAreDecodedAndBounded) {
  // After a first 0, 24 equal prepared bytes of 128 (no difference): the line is all zeros.
  const std::vector<uint8_t> zeros = {0xff, 0, 22, 128};
  ASSERT_TRUE(write_bytes(folder / "a.exr", hand_made(1, {zeros, zeros}), error));
  const std::vector<ChannelNames> u = {{"U"}};
  const auto image = read_exr(folder / "a.exr", u, error);
  ASSERT_TRUE(image) << error;
  EXPECT_EQ(image->values, std::vector<float>(8, 0.0f));
  const std::vector<uint8_t> too_long = {0xff, 0, 23, 128}, cut = {0xf0, 0};
  for (const auto& bad : {too_long, cut}) {
    ASSERT_TRUE(write_bytes(folder / "b.exr", hand_made(1, {zeros, bad}), error));
    EXPECT_FALSE(read_exr(folder / "b.exr", u, error));
    EXPECT_THAT(error, HasSubstr("damaged"));
  }
}

TEST_F(Pictures, FailedWriteKeepsTheOldFile) {
  EXPECT_FALSE(write_exr(folder / "none" / "a.exr", sample(2, 2, 1), {"Y"}, error));
  EXPECT_THAT(error, HasSubstr("cannot be written"));
  EXPECT_FALSE(write_exr(folder / "a.exr", sample(2, 2, 1), {"X", "Y"}, error));
  fs::create_directories(folder / "taken" / "full");
  EXPECT_FALSE(write_text(folder / "taken", "text", error)); // A folder has this name.
  EXPECT_EQ(files(), 1u);
}

TEST_F(Pictures, PngReturnsItsBytes) {
  std::vector<uint8_t> pixels(16 * 9 * 3);
  for (size_t i = 0; i < pixels.size(); ++i)
    pixels[i] = static_cast<uint8_t>(i * 7);
  ASSERT_TRUE(write_png(folder / "a.png", 16, 9, pixels, error)) << error;
  const auto back = read_png(folder / "a.png", error);
  ASSERT_TRUE(back) << error;
  std::vector<uint8_t> encoded;
  for (const float value : back->values)
    encoded.push_back(static_cast<uint8_t>(std::lround(srgb_encode(value) * 255)));
  EXPECT_EQ(encoded, pixels);
}

// Returns a PNG of one row with 16 bits per channel, in stored blocks.
std::vector<uint8_t> png_of_16_bits(const std::vector<uint16_t>& pixels) {
  std::vector<uint8_t> file = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  const auto word = [](std::vector<uint8_t>& out, size_t value) {
    for (int shift = 24; shift >= 0; shift -= 8)
      out.push_back(static_cast<uint8_t>(value >> shift));
  };
  const auto chunk = [&](const std::string& name, const std::vector<uint8_t>& data) {
    word(file, data.size());
    file.insert(file.end(), name.begin(), name.end());
    file.insert(file.end(), data.begin(), data.end());
    word(file, 0); // No checksum, because the reader ignores it.
  };
  std::vector<uint8_t> header;
  word(header, pixels.size() / 3);
  word(header, 1);
  header.insert(header.end(), {16, 2, 0, 0, 0});
  chunk("IHDR", header);
  const size_t size = 1 + 2 * pixels.size();
  std::vector<uint8_t> packed = {0x78, 0x01, 1}; // zlib, one last block, stored.
  for (const size_t length : {size, ~size})
    packed.insert(packed.end(), {static_cast<uint8_t>(length), static_cast<uint8_t>(length >> 8)});
  packed.push_back(0); // No filter.
  for (const uint16_t value : pixels)
    packed.insert(packed.end(), {static_cast<uint8_t>(value >> 8), static_cast<uint8_t>(value)});
  word(packed, 0);
  chunk("IDAT", packed);
  chunk("IEND", {});
  return file;
}

TEST_F(Pictures, PngsOf16Bits_KeepAllBits) {
  const std::vector<uint16_t> values = {0, 1, 100, 255, 257, 65535};
  ASSERT_TRUE(write_bytes(folder / "a.png", png_of_16_bits(values), error));
  const auto image = read_png(folder / "a.png", error);
  ASSERT_TRUE(image) << error;
  for (size_t i = 0; i < values.size(); ++i) // Half a step of 16 bits.
    EXPECT_NEAR(srgb_encode(image->values[i]), float(values[i]) / 65535.0f, 0.5f / 65535) << i;
}

TEST_F(Pictures, BadPngsAreRejected) {
  ASSERT_TRUE(write_text(folder / "a.png", "not a picture", error));
  EXPECT_FALSE(read_png(folder / "a.png", error));
  EXPECT_THAT(error, HasSubstr("not a PNG"));
  EXPECT_FALSE(write_png(folder / "b.png", 0, 4, {}, error));
  std::vector<uint8_t> pixels(8 * 8 * 3, 9);
  ASSERT_TRUE(write_png(folder / "c.png", 8, 8, pixels, error));
  std::vector<uint8_t> bytes = bytes_of(folder / "c.png");
  // The last 12 bytes are an empty end mark.
  for (size_t length = 0; length < bytes.size() - 12; ++length) {
    ASSERT_TRUE(write_bytes(folder / "d.png", std::span(bytes).first(length), error));
    read_png(folder / "d.png", error);
  }
}

// The file has only a header, which promises 12 GiB of pixels.
TEST_F(Pictures, PngBeyondItsFile_IsRejectedByItsHeader) {
  const std::vector<uint8_t> header = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0, 0, 0,
                                       13,   'I', 'H', 'D', 'R',  0,    0,    0x80, 0, 0, 0,
                                       0x80, 0,   8,   0,   0,    0,    0,    0,    0, 0, 0};
  ASSERT_TRUE(write_bytes(folder / "a.png", header, error));
  EXPECT_FALSE(read_png(folder / "a.png", error));
  EXPECT_THAT(error, HasSubstr("a.png' holds 32768 x 32768 pixels"));
}

TEST(Srgb, CurveIsItsOwnInverseAndClamps) {
  for (float x = 0; x <= 1; x += 1.0f / 64)
    EXPECT_NEAR(srgb_decode(srgb_encode(x)), x, 1e-6);
  EXPECT_EQ(srgb_encode(-1), 0);
  EXPECT_EQ(srgb_encode(NAN), 0);
  EXPECT_EQ(srgb_encode(INFINITY), 1);
  EXPECT_NEAR(srgb_encode(0.5f), 0.735357f, 1e-6); // IEC 61966-2-1
}

} // namespace
} // namespace dermis::tools
