#include "integration/tools/command/bench/restir/regions.hpp"

namespace dermis::tools {
namespace {

bool comes_through(const CapturedFrame& frame, uint32_t pixel, double thin_mm) {
  const double metres = double(frame.thickness.values[pixel]);
  return metres > 0 && 1000 * metres <= thin_mm &&
         luminance_of(&frame.back_lighting.values[size_t{3} * pixel]) >
             luminance_of(&frame.lighting.values[size_t{3} * pixel]);
}

RegionError measure(std::span<const float> light, const Reference& region) {
  if (region.pixels.empty()) return {};
  const ErrorFigures figures =
      measure_error(light, region.light, region.pixels, region.exposure, region.population);
  double found = 0, reference = 0;
  for (size_t i = 0; i < region.pixels.size(); ++i) {
    found += luminance_of(&light[size_t{3} * region.pixels[i]]);
    reference += luminance_of(&region.light[3 * i]);
  }
  return {figures.rmse * figures.rmse, reference > 0 ? found / reference : 0};
}

} // namespace

RayRegions split_by_light(const Reference& reference, const CapturedFrame& frame, double thin_mm) {
  RayRegions regions{reference, {}, {}};
  for (size_t i = 0; i < reference.pixels.size(); ++i) {
    Reference& part =
        comes_through(frame, reference.pixels[i], thin_mm) ? regions.through : regions.rest;
    part.pixels.push_back(reference.pixels[i]);
    part.light.insert(part.light.end(), &reference.light[3 * i], &reference.light[3 * i] + 3);
  }
  for (Reference* part : {&regions.through, &regions.rest}) {
    part->exposure = reference.exposure;
    part->population = part->pixels.size();
    part->everywhere = reference.everywhere;
  }
  return regions;
}

LightError measure_light(std::span<const float> light, const RayRegions& regions) {
  return {measure(light, regions.all), measure(light, regions.through),
          measure(light, regions.rest)};
}

LightError mean_of(std::span<const LightError> frames) {
  LightError mean;
  for (const LightError& frame : frames)
    for (auto part : {&LightError::all, &LightError::through, &LightError::rest}) {
      (mean.*part).mse += (frame.*part).mse / double(frames.size());
      (mean.*part).light += (frame.*part).light / double(frames.size());
    }
  return mean;
}

} // namespace dermis::tools
