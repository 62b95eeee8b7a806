#include "integration/command/bench/reference.hpp"

#include "integration/command/run/truth_run.hpp"
#include "integration/files/bytes.hpp"
#include "integration/files/capture_truth.hpp"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>

namespace dermis::tools {
namespace {

// Changes whenever the truth's definition does.
constexpr uint64_t definition_version = 1;
constexpr std::string_view magic = "dermis truth 1\n";
constexpr uint64_t most_cached_bytes = uint64_t{1} << 30;

// FNV-1a, 64 bits.
struct Hash {
  uint64_t value = 0xcbf29ce484222325u;

  template <class T> void add(std::span<const T> values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (size_t i = 0; i < values.size_bytes(); ++i)
      value = (value ^ bytes[i]) * 0x100000001b3u;
    const uint64_t size = values.size(); // so that neighbours do not run into each other
    for (size_t i = 0; i < sizeof size; ++i)
      value = (value ^ ((size >> (8 * i)) & 0xff)) * 0x100000001b3u;
  }
};

template <class T> std::span<const T> view_of(const std::vector<T>& values) {
  return values;
}

uint64_t hash_of(const TruthFrame& frame, std::span<const uint32_t> pixels) {
  Hash hash;
  const uint64_t sizes[] = {definition_version, frame.width, frame.height, frame.rays.perspective};
  const double rays[] = {frame.rays.scale_x, frame.rays.offset_x, frame.rays.scale_y, frame.rays.offset_y};
  hash.add(std::span<const uint64_t>(sizes));
  hash.add(std::span<const double>(rays));
  hash.add(view_of(frame.light));
  hash.add(view_of(frame.depth));
  hash.add(view_of(frame.scatter_scale));
  hash.add(view_of(frame.profile));
  hash.add(view_of(frame.d_m));
  hash.add(pixels);
  return hash.value;
}

std::optional<std::vector<double>> read_cached(const std::filesystem::path& path, uint64_t hash,
                                               size_t count) {
  std::string ignored;
  const auto bytes = read_bytes(path, most_cached_bytes, ignored);
  if (!bytes || bytes->size() != magic.size() + sizeof hash + count * sizeof(double)) return std::nullopt;
  if (std::memcmp(bytes->data(), magic.data(), magic.size()) != 0 ||
      std::memcmp(bytes->data() + magic.size(), &hash, sizeof hash) != 0)
    return std::nullopt;
  std::vector<double> values(count);
  std::memcpy(values.data(), bytes->data() + magic.size() + sizeof hash, count * sizeof(double));
  return values;
}

// A cache that cannot be written is no problem of the measurement.
void write_cached(const std::filesystem::path& path, uint64_t hash, std::span<const double> values) {
  std::vector<uint8_t> bytes(magic.size() + sizeof hash + values.size_bytes());
  std::memcpy(bytes.data(), magic.data(), magic.size());
  std::memcpy(bytes.data() + magic.size(), &hash, sizeof hash);
  std::memcpy(bytes.data() + magic.size() + sizeof hash, values.data(), values.size_bytes());
  std::error_code ignored;
  std::filesystem::create_directories(path.parent_path(), ignored);
  std::string ignored_text;
  write_bytes(path, bytes, ignored_text);
}

std::optional<std::vector<double>> compute(const Session& session, const TruthFrame& frame,
                                           const std::string& what, std::span<const uint32_t> pixels,
                                           bool planar) {
  const subsurface::TruthInput input = frame.input();
  if (!planar) return run_truth(session, what, input, pixels);
  const std::vector<double> everywhere = subsurface::truth_everywhere(input);
  std::vector<double> chosen;
  chosen.reserve(3 * pixels.size());
  for (const uint32_t pixel : pixels)
    for (size_t c = 0; c < 3; ++c)
      chosen.push_back(everywhere[size_t{3} * pixel + c]);
  return chosen;
}

} // namespace

std::optional<Reference> make_reference(const Session& session, const CapturedFrame& frame,
                                        const std::string& what, uint32_t subset, const std::string& cache) {
  const TruthFrame truth = make_truth_frame(frame);
  const bool planar = subsurface::is_planar(truth.input());
  Reference reference;
  reference.population = subsurface_pixels(truth.profile);
  reference.everywhere = planar || subset == 0 || subset >= reference.population;
  reference.pixels = subsurface::stratified_subset(
      truth.width, truth.height, truth.profile,
      reference.everywhere ? static_cast<uint32_t>(truth.profile.size()) : subset);
  ExposureMeter meter;
  meter.add(truth.light, truth.profile);
  reference.exposure = meter.result();

  std::filesystem::path path;
  const uint64_t hash = hash_of(truth, reference.pixels);
  if (!cache.empty()) {
    path = std::filesystem::path(cache) / fmt::format("{:016x}.truth", hash);
    if (auto cached = read_cached(path, hash, 3 * reference.pixels.size())) {
      reference.light = std::move(*cached);
      return reference;
    }
  }
  auto light = compute(session, truth, what, reference.pixels, planar);
  if (!light) return std::nullopt;
  reference.light = std::move(*light);
  if (!path.empty()) write_cached(path, hash, reference.light);
  return reference;
}

} // namespace dermis::tools
