#include "integration/tools/command/bench/restir/restir_report.hpp"

#include "integration/tools/command/bench/report/heat_map.hpp"
#include "integration/tools/command/bench/restir/claims.hpp"
#include "integration/tools/command/bench/restir/ray_frames.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

std::string row_name(const RestirRow& row) {
  if (row.technique != "restir") return fmt::format("{} {}", row.technique, row.setting);
  return fmt::format("restir, {}{}{}", row.variant.reuse, row.variant.shift.empty() ? "" : " ",
                     row.variant.shift);
}

ReportPicture picture_of(const std::string& caption, const CapturedFrame& frame, double exposure,
                         const std::function<float(size_t)>& value) {
  demo::FloatImage image{frame.description.width, frame.description.height, 3, {}};
  for (size_t i = 0; i < 3 * frame.profile.size(); ++i)
    image.texels.push_back(frame.profile[i / 3] != 0 ? value(i) * static_cast<float>(exposure)
                                                     : 0.0f);
  return {caption, image.width, image.height, demo::tonemap(image)};
}

// Returns a figure of a part of the light, or nothing if no pixel belongs to it.
std::optional<double> rmse_if(const Reference& region, const RegionError& error) {
  return region.pixels.empty() ? std::nullopt : std::optional(std::sqrt(error.mse));
}
std::optional<double> light_if(const Reference& region, const RegionError& error) {
  return region.pixels.empty() ? std::nullopt : std::optional(error.light);
}

template <class Value> ReportValue if_paths(const RestirRow& row, const Value& value) {
  return row.samples > 0 ? ReportValue(value) : ReportValue();
}

} // namespace

void add_pictures(Report& report, const RestirScene& scene) {
  ReportPictures& light = report.pictures[0];
  ReportPictures& maps = report.pictures[1];
  const CapturedFrame& frame = scene.subject.frame;
  const Reference& reference = scene.reference.reference;
  std::vector<float> reference_image(3 * frame.profile.size());
  for (size_t i = 0; i < reference.light.size(); ++i)
    reference_image[size_t{3} * reference.pixels[i / 3] + i % 3] =
        static_cast<float>(reference.light[i]);
  light.pictures.push_back(picture_of(scene.subject.scene + ", reference", frame,
                                      reference.exposure,
                                      [&](size_t i) { return reference_image[i]; }));
  for (const RestirRow& row : scene.rows) {
    if (!row.heat_map) continue;
    const std::string caption = fmt::format("{}, {}", scene.subject.scene, row_name(row));
    light.pictures.push_back(
        picture_of(caption, frame, reference.exposure, [&](size_t i) { return row.light[i]; }));
    maps.pictures.push_back(
        heat_map(caption, row.light, reference, frame.description.width, frame.profile));
  }
}

void start_restir_report(SuiteRun& run, const RestirFile& file) {
  run.add_info("reference",
               fmt::format("the same kernels without reuse, {} paths a pixel in each of {} frames",
                           file.reference.samples, file.reference.frames));
  run.add_info("expected", expectation_text());
  run.add_info("frames", fmt::format("{} counted, after {} where there is history", file.frames,
                                     file.settle));
  run.add_info(
      "through",
      fmt::format("pixels with more back light than front light, and a thickness of at most {} mm",
                  file.thin_mm));
  run.add_info("size", fmt::format("{}x{} pixels", run.size().width, run.size().height));
  run.report.pictures = {{"Light", "Scattered light before albedo, exposed and tonemapped.", {}},
                         {"Error maps", heat_map_explanation(), {}}};
}

Suite restir_suite() {
  using Row = RestirRow;
  const ColumnStyle page{.in_text = false};
  SuiteOption size = size_option({96, 96});
  size.quick = Size{32, 32};
  return make_suite<Row>(
      {.name = "restir",
       .what = "Compare ray-traced light with every reuse and shift of the graph, and screen-space "
               "techniques; needs ray queries",
       .title = "Ray-traced light and screen-space techniques",
       .summary =
           "Error of the scattered light before albedo against a reference by rays: linear Rec.709 "
           "luminance, normalised so that the 99.9th percentile of the reference is 1. At equal "
           "time: mean square error times device time, relative to no reuse with equally many "
           "samples; below 1 is better. Light: mean relative to the reference's mean.",
       .options = {size, head_option(), only_option("scenes"), only_option("shifts"),
                   file_option("tests/benchmark/restir.json"), cache_option()},
       .why_not = why_no_rays},
      {{"scene",
        "scene",
        [](const Row& row) { return row.scene->subject.scene; },
        {.groups = true}},
       {"d_px", "d, px", [](const Row& row) { return row.scene->subject.d_px; }, page},
       {"technique", "technique", &Row::technique},
       {"setting", "setting", &Row::setting},
       {"shift", "shift",
        [](const Row& row) {
          return row.variant.shift.empty() ? ReportValue() : if_paths(row, row.variant.shift);
        }},
       {"reuse", "reuse", [](const Row& row) { return if_paths(row, row.variant.reuse); }},
       {"samples", "paths", [](const Row& row) { return if_paths(row, row.samples); }, page},
       {"device_ms", "ms", &Row::device_ms, {4}},
       {"mse", "MSE", [](const Row& row) { return row.error.all.mse; }},
       {"mse_ratio_to_none_at_equal_time", "MSE at equal time / none", &Row::ratio_to_none},
       {"max_mse", "MSE expected at most", &Row::max_mse, page},
       {"holds",
        "holds",
        [](const Row& row) {
          return row.max_mse ? std::optional(row.error.all.mse <= *row.max_mse) : std::nullopt;
        },
        {.goal = Goal::required}},
       {"rmse_through", "RMSE through",
        [](const Row& row) { return rmse_if(row.scene->regions.through, row.error.through); }},
       {"light_through", "light through",
        [](const Row& row) { return light_if(row.scene->regions.through, row.error.through); }},
       {"rmse_rest", "RMSE of the rest",
        [](const Row& row) { return rmse_if(row.scene->regions.rest, row.error.rest); }},
       {"light_rest", "light of the rest",
        [](const Row& row) { return light_if(row.scene->regions.rest, row.error.rest); }},
       {"mse_of_reference", "MSE of the reference",
        [](const Row& row) { return row.scene->reference.own_mse; }, page},
       {"pixels", "pixels", [](const Row& row) { return row.scene->regions.all.pixels.size(); },
        page},
       {"pixels_through", "pixels through",
        [](const Row& row) { return row.scene->regions.through.pixels.size(); }, page},
       {"slab_rms", "light that slabs let through, RMS",
        [](const Row& row) { return row.scene->slab_rms; }, page},
       {"rmse_of_slab", "RMSE / light that slabs let through",
        [](const Row& row) {
          const double slab_rms = row.scene->slab_rms;
          return row.samples == 0 && slab_rms > 0
                     ? ReportValue(std::sqrt(row.error.all.mse) / slab_rms)
                     : ReportValue();
        },
        page}},
      measure_restir);
}

} // namespace dermis::tools
