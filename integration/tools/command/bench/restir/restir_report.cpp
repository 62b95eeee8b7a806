#include "integration/tools/command/bench/restir/restir_report.hpp"

#include "integration/tools/command/bench/report/heat_map.hpp"
#include "integration/tools/command/bench/restir/claims.hpp"
#include "integration/tools/command/present.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

ReportValue if_any(const Reference& region, double value) {
  return region.pixels.empty() ? ReportValue() : ReportValue(value);
}

std::string name_of(const RestirRow& row) {
  if (row.technique != "restir") return fmt::format("{} {}", row.technique, row.setting);
  return fmt::format("restir, {}{}{}", row.variant.reuse, row.variant.shift.empty() ? "" : " ",
                     row.variant.shift);
}

ReportPicture picture_of(const std::string& caption, const CapturedFrame& frame, double exposure,
                         const std::function<float(size_t)>& value) {
  demo::FloatImage image{frame.description.width, frame.description.height, 3, {}};
  for (size_t i = 0; i < 3 * frame.profile.size(); ++i)
    image.texels.push_back(frame.profile[i / 3] != 0 ? value(i) * static_cast<float>(exposure) : 0.0f);
  return {caption, image.width, image.height, demo::tonemap(image)};
}

void add_pictures(Report& report, const RestirScene& scene) {
  ReportPictures& light = report.pictures[0];
  ReportPictures& maps = report.pictures[1];
  const CapturedFrame& frame = scene.subject.frame;
  const Reference& reference = scene.reference.reference;
  std::vector<float> everywhere(3 * frame.profile.size());
  for (size_t i = 0; i < reference.light.size(); ++i)
    everywhere[size_t{3} * reference.pixels[i / 3] + i % 3] = static_cast<float>(reference.light[i]);
  light.pictures.push_back(picture_of(scene.subject.scene + ", reference", frame, reference.exposure,
                                      [&](size_t i) { return everywhere[i]; }));
  for (const RestirRow& row : scene.rows) {
    if (!row.heat_map) continue;
    const std::string caption = fmt::format("{}, {}", scene.subject.scene, name_of(row));
    light.pictures.push_back(
        picture_of(caption, frame, reference.exposure, [&](size_t i) { return row.light[i]; }));
    maps.pictures.push_back(heat_map(caption, row.light, reference, frame.description.width, frame.profile));
  }
}

} // namespace

Report start_restir_report(const RestirFile& file) {
  Report report;
  report.bench = "restir";
  report.title = "Ray-traced light and screen-space techniques";
  report.summary =
      "Error of the scattered light before albedo against a reference by rays: linear Rec.709 luminance, the "
      "99.9th percentile of the reference's own light at 1 (what falls on the side that is seen says little "
      "where light comes from behind). At equal time: mean square error times device time, over the same "
      "without reuse at as many samples, since the error of independent samples falls as one over their "
      "number; below 1 is better. Light: mean over the reference's mean, 1 where nothing is missing.";
  report.info.emplace_back(
      "reference", fmt::format("the same kernels without reuse, {} paths a pixel in each of {} frames",
                               file.reference.samples, file.reference.frames));
  report.info.emplace_back("expected", expectation_text());
  report.info.emplace_back(
      "frames", fmt::format("{} counted, after {} where there is history", file.frames, file.settle));
  report.info.emplace_back(
      "through", fmt::format("pixels with more back light than front light, and a thickness of at most {} mm",
                             file.thin_mm));
  report.table.columns = {{"scene", "scene"},
                          {"d_px", "d, px"},
                          {"technique", "technique"},
                          {"setting", "setting"},
                          {"shift", "shift"},
                          {"reuse", "reuse"},
                          {"samples", "paths"},
                          {"device_ms", "ms", 4},
                          {"mse", "MSE"},
                          {"mse_ratio_to_none_at_equal_time", "MSE at equal time / none"},
                          {"mse_at_most", "MSE expected at most"},
                          {"holds", "holds"},
                          {"rmse_through", "RMSE through"},
                          {"light_through", "light through"},
                          {"rmse_rest", "RMSE of the rest"},
                          {"light_rest", "light of the rest"},
                          {"mse_of_reference", "MSE of the reference"},
                          {"pixels", "pixels"},
                          {"pixels_through", "pixels through"},
                          {"slab_rms", "light that slabs let through, RMS"},
                          {"rmse_of_slab", "RMSE / light that slabs let through"}};
  report.pictures = {{"Light", "Scattered light before albedo, exposed and tonemapped.", {}},
                     {"Error maps", heat_map_explanation(), {}}};
  return report;
}

void add_scene(Report& report, const RestirScene& scene) {
  const RayRegions& regions = scene.regions;
  for (const RestirRow& row : scene.rows) {
    ReportValue shift, reuse, samples, ratio, at_most, holds, of_slab;
    if (row.samples > 0) {
      reuse = row.variant.reuse;
      samples = static_cast<int64_t>(row.samples);
      if (!row.variant.shift.empty()) shift = row.variant.shift;
    }
    if (row.ratio_to_none) ratio = *row.ratio_to_none;
    if (row.mse_at_most) {
      at_most = *row.mse_at_most;
      holds = row.error.all.mse <= *row.mse_at_most;
    }
    if (row.samples == 0 && scene.slab_rms > 0) of_slab = std::sqrt(row.error.all.mse) / scene.slab_rms;
    report.table.rows.push_back({scene.subject.scene,
                                 scene.subject.d_px,
                                 row.technique,
                                 row.setting,
                                 shift,
                                 reuse,
                                 samples,
                                 row.device_ms,
                                 row.error.all.mse,
                                 ratio,
                                 at_most,
                                 holds,
                                 if_any(regions.through, std::sqrt(row.error.through.mse)),
                                 if_any(regions.through, row.error.through.light),
                                 if_any(regions.rest, std::sqrt(row.error.rest.mse)),
                                 if_any(regions.rest, row.error.rest.light),
                                 scene.reference.own_mse,
                                 static_cast<int64_t>(regions.all.pixels.size()),
                                 static_cast<int64_t>(regions.through.pixels.size()),
                                 scene.slab_rms,
                                 of_slab});
  }
  add_pictures(report, scene);
}

std::string text_of_restir(const Report& report) {
  Table table;
  table.columns = {{"scene"},       {"technique"},  {"setting"},      {"reuse"}, {"shift"},
                   {"ms", true},    {"MSE", true},  {"/ none", true}, {"holds"}, {"through", true},
                   {"light", true}, {"rest", true}, {"light", true}};
  std::string last;
  for (size_t i = 0; i < report.table.rows.size(); ++i) {
    const auto text = [&](const char* key, int digits = 0) { return report.table.text_at(i, key, digits); };
    if (!last.empty() && text("scene") != last) table.rows.emplace_back();
    last = text("scene");
    table.rows.push_back({last, text("technique"), text("setting"), text("reuse"), text("shift"),
                          text("device_ms", 2), text("mse", 6), text("mse_ratio_to_none_at_equal_time", 3),
                          text("holds"), text("rmse_through", 4), text("light_through", 3),
                          text("rmse_rest", 4), text("light_rest", 3)});
  }
  return format_table(table);
}

} // namespace dermis::tools
