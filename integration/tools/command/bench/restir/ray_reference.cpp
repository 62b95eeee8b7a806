#include "integration/tools/command/bench/restir/ray_reference.hpp"

#include "integration/examples/demo_engine/files.hpp"
#include "integration/tools/command/bench/kept_values.hpp"

#include <fmt/format.h>

#include <cmath>

namespace dermis::tools {
namespace {

// "ray", 1: change with the contents of the cache
constexpr uint64_t ray_definition_version = 0x7261790000000002u;

Hash hash_of(const RayReferenceSize& size, const RayRequest& request, const std::string& scene,
             const CapturedFrame& frame) {
  Hash hash;
  std::string graph = request.loaded.text;
  for (const auto& [setting, value] : request.set)
    graph += fmt::format("\n{}={}", setting, value);
  hash.add(std::span<const char>(graph.data(), graph.size()));
  const uint64_t sizes[] = {ray_definition_version, size.samples, size.frames,
                            frame.description.width, frame.description.height};
  hash.add(std::span<const uint64_t>(sizes));
  hash.add(std::span<const char>(scene.data(), scene.size()));
  hash.add(std::span<const double>(frame.description.clip_from_view));
  hash.add(std::span<const double>(frame.description.view_from_world));
  hash.add(frame.depth.values);
  hash.add(frame.normal.values);
  hash.add(frame.lighting.values);
  hash.add(frame.back_lighting.values);
  hash.add(frame.profile);
  for (const CaptureProfile& one : frame.description.profiles)
    add_shapes(hash, {&one.profile.shape_mm, 1});
  return hash;
}

// Sums over frames, for pixels with a profile.
struct Sums {
  std::vector<double> light;  // 3 values per pixel
  std::vector<double> square; // of luminance
};

} // namespace

demo::Result<RayReference> make_ray_reference(const RayReferenceSize& size,
                                              const RayRequest& request, const SceneRequest& scene,
                                              const Subject& subject, const SubjectOptions& options,
                                              const std::string& cache) {
  const CapturedFrame& frame = subject.frame;
  auto text = demo::read_text_file(scene.file);
  if (!text) return text.error();
  RayReference made;
  Reference& reference = made.reference;
  reference.everywhere = true;
  for (uint32_t i = 0; i < frame.profile.size(); ++i)
    if (frame.profile[i] != 0) reference.pixels.push_back(i);
  reference.population = reference.pixels.size();
  if (reference.pixels.empty())
    return demo::Error{demo::ErrorKind::input,
                       fmt::format("no pixel of '{}' has a profile", scene.file)};

  const Hash hash = hash_of(size, request, *text, frame);
  const size_t count = 3 * reference.pixels.size();
  if (auto kept = read_kept(cache, hash, count + 1)) {
    made.own_mse = kept->back();
    kept->pop_back();
    reference.light = std::move(*kept);
  } else {
    Sums sums{std::vector<double>(count), std::vector<double>(reference.pixels.size())};
    RayRequest many = request;
    many.set.emplace_back("samples", fmt::format("{}", size.samples));
    many.frames = size.frames;
    auto done = scatter_by_rays(many, scene, options, [&](const RayFrame& one) -> demo::Result<> {
      for (size_t i = 0; i < reference.pixels.size(); ++i) {
        double rgb[3];
        for (size_t c = 0; c < 3; ++c)
          sums.light[3 * i + c] += rgb[c] = double(one.light[size_t{3} * reference.pixels[i] + c]);
        sums.square[i] += luminance_of(rgb) * luminance_of(rgb);
      }
      return demo::success();
    });
    if (!done) return done.error();
    const double n = size.frames;
    for (double& value : sums.light)
      value /= n;
    for (size_t i = 0; i < reference.pixels.size(); ++i) {
      const double mean = luminance_of(&sums.light[3 * i]);
      made.own_mse += std::max(0.0, sums.square[i] / n - mean * mean) / (n - 1);
    }
    made.own_mse /= double(reference.pixels.size());
    reference.light = std::move(sums.light);
    std::vector<double> values = reference.light;
    values.push_back(made.own_mse);
    keep(cache, hash, values);
  }
  ExposureMeter meter;
  const std::vector<float> light(reference.light.begin(), reference.light.end());
  meter.add(light, std::vector<uint8_t>(reference.pixels.size(), 1));
  reference.exposure = meter.result();
  made.own_mse *= reference.exposure * reference.exposure;
  return made;
}

} // namespace dermis::tools
