#include "passes/subsurface/environment.hpp"

#include "passes/subsurface/sap_weights.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

namespace {
constexpr double mm_per_metre = 1000.0;
constexpr uint32_t tile_pixels = 8;

int32_t tiles_of(uint32_t pixels) {
  return static_cast<int32_t>((pixels + tile_pixels - 1) / tile_pixels);
}
} // namespace

bool fill_frame_constants(const FrameInput& input, FrameConstants& out) {
  const auto rays = pixel_rays(input.clip_from_view, input.rect_width, input.rect_height,
                               input.metres_per_unit, input.jitter_px);
  if (!rays || !std::isfinite(input.exposure)) return false;
  // Rays are metres (per metre of depth when perspective, where the unit cancels).
  const double ray_unit = rays->perspective ? 1.0 : mm_per_metre;
  const DepthDecode decode = depth_decode(input.clip_from_view, input.metres_per_unit);
  out.rect[0] = static_cast<int32_t>(input.rect_x);
  out.rect[1] = static_cast<int32_t>(input.rect_y);
  out.rect[2] = static_cast<int32_t>(input.rect_width);
  out.rect[3] = static_cast<int32_t>(input.rect_height);
  out.tiles[0] = tiles_of(input.rect_width);
  out.tiles[1] = tiles_of(input.rect_height);
  out.frame_index = static_cast<uint32_t>(input.frame_index);
  out.flags = (rays->perspective ? 1u : 0u) | (input.depth_kind == DepthKind::view_units ? 2u : 0u) |
              (input.history_invalid ? 4u : 0u);
  out.ray_scale[0] = static_cast<float>(rays->scale_x * ray_unit);
  out.ray_scale[1] = static_cast<float>(rays->scale_y * ray_unit);
  out.ray_offset[0] = static_cast<float>(rays->offset_x * ray_unit);
  out.ray_offset[1] = static_cast<float>(rays->offset_y * ray_unit);
  out.depth_decode[0] = static_cast<float>(decode.a * mm_per_metre);
  out.depth_decode[1] = static_cast<float>(decode.b * mm_per_metre);
  out.depth_decode[2] = static_cast<float>(decode.c);
  out.depth_decode[3] = static_cast<float>(decode.e);
  out.depth_unit = static_cast<float>(input.metres_per_unit * mm_per_metre);
  out.exposure = input.exposure;
  out.jitter[0] = static_cast<float>(input.jitter_px[0]);
  out.jitter[1] = static_cast<float>(input.jitter_px[1]);
  return true;
}

std::vector<ProfileEntry> make_profile_table(std::span<const NumberedProfile> profiles, bool with_separable) {
  ProfileEntry none{};
  none.separable_row = no_separable_row;
  std::vector<ProfileEntry> table(profile_capacity, none);
  for (size_t i = 0; i < profiles.size(); ++i) {
    const NumberedProfile& numbered = profiles[i];
    if (numbered.id == 0 || numbered.id >= profile_capacity) continue;
    ProfileEntry& entry = table[numbered.id];
    entry.widest = static_cast<uint32_t>(numbered.profile.widest);
    for (size_t c = 0; c < 3; ++c)
      entry.d_mm[c] = static_cast<float>(numbered.profile.d_mm[c]);
    entry.d_max_mm = entry.d_mm[entry.widest];
    if (with_separable) entry.separable_row = static_cast<uint32_t>(i) * separable_rows_per_profile;
  }
  return table;
}

std::vector<SeparableRow> make_separable_table(std::span<const NumberedProfile> profiles) {
  std::vector<SeparableRow> table;
  for (const NumberedProfile& numbered : profiles) {
    const std::vector<SeparableRow> rows = make_separable_rows(numbered.profile.d_mm);
    table.insert(table.end(), rows.begin(), rows.end());
  }
  if (table.empty()) table.emplace_back();
  return table;
}

bool uses_separable(const Graph& graph, const KindRegistry& kinds) {
  const KindId separable = kinds.find("subsurface.separable");
  return std::any_of(graph.passes.begin(), graph.passes.end(),
                     [&](const PassDeclaration& pass) { return pass.kind == separable; });
}

bool uses_sap(const Graph& graph, const KindRegistry& kinds) {
  const KindId gather = kinds.find("subsurface.sap_gather"), up = kinds.find("subsurface.sap_up");
  return std::any_of(graph.passes.begin(), graph.passes.end(),
                     [&](const PassDeclaration& pass) { return pass.kind == gather || pass.kind == up; });
}

std::vector<float> make_sap_tables(bool used) {
  if (!used) return {0.0f};
  std::vector<float> tables = make_sap_table(fit_sap_weights(SapVariant::base));
  const std::vector<float> smooth = make_sap_table(fit_sap_weights(SapVariant::smooth));
  tables.insert(tables.end(), smooth.begin(), smooth.end());
  return tables;
}

} // namespace dermis::subsurface
