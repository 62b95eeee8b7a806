#include "integration/tools/command/bench/reference.hpp"

#include "integration/tools/command/bench/kept_values.hpp"
#include "integration/tools/command/run/reference_run.hpp"
#include "integration/tools/files/capture_reference.hpp"

namespace dermis::tools {
namespace {

// Increment when the definition of the reference changes.
constexpr uint64_t definition_version = 3;

Hash hash_of(const ReferenceFrame& frame, std::span<const uint32_t> pixels) {
  Hash hash;
  const uint64_t sizes[] = {definition_version, frame.width, frame.height, frame.rays.perspective};
  const double rays[] = {frame.rays.scale_x, frame.rays.offset_x, frame.rays.scale_y,
                         frame.rays.offset_y};
  hash.add(std::span<const uint64_t>(sizes));
  hash.add(std::span<const double>(rays));
  hash.add(frame.light);
  hash.add(frame.depth);
  hash.add(frame.scatter_scale);
  hash.add(frame.profile);
  hash.add(frame.d_m);
  add_shapes(hash, frame.shapes);
  hash.add(pixels);
  return hash;
}

std::optional<std::vector<double>> compute(const Session& session, const ReferenceFrame& frame,
                                           const std::string& what,
                                           std::span<const uint32_t> pixels, bool planar) {
  const subsurface::ReferenceInput input = frame.input();
  if (!planar) return run_reference(session, what, input, pixels);
  const std::vector<double> everywhere = subsurface::reference_everywhere(input);
  std::vector<double> chosen;
  chosen.reserve(3 * pixels.size());
  for (const uint32_t pixel : pixels)
    for (size_t c = 0; c < 3; ++c)
      chosen.push_back(everywhere[size_t{3} * pixel + c]);
  return chosen;
}

} // namespace

std::optional<Reference> make_reference(const Session& session, const CapturedFrame& frame,
                                        const std::string& what, uint32_t subset,
                                        const std::string& cache) {
  const ReferenceFrame source = make_reference_frame(frame);
  const bool planar = subsurface::is_planar(source.input());
  Reference reference;
  reference.population = subsurface_pixels(source.profile);
  reference.everywhere = planar || subset == 0 || subset >= reference.population;
  reference.pixels = subsurface::stratified_subset(
      source.width, source.height, source.profile,
      reference.everywhere ? static_cast<uint32_t>(source.profile.size()) : subset);
  ExposureMeter meter;
  meter.add(source.light, source.profile);
  reference.exposure = meter.result();

  const Hash hash = hash_of(source, reference.pixels);
  if (auto kept = read_kept(cache, hash, 3 * reference.pixels.size())) {
    reference.light = std::move(*kept);
    return reference;
  }
  auto light = compute(session, source, what, reference.pixels, planar);
  if (!light) return std::nullopt;
  reference.light = std::move(*light);
  keep(cache, hash, reference.light);
  return reference;
}

} // namespace dermis::tools
