#include "integration/tools/files/png.hpp"

#include "integration/tools/files/bytes.hpp"
#include "integration/tools/files/stb.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <cstdlib>

namespace dermis::tools {

float srgb_encode(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 1;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

float srgb_decode(float encoded) {
  if (!(encoded > 0)) return 0;
  if (encoded >= 1) return 1;
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

std::vector<uint8_t> encode_png(uint32_t width, uint32_t height, std::span<const uint8_t> rgb) {
  std::vector<uint8_t> file;
  if (width == 0 || height == 0 || width > max_image_side || height > max_image_side ||
      rgb.size() != size_t{width} * height * 3)
    return file;
  const auto append = [](void* target, void* data, int size) {
    const auto* first = static_cast<const uint8_t*>(data);
    static_cast<std::vector<uint8_t>*>(target)->insert(
        static_cast<std::vector<uint8_t>*>(target)->end(), first, first + size);
  };
  if (!stbi_write_png_to_func(append, &file, static_cast<int>(width), static_cast<int>(height), 3,
                              rgb.data(), static_cast<int>(width * 3)))
    file.clear();
  return file;
}

bool write_png(const std::filesystem::path& path, uint32_t width, uint32_t height,
               std::span<const uint8_t> rgb, std::string& error) {
  const std::vector<uint8_t> file = encode_png(width, height, rgb);
  if (!file.empty()) return write_bytes(path, file, error);
  error = fmt::format("'{}' cannot be encoded: {} bytes for {} x {} pixels", path.string(),
                      rgb.size(), width, height);
  return false;
}

std::optional<Image> read_png(const std::filesystem::path& path, std::string& error) {
  const auto bytes = read_bytes(path, std::min<uint64_t>(max_image_file_bytes, INT_MAX), error);
  if (!bytes) return std::nullopt;
  int width = 0, height = 0, channels = 0;
  const int size = static_cast<int>(bytes->size());
  if (!stbi_info_from_memory(bytes->data(), size, &width, &height, &channels)) {
    error = fmt::format("'{}' is not a PNG picture", path.string());
    return std::nullopt;
  }
  if (width < 1 || height < 1 || uint32_t(width) > max_image_side ||
      uint32_t(height) > max_image_side) {
    error = fmt::format("'{}' is {} x {}; sides of 1 to {} are read", path.string(), width, height,
                        max_image_side);
    return std::nullopt;
  }
  const bool wide = stbi_is_16_bit_from_memory(bytes->data(), size) != 0;
  const uint64_t pixels = uint64_t(width) * uint64_t(height), packed = pixels * uint64_t(channels);
  if (pixels * 3 * sizeof(float) > max_image_bytes ||
      (wide ? 2 : 1) * packed > max_decoded_bytes(bytes->size())) {
    error = fmt::format("'{}' holds {} x {} pixels, more than {} bytes or more than its {} bytes "
                        "can hold",
                        path.string(), width, height, max_image_bytes, bytes->size());
    return std::nullopt;
  }
  Image image;
  const auto take = [&](auto* pixels, float white) {
    if (pixels == nullptr) return false;
    image = Image::sized(static_cast<uint32_t>(width), static_cast<uint32_t>(height), 3);
    std::transform(pixels, pixels + image.values.size(), image.values.begin(),
                   [white](auto x) { return srgb_decode(static_cast<float>(x) / white); });
    stbi_image_free(pixels);
    return true;
  };
  const bool read =
      wide ? take(stbi_load_16_from_memory(bytes->data(), size, &width, &height, &channels, 3),
                  65535)
           : take(stbi_load_from_memory(bytes->data(), size, &width, &height, &channels, 3), 255);
  if (!read) {
    error = fmt::format("'{}' is damaged: {}", path.string(), stbi_failure_reason());
    return std::nullopt;
  }
  return image;
}

} // namespace dermis::tools
