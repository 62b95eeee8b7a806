#include "integration/tools/command/run/reference_run.hpp"

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/interrupt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

// per check of progress and Ctrl-C; under a second at d = 10 px
constexpr size_t chunk_pixels = 512;

} // namespace

std::optional<std::vector<double>> run_reference(const Session& session, const std::string& what,
                                                 const subsurface::ReferenceInput& input,
                                                 std::span<const uint32_t> pixels) {
  Progress progress(progress_style(session.quiet, session.json), what, "pixel", pixels.size());
  std::vector<double> all;
  all.reserve(pixels.size() * 3);
  for (size_t at = 0; at < pixels.size(); at += chunk_pixels) {
    if (interrupted()) return std::nullopt;
    const auto chunk = pixels.subspan(at, std::min(chunk_pixels, pixels.size() - at));
    const std::vector<double> part = subsurface::reference_at(input, chunk);
    all.insert(all.end(), part.begin(), part.end());
    progress.update(at + chunk.size());
  }
  return all;
}

double median_d_px(const subsurface::ReferenceInput& input) {
  // metres at depth 1
  const double pixel = std::sqrt(std::abs(input.rays.scale_x * input.rays.scale_y));
  std::vector<double> all;
  for (size_t i = 0; i < input.profile.size(); ++i) {
    const uint8_t id = input.profile[i];
    if (id == 0 || id >= input.d_m.size() || !(input.depth[i] > 0.0f)) continue;
    const auto& d = input.d_m[id];
    const double scale =
        input.scatter_scale.empty() ? 1.0 : static_cast<double>(input.scatter_scale[i]);
    const double footprint =
        pixel * (input.rays.perspective ? static_cast<double>(input.depth[i]) : 1.0);
    all.push_back(*std::max_element(d.begin(), d.end()) * scale / footprint);
  }
  if (all.empty()) return 0.0;
  const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
  std::nth_element(all.begin(), middle, all.end());
  return *middle;
}

uint64_t subsurface_pixels(std::span<const uint8_t> profile) {
  return static_cast<uint64_t>(
      std::count_if(profile.begin(), profile.end(), [](uint8_t id) { return id != 0; }));
}

std::string format_error(const ErrorFigures& figures, const std::string& where, uint64_t population,
                         double exposure, double d_px) {
  Table table;
  table.columns = {{fmt::format("error of the scattered light, {}", where)}, {"", true}};
  table.rows = {
      {"PSNR (linear luminance, peak 1)", format_decibels(figures.psnr_db)},
      {"RMSE", fmt::format("{:.5f}", figures.rmse)},
      {"RMSE, 95 % confidence",
       fmt::format("{:.5f} .. {:.5f}", figures.rmse_low, figures.rmse_high)},
      {"RMSE of red, green, blue", fmt::format("{:.5f} {:.5f} {:.5f}", figures.rmse_rgb[0],
                                               figures.rmse_rgb[1], figures.rmse_rgb[2])},
      {"99th percentile, largest",
       fmt::format("{:.5f}, {:.5f}", figures.p99_error, figures.max_error)},
      {"pixels measured, of all subsurface pixels",
       fmt::format("{} of {}", figures.pixels, population)},
      {"d of the widest channel, median", fmt::format("{:.2f} px", d_px)},
      {"exposure of these figures", fmt::format("{:.4f}", exposure)},
  };
  return format_table(table);
}

std::string error_as_json(const ErrorFigures& figures, uint64_t population, double exposure,
                          double d_px) {
  JsonWriter answer;
  answer.open_object(true).member("psnr_db", figures.psnr_db).member("rmse", figures.rmse);
  answer.member("rmse_low", figures.rmse_low).member("rmse_high", figures.rmse_high);
  answer.key("rmse_rgb").open_array();
  for (const double rmse : figures.rmse_rgb)
    answer.value(rmse);
  answer.close().member("p99_error", figures.p99_error).member("max_error", figures.max_error);
  answer.member("pixels", figures.pixels).member("population", population);
  answer.member("exposure", exposure).member("d_px", d_px).close();
  return std::move(answer).finish();
}

} // namespace dermis::tools
