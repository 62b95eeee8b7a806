#include "integration/tools/command/bench/kept_values.hpp"

#include "integration/tools/files/bytes.hpp"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <string_view>

namespace dermis::tools {
namespace {

constexpr std::string_view magic = "dermis truth 1\n";
constexpr uint64_t max_kept_bytes = uint64_t{1} << 30;

std::filesystem::path path_of(const std::string& cache, const Hash& hash) {
  return std::filesystem::path(cache) / fmt::format("{:016x}.truth", hash.value);
}

} // namespace

void add_shapes(Hash& hash, std::span<const subsurface::ProfileShape> shapes) {
  for (const subsurface::ProfileShape& shape : shapes)
    for (const subsurface::ChannelShape& channel : shape) {
      const double numbers[] = {static_cast<double>(channel.model),
                                channel.d,
                                channel.direct,
                                channel.width,
                                channel.dipole.z_real,
                                channel.dipole.z_virtual,
                                channel.dipole.sigma_tr};
      hash.add(std::span<const double>(numbers));
    }
}

std::optional<std::vector<double>> read_kept(const std::string& cache, const Hash& hash,
                                             size_t count) {
  if (cache.empty()) return std::nullopt;
  std::string ignored;
  const auto bytes = read_bytes(path_of(cache, hash), max_kept_bytes, ignored);
  if (!bytes || bytes->size() != magic.size() + sizeof hash.value + count * sizeof(double))
    return std::nullopt;
  if (std::memcmp(bytes->data(), magic.data(), magic.size()) != 0 ||
      std::memcmp(bytes->data() + magic.size(), &hash.value, sizeof hash.value) != 0)
    return std::nullopt;
  std::vector<double> values(count);
  std::memcpy(values.data(), bytes->data() + magic.size() + sizeof hash.value,
              count * sizeof(double));
  return values;
}

void keep(const std::string& cache, const Hash& hash, std::span<const double> values) {
  if (cache.empty()) return;
  std::vector<uint8_t> bytes(magic.size() + sizeof hash.value + values.size_bytes());
  std::memcpy(bytes.data(), magic.data(), magic.size());
  std::memcpy(bytes.data() + magic.size(), &hash.value, sizeof hash.value);
  std::memcpy(bytes.data() + magic.size() + sizeof hash.value, values.data(), values.size_bytes());
  std::error_code ignored;
  std::filesystem::create_directories(cache, ignored);
  std::string ignored_text;
  write_bytes(path_of(cache, hash), bytes, ignored_text);
}

} // namespace dermis::tools
