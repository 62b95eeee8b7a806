#include "integration/tools/command/inspect/diagnose.hpp"

#include "integration/tools/command/statistics.hpp"
#include "integration/tools/files/metrics.hpp"
#include "passes/common/pass_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace dermis::tools {
namespace {

// Minimum number of pixels or pairs of pixels for a finding.
constexpr size_t min_samples = 64;

struct FrameFigures {
  uint64_t profile_pixels = 0; // inside the render rectangle, with or without depth
  double median_d_px = 0;      // of the widest channel
  double pixel_m = 0;          // side of a pixel at the median depth, metres
  // side of a square of equal area as these pixels, metres
  double extent_m = 0;
  double near_m = 0, median_m = 0, far_m = 0; // 5th, 50th and 95th percentile of depth, metres
  size_t depth_pixels = 0;                    // pixels with profile and depth
};

class FrameDiagnosis {
public:
  FrameDiagnosis(const CapturedFrame& frame, const SourceLocation& where, Diagnostics& diagnostics)
      : frame_(frame), where_(where), diagnostics_(diagnostics) {}

  std::string run() {
    measure();
    check_matrices();
    if (figures_.profile_pixels == 0) {
      add(DiagnosticId::first_frame_no_subsurface,
          fmt::format(
              "all {} pixels of 'profile.exr' in the render rectangle are 0: nothing scatters",
              uint64_t{render().width} * render().height));
      return "no pixel has a profile";
    }
    if (frame_.albedo.values.empty())
      add(DiagnosticId::first_frame_no_albedo,
          "'albedo.exr' is missing: scattered light is shown as if "
          "every surface were white");
    check_albedo_in_lighting();
    check_pixel_shape();
    if (figures_.profile_pixels < min_samples)
      return fmt::format("{} pixels have a profile: too few to judge", figures_.profile_pixels);
    if (figures_.depth_pixels < min_samples) {
      add(DiagnosticId::first_frame_depth,
          fmt::format("{} of {} pixels with a profile have a depth above 0", figures_.depth_pixels,
                      figures_.profile_pixels));
      return fmt::format("{} pixels have a profile", figures_.profile_pixels);
    }
    check_units();
    check_depth_range();
    check_depth_direction();
    return fmt::format(
        "{} pixels have a profile; d {:.3g} px (median); depth {:.3g}, {:.3g}, {:.3g} m (5th, "
        "50th, 95th percentile); a pixel is {:.3g} mm wide",
        figures_.profile_pixels, figures_.median_d_px, figures_.near_m, figures_.median_m,
        figures_.far_m, 1000 * figures_.pixel_m);
  }

private:
  const Rectangle& render() const { return frame_.description.render; }
  size_t pixel_at(uint32_t x, uint32_t y) const { // of the render rectangle
    return size_t{render().y + y} * frame_.description.width + render().x + x;
  }
  double depth(size_t pixel) const { return double{frame_.depth.values[pixel]}; }
  void add(DiagnosticId id, std::string text) { diagnostics_.add(id, where_, std::move(text)); }
  double pixel_side(double depth_m) const {
    const double scale = std::sqrt(std::abs(frame_.rays.scale_x * frame_.rays.scale_y));
    return frame_.rays.perspective ? scale * depth_m : scale;
  }
  double widest_d_m(uint8_t id) const {
    for (const CaptureProfile& one : frame_.description.profiles)
      if (one.id == id) return 1e-3 * one.profile.d_mm[static_cast<size_t>(one.profile.widest)];
    return 0;
  }
  void for_each_pixel(const std::function<void(uint32_t, uint32_t, size_t)>& visit) const {
    for (uint32_t y = 0; y < render().height; ++y)
      for (uint32_t x = 0; x < render().width; ++x)
        visit(x, y, pixel_at(x, y));
  }
  // Visits each pixel with its right and its lower neighbour.
  void for_each_pair(const std::function<void(size_t, size_t)>& visit) const {
    for_each_pixel([&](uint32_t x, uint32_t y, size_t p) {
      if (x + 1 < render().width) visit(p, pixel_at(x + 1, y));
      if (y + 1 < render().height) visit(p, pixel_at(x, y + 1));
    });
  }

  void measure() {
    std::vector<double> depths, d_px;
    for_each_pixel([&](uint32_t, uint32_t, size_t p) {
      if (frame_.profile[p] == 0) return;
      ++figures_.profile_pixels;
      if (!(depth(p) > 0)) return;
      depths.push_back(depth(p));
      const double scale =
          frame_.scatter_scale.values.empty() ? 1 : double{frame_.scatter_scale.values[p]};
      d_px.push_back(scale * widest_d_m(frame_.profile[p]) / pixel_side(depth(p)));
    });
    figures_.depth_pixels = depths.size();
    if (depths.empty()) return;
    figures_.median_d_px = quantile(d_px, 0.5);
    figures_.near_m = quantile(depths, 0.05);
    figures_.median_m = quantile(depths, 0.5);
    figures_.far_m = quantile(depths, 0.95);
    figures_.pixel_m = pixel_side(figures_.median_m);
    figures_.extent_m = figures_.pixel_m * std::sqrt(static_cast<double>(depths.size()));
  }

  // The last row of an affine matrix is 0 0 0 1. A matrix stored by columns has its translation
  // there.
  void check_matrix(std::string_view name, const subsurface::Matrix4& m) {
    const bool translation_in_row = m[12] != 0 || m[13] != 0 || m[14] != 0;
    if (!translation_in_row) return;
    const bool column_empty = m[3] == 0 && m[7] == 0 && m[11] == 0;
    add(DiagnosticId::first_frame_matrix,
        fmt::format("the last row of '{}' is {:g} {:g} {:g} {:g}, expected 0 0 0 1{}", name, m[12],
                    m[13], m[14], m[15],
                    column_empty ? ": the matrix is stored column by column" : ""));
  }
  void check_matrices() {
    check_matrix("view_from_world", frame_.description.view_from_world);
    check_matrix("previous_view_from_world", frame_.description.previous_view_from_world);
  }

  // Albedo may change between neighbouring pixels of one surface, but irradiance does not. Lighting
  // that contains albedo changes by the same factor, so that log lighting over log albedo has slope
  // 1.
  void check_albedo_in_lighting() {
    if (frame_.albedo.values.empty()) return;
    constexpr double min_log_step = 0.1, min_value = 1e-3, depth_sides = 4, contained_from = 0.7;
    std::vector<double> slopes;
    for_each_pair([&](size_t p, size_t q) {
      if (frame_.profile[p] == 0 || frame_.profile[p] != frame_.profile[q]) return;
      if (std::abs(depth(p) - depth(q)) > depth_sides * pixel_side(depth(p))) return;
      const double albedo_p = luminance_of(&frame_.albedo.values[3 * p]),
                   albedo_q = luminance_of(&frame_.albedo.values[3 * q]);
      const double light_p = luminance_of(&frame_.lighting.values[3 * p]),
                   light_q = luminance_of(&frame_.lighting.values[3 * q]);
      if (std::min({albedo_p, albedo_q, light_p, light_q}) < min_value) return;
      const double step = std::log(albedo_q / albedo_p);
      if (std::abs(step) > min_log_step) slopes.push_back(std::log(light_q / light_p) / step);
    });
    if (slopes.size() < min_samples) return;
    const double slope = quantile(slopes, 0.5);
    if (slope > contained_from)
      add(DiagnosticId::first_frame_albedo_in_lighting,
          fmt::format(
              "'lighting.exr' changes with 'albedo.exr' (median exponent {:.2f} over {} steps of "
              "albedo, 0 expected): it already contains albedo",
              slope, slopes.size()));
  }

  void check_pixel_shape() {
    constexpr double square_within = 0.02;
    const double ratio = std::abs(frame_.rays.scale_x / frame_.rays.scale_y);
    if (std::abs(ratio - 1) > square_within)
      add(DiagnosticId::first_frame_matrix,
          fmt::format(
              "'clip_from_view' makes pixels {:.3f} times as wide as high in a render rectangle of "
              "{} x {}",
              ratio, render().width, render().height));
  }

  void check_units() {
    // outside: whole buildings, or less than a fingernail
    constexpr double large_m = 10, small_m = 2e-3;
    constexpr double narrow_px = 0.2, wide_px = 60;
    const FrameFigures& f = figures_;
    const std::string measured =
        fmt::format("pixels with a profile cover {:.3g} m at {:.3g} m, and d is "
                    "{:.3g} px",
                    f.extent_m, f.median_m, f.median_d_px);
    if (f.median_d_px < narrow_px && f.extent_m > large_m)
      add(DiagnosticId::first_frame_units,
          fmt::format("{}: lengths seem to be {}, but are read as metres", measured,
                      f.extent_m > 10 * large_m ? "millimetres" : "centimetres"));
    else if (f.median_d_px > wide_px && f.extent_m < small_m)
      add(DiagnosticId::first_frame_units,
          fmt::format("{}: lengths seem larger than the values read", measured));
    else if (f.median_d_px < subsurface::copy_below_d_px)
      add(DiagnosticId::first_frame_below_pixel,
          fmt::format("d is {:.3g} px (median): below {} px light is copied, and nothing is seen "
                      "to scatter",
                      f.median_d_px, subsurface::copy_below_d_px));
  }

  // Distances do not end at exactly 1 and are not nearer than the near plane; depth buffer values
  // may be.
  void check_depth_range() {
    constexpr double min_fraction = 0.01, one_distance = 1e-4;
    uint64_t ones = 0, above = 0, nearer = 0, valid = 0;
    const double near_plane = near_plane_m();
    for_each_pixel([&](uint32_t, uint32_t, size_t p) {
      const double d = depth(p);
      valid += d > 0 ? 1 : 0;
      ones += d == 1 && frame_.profile[p] == 0 ? 1 : 0;
      above += d > 1 ? 1 : 0;
      nearer += d > 0 && d < 0.99 * near_plane ? 1 : 0;
    });
    const auto many = [&](uint64_t count) {
      return static_cast<double>(count) > min_fraction * static_cast<double>(valid);
    };
    if (above == 0 && many(ones) && figures_.median_m < 1)
      add(DiagnosticId::first_frame_depth,
          fmt::format("no depth is above 1, and {} pixels without profile have exactly 1: "
                      "'depth.exr' looks "
                      "like a depth buffer, expected metres along the view axis",
                      ones));
    else if (many(nearer))
      add(DiagnosticId::first_frame_depth,
          fmt::format(
              "{} of {} depths are nearer than the near plane of 'clip_from_view' ({:.3g} m): "
              "'depth.exr' looks like a depth buffer, or 'metres_per_unit' is wrong",
              nearer, valid, near_plane));
    else if (frame_.rays.perspective &&
             figures_.far_m - figures_.near_m < one_distance * figures_.near_m)
      add(DiagnosticId::first_frame_depth,
          fmt::format(
              "all pixels with a profile are at {:.4g} m: right only for a plane that faces the "
              "camera",
              figures_.median_m));
  }

  // Returns the depth of the nearer end of the depth range, metres. Returns 0 for orthographic
  // cameras, whose range may lie anywhere.
  double near_plane_m() const {
    if (!frame_.rays.perspective) return 0;
    const subsurface::DepthDecode decode = subsurface::depth_decode(
        frame_.description.clip_from_view, frame_.description.metres_per_unit);
    double nearest = 0;
    for (const double value : {0.0, 1.0}) {
      const double d = (decode.a * value + decode.b) / (decode.c * value + decode.e);
      if (std::isfinite(d) && d > 0 && (nearest == 0 || d < nearest)) nearest = d;
    }
    return nearest;
  }

  // Surfaces turn away from the camera at their outline, so that depth is larger there than in the
  // middle. A pixel is on the outline if a neighbour has no profile and is background or much
  // further or nearer.
  void check_depth_direction() {
    constexpr double far_step = 0.05, clear_fraction = 0.25, min_relief = 1e-3;
    std::vector<double> outline, all;
    const auto visit = [&](size_t p, size_t q) {
      if (frame_.profile[p] == 0 || frame_.profile[q] != 0 || !(depth(p) > 0)) return;
      const bool leaves = !(depth(q) > 0) || std::abs(depth(q) - depth(p)) > far_step * depth(p);
      if (leaves) outline.push_back(depth(p));
    };
    for_each_pair([&](size_t p, size_t q) {
      visit(p, q);
      visit(q, p);
    });
    const double relief = figures_.far_m - figures_.near_m;
    if (outline.size() < min_samples || relief < min_relief * figures_.median_m) return;
    const double edge = quantile(outline, 0.5);
    if (edge < figures_.median_m - clear_fraction * relief)
      add(DiagnosticId::first_frame_depth,
          fmt::format(
              "outlines are nearer ({:.4g} m) than their interior ({:.4g} m): depth seems to be "
              "flipped (near and far exchanged)",
              edge, figures_.median_m));
  }

  const CapturedFrame& frame_;
  const SourceLocation& where_;
  Diagnostics& diagnostics_;
  FrameFigures figures_;
};

} // namespace

std::string diagnose_frame(const CapturedFrame& frame, const SourceLocation& frame_json,
                           Diagnostics& diagnostics) {
  return FrameDiagnosis(frame, frame_json, diagnostics).run();
}

} // namespace dermis::tools
