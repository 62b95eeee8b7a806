#include "integration/examples/demo_engine/model/load_texture.hpp"

#include "integration/examples/demo_engine/files.hpp"

#include <fmt/format.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cstring>
#include <string_view>

namespace demo {

namespace {

// stb reads more formats than needed. Excluding the others limits the parsers that a hostile file
// can reach.
bool other_format(std::span<const std::byte> bytes) {
  constexpr std::array<std::string_view, 6> beginnings = {"GIF8", "8BPS", "\x53\x80\xf6\x34",
                                                          "P5",   "P6",   "#?"};
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return std::any_of(beginnings.begin(), beginnings.end(),
                     [&](std::string_view one) { return text.starts_with(one); });
}

} // namespace

Result<Texture> load_texture(const std::string& path) {
  constexpr uint64_t max_bytes = uint64_t{256} << 20;
  auto bytes = read_binary_file(path, max_bytes);
  if (!bytes) return bytes.error();
  return decode_texture(path, *bytes);
}

Result<Texture> decode_texture(const std::string& name, std::span<const std::byte> bytes) {
  const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
  const int size = static_cast<int>(bytes.size());
  int width = 0, height = 0, channels = 0;
  if (bytes.empty() || bytes.size() > INT_MAX || other_format(bytes) ||
      stbi_info_from_memory(data, size, &width, &height, &channels) == 0)
    return Error{
        ErrorKind::input,
        fmt::format("{}: this is not an image that can be read (PNG, JPEG, TGA, BMP)", name)};
  if (width < 1 || height < 1 || width > max_texels_per_side || height > max_texels_per_side)
    return Error{ErrorKind::input,
                 fmt::format("{}: the image is {}x{}; maps may be 1x1 to {}x{}", name, width,
                             height, max_texels_per_side, max_texels_per_side)};
  constexpr int rgba = 4;
  stbi_uc* texels = stbi_load_from_memory(data, size, &width, &height, &channels, rgba);
  if (texels == nullptr)
    return Error{ErrorKind::input,
                 fmt::format("{}: the image is damaged: {}", name, stbi_failure_reason())};
  Texture texture{static_cast<uint32_t>(width), static_cast<uint32_t>(height), {}};
  texture.texels.resize(size_t{texture.width} * texture.height * rgba);
  std::memcpy(texture.texels.data(), texels, texture.texels.size());
  stbi_image_free(texels);
  return texture;
}

void flip_rows(Texture& texture) {
  const size_t row = size_t{texture.width} * 4;
  for (uint32_t y = 0; y < texture.height / 2; ++y)
    std::swap_ranges(texture.texels.begin() + static_cast<ptrdiff_t>(y * row),
                     texture.texels.begin() + static_cast<ptrdiff_t>((y + 1) * row),
                     texture.texels.begin() +
                         static_cast<ptrdiff_t>((texture.height - 1 - y) * row));
}

} // namespace demo
