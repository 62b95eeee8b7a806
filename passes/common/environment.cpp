#include "passes/common/environment.hpp"

#include "passes/common/dispatch.hpp"
#include "passes/papers/jimenez_kernel.hpp"
#include "passes/sap/sap_weights.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

bool has_own_tables(const NumberedProfile& numbered) {
  return numbered.profile.model != ProfileModel::burley;
}

namespace {
constexpr double mm_per_metre = 1000.0;

int32_t tiles_of(uint32_t pixels) {
  return static_cast<int32_t>(ceil_div(pixels, tile_side));
}

// Fills the part of `out` that describes the previous frame. Returns false if that frame is
// unusable.
bool fill_previous(const FrameInput& input, FrameConstants& out) {
  const auto rays =
      pixel_rays(input.camera.previous_clip_from_view, input.previous_width, input.previous_height,
                 input.metres_per_unit, {0, 0}); // the matrix contains its jitter
  const auto world_from_view = invert_affine(input.camera.view_from_world);
  if (!rays || !world_from_view) return false;
  const Matrix4 moved = multiply(input.camera.previous_view_from_world, *world_from_view);
  if (!std::all_of(moved.begin(), moved.end(), [](double x) { return std::isfinite(x); }))
    return false;
  const double mm_per_unit = input.metres_per_unit * mm_per_metre;
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 4; ++c)
      out.previous_from_view[r][c] =
          static_cast<float>(moved[4 * r + c] * (c == 3 ? mm_per_unit : 1.0));
  const double ray_unit = rays->perspective ? 1.0 : mm_per_metre;
  out.previous_ray_scale[0] = static_cast<float>(rays->scale_x * ray_unit);
  out.previous_ray_scale[1] = static_cast<float>(rays->scale_y * ray_unit);
  out.previous_ray_offset[0] = static_cast<float>(rays->offset_x * ray_unit);
  out.previous_ray_offset[1] = static_cast<float>(rays->offset_y * ray_unit);
  out.previous_rect[0] = static_cast<int32_t>(input.previous_x);
  out.previous_rect[1] = static_cast<int32_t>(input.previous_y);
  out.previous_rect[2] = static_cast<int32_t>(input.previous_width);
  out.previous_rect[3] = static_cast<int32_t>(input.previous_height);
  out.previous_jitter[0] = static_cast<float>(input.previous_jitter_px[0]);
  out.previous_jitter[1] = static_cast<float>(input.previous_jitter_px[1]);
  if (rays->perspective) out.flags |= 8u;
  return true;
}

// By shape of pixels, then by SapVariant.
using SapTables = std::array<float, sap_variant_count * sap_table_floats>;

// Tables of unused variants are 0.
SapTables sap_tables_of(const ChannelShape& shape, const PyramidUse& use, const SapShape& pixel) {
  std::vector<SapVariant> used;
  if (use.surface) used = {SapVariant::base, SapVariant::smooth, SapVariant::half};
  if (use.plain) used.push_back(SapVariant::plain);
  SapTables tables{};
  for (const SapFit& fit : fit_sap_weights(used, shape, pixel)) {
    const std::vector<float> table = make_sap_table(fit);
    std::copy(table.begin(), table.end(),
              tables.begin() + static_cast<size_t>(fit.variant) * sap_table_floats);
  }
  return tables;
}

// Returns the tables for square pixels that all graphs share, fitted once. They are not on the
// heap, because the heap's owner may be destroyed before the next graph.
const SapTables& burley_sap_tables(const PyramidUse& use) {
  if (!use.plain) {
    static const SapTables surface = sap_tables_of(burley_shape(1), {true, false}, {});
    return surface;
  }
  if (!use.surface) {
    static const SapTables plain = sap_tables_of(burley_shape(1), {false, true}, {});
    return plain;
  }
  static const SapTables both = sap_tables_of(burley_shape(1), {true, true}, {});
  return both;
}

} // namespace

bool fill_frame_constants(const FrameInput& input, FrameConstants& out) {
  const auto rays = pixel_rays(input.camera.clip_from_view, input.rect_width, input.rect_height,
                               input.metres_per_unit, input.jitter_px);
  if (!rays || !std::isfinite(input.exposure)) return false;
  // Rays are in metres (per metre of depth if perspective, where the unit cancels).
  const double ray_unit = rays->perspective ? 1.0 : mm_per_metre;
  const DepthDecode decode = depth_decode(input.camera.clip_from_view, input.metres_per_unit);
  out.rect[0] = static_cast<int32_t>(input.rect_x);
  out.rect[1] = static_cast<int32_t>(input.rect_y);
  out.rect[2] = static_cast<int32_t>(input.rect_width);
  out.rect[3] = static_cast<int32_t>(input.rect_height);
  std::copy(input.bounds.begin(), input.bounds.end(), out.bounds);
  out.tiles[0] = tiles_of(input.rect_width);
  out.tiles[1] = tiles_of(input.rect_height);
  out.frame_index = static_cast<uint32_t>(input.frame_index);
  out.view_frame = out.frame_index; // for callers that count no frames of a view
  out.flags = (rays->perspective ? 1u : 0u) |
              (input.depth_kind == DepthKind::view_units ? 2u : 0u) |
              (input.history_invalid ? no_previous_frame : 0u) |
              (input.handedness == Handedness::left ? 16u : 0u);
  out.ray_scale[0] = static_cast<float>(rays->scale_x * ray_unit);
  out.ray_scale[1] = static_cast<float>(rays->scale_y * ray_unit);
  out.ray_offset[0] = static_cast<float>(rays->offset_x * ray_unit);
  out.ray_offset[1] = static_cast<float>(rays->offset_y * ray_unit);
  out.depth_decode[0] = static_cast<float>(decode.a * mm_per_metre);
  out.depth_decode[1] = static_cast<float>(decode.b * mm_per_metre);
  out.depth_decode[2] = static_cast<float>(decode.c);
  out.depth_decode[3] = static_cast<float>(decode.e);
  out.depth_unit = static_cast<float>(input.metres_per_unit * mm_per_metre);
  for (size_t r = 0; r < 3; ++r)
    for (size_t c = 0; c < 4; ++c)
      out.view_from_world[r][c] = static_cast<float>(input.camera.view_from_world[4 * r + c] *
                                                     input.metres_per_unit * mm_per_metre);
  out.exposure = input.exposure;
  out.sample_units = input.sample_units;
  out.jitter[0] = static_cast<float>(input.jitter_px[0]);
  out.jitter[1] = static_cast<float>(input.jitter_px[1]);
  if (!fill_previous(input, out)) out.flags |= no_previous_frame;
  return true;
}

double transmitted_rms(const FrameCounters& counters) {
  const double tiles =
      double(counters.scattering_tiles) + counters.copied_tiles + counters.uniform_tiles;
  return tiles > 0
             ? std::sqrt(double(counters.through_steps) / (double(through_square_steps) * tiles))
             : 0;
}

double mean_relief(const FrameCounters& counters) {
  if (counters.relief_pixels == 0) return -1;
  return double(counters.relief_sum) / (double(relief_steps) * counters.relief_pixels);
}

double mean_d_px(const FrameCounters& counters) {
  if (counters.scattering_tiles == 0) return 0;
  constexpr double half_step = 0.5; // mean of what rounding down removes
  const double steps = double(counters.log2_d_sum) / double(counters.scattering_tiles) + half_step;
  return std::exp2(steps / double(counter_log2_steps) - double(counter_log2_shift));
}

std::vector<ProfileEntry> make_profile_table(std::span<const NumberedProfile> profiles,
                                             bool with_separable, PixelGrid pixel_grid) {
  const auto shapes = static_cast<uint32_t>(sap_shapes(pixel_grid).size());
  ProfileEntry none{};
  none.separable_row = no_separable_row;
  none.radial_row = no_radial_row;
  std::vector<ProfileEntry> table(profile_capacity, none);
  uint32_t others = 0; // number of other models so far
  for (size_t i = 0; i < profiles.size(); ++i) {
    const NumberedProfile& numbered = profiles[i];
    const bool other = has_own_tables(numbered);
    if (numbered.id != 0 && numbered.id < profile_capacity) {
      ProfileEntry& entry = table[numbered.id];
      entry.widest = static_cast<uint32_t>(numbered.profile.widest);
      for (size_t c = 0; c < 3; ++c) {
        entry.d_mm[c] = static_cast<float>(numbered.profile.d_mm[c]);
        entry.direct[c] = static_cast<float>(numbered.profile.shape_mm[c].direct);
      }
      entry.d_max_mm = entry.d_mm[entry.widest];
      if (with_separable)
        entry.separable_row = static_cast<uint32_t>(i) * separable_kernel_rows_per_profile;
      if (other) {
        entry.radial_row = others * radial_rows_per_profile;
        entry.sap_table = sap_variant_count * shapes * (1 + 3 * others);
      }
    }
    others += other ? 1 : 0;
  }
  return table;
}

std::vector<RadialRow> make_radial_table(std::span<const NumberedProfile> profiles) {
  std::vector<RadialRow> table;
  for (const NumberedProfile& numbered : profiles)
    if (has_own_tables(numbered)) {
      const auto rows = make_radial_rows(numbered.profile.shape_mm, numbered.profile.widest);
      table.insert(table.end(), rows.begin(), rows.end());
    }
  if (table.empty()) table.emplace_back();
  return table;
}

std::vector<SeparableRow> make_separable_table(const NumberedProfile& numbered) {
  std::vector<SeparableRow> table;
  for (const auto& rows : {make_separable_rows(numbered.profile.shape_mm),
                           make_jimenez_rows(numbered.profile.shape_mm)})
    table.insert(table.end(), rows.begin(), rows.end());
  return table;
}

bool uses_separable(const Graph& graph, const PassTypeRegistry& pass_types) {
  return std::ranges::any_of(graph.passes, [&](const PassDeclaration& pass) {
    const std::string_view type = pass_types[pass.type].name;
    return type.starts_with("subsurface.separable") || type == "subsurface.probe";
  });
}

PyramidUse pyramid_use(const Graph& graph, const PassTypeRegistry& pass_types) {
  const auto has = [&](std::string_view type) {
    return std::ranges::any_of(graph.passes, [&](const PassDeclaration& pass) {
      return pass_types[pass.type].name == type;
    });
  };
  const bool surface = has("subsurface.sap_gather") || has("subsurface.sap_up") ||
                       has("subsurface.sap_gather_half") || has("subsurface.sap_coarse_up");
  return {surface, has("subsurface.pyramid_gather")};
}

std::vector<float> make_shared_sap_tables(PyramidUse use) {
  if (!use.surface && !use.plain) return {0.0f};
  std::vector<float> tables;
  for (const SapShape& pixel : sap_shapes(use.pixel_grid)) {
    const auto of_pixel =
        use.pixel_grid == 0 ? burley_sap_tables(use) : sap_tables_of(burley_shape(1), use, pixel);
    tables.insert(tables.end(), of_pixel.begin(), of_pixel.end());
  }
  return tables;
}

std::vector<float> make_own_sap_tables(PyramidUse use, const NumberedProfile& numbered) {
  std::vector<float> tables;
  if ((!use.surface && !use.plain) || !has_own_tables(numbered)) return tables;
  for (const SapShape& pixel : sap_shapes(use.pixel_grid)) {
    std::array<SapTables, 3> of_channel;
    for (size_t c = 0; c < 3; ++c)
      of_channel[c] = sap_tables_of(numbered.profile.shape_mm[c], use, pixel);
    for (uint32_t v = 0; v < sap_variant_count; ++v)
      for (const SapTables& channel : of_channel) {
        const auto one = std::span(channel).subspan(v * sap_table_floats, sap_table_floats);
        tables.insert(tables.end(), one.begin(), one.end());
      }
  }
  return tables;
}

} // namespace dermis::subsurface
