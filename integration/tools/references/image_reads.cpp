#include "integration/tools/references/image_reads.hpp"

#include "passes/common/pass_types.hpp"
#include "passes/sap/sap_weights.hpp"
#include "passes/separable/separable_kernel.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

namespace {

// The comment of each function lists the texels that it counts.

int64_t setting(const PassType& type, const ReadsInput& input, std::string_view name) {
  const int index = find_setting(type, name);
  return index < 0 ? 0 : input.settings[static_cast<size_t>(index)].integer;
}

// Returns 1 if the optional port is bound, else 0.
double one_if(const PassType& type, const ReadsInput& input, std::string_view port, PortSide side) {
  const int index = find_port(type, port, side);
  return index >= 0 && input.bound[static_cast<size_t>(index)] ? 1 : 0;
}

double scale_read(const PassType& type, const ReadsInput& input) {
  return one_if(type, input, "scatter_scale", PortSide::read);
}

// Reads per invocation if an 8x8 group reads `texels` once and shares them.
constexpr double shared_reads(double texels) {
  return texels / (8 * 8);
}

// share_patches in patch.glsl: material and depth of the group's pixels and a ring around them.
constexpr double patch_reads = shared_reads(10 * 10) * 2;

// Returns the largest value of a row of the pyramid's table over the channels.
double largest_fraction(const ReadsInput& input, int64_t variant, uint32_t row) {
  if (input.sap_tables.size() < sap_variant_count * sap_table_floats) return 1;
  const auto values =
      input.sap_tables.subspan(static_cast<size_t>(variant) * sap_table_floats, sap_table_floats);
  double largest = 0;
  for (const double d : input.d_px)
    largest = std::max(largest, sap_lookup<double>(values, row, d));
  return largest;
}

// Material; depth of subsurface pixels; light and its factors of scattering pixels if the light
// range is written.
ImageReads classify(const PassType& type, const ReadsInput& input) {
  const double ranged = one_if(type, input, "lighting", PortSide::read) *
                        one_if(type, input, "light_range", PortSide::write);
  const bool textured = setting(type, input, "texturing") != 0;
  const double light = 1 + (textured ? one_if(type, input, "albedo", PortSide::read) : 0);
  return {1 + input.subsurface_fraction * (1 + scale_read(type, input)) +
          input.scattering_fraction * ranged * light};
}

ImageReads none(const PassType&, const ReadsInput&) {
  return {};
}

// Lighting and its factors.
double light_reads(const PassType& type, const ReadsInput& input) {
  const bool textured = setting(type, input, "texturing") != 0;
  return 1 + scale_read(type, input) +
         (textured ? one_if(type, input, "albedo", PortSide::read) : 0);
}

// common/subsurface_setup.comp: light, patch.
ImageReads setup(const PassType& type, const ReadsInput& input) {
  return {light_reads(type, input) + patch_reads};
}

// Reads per invocation if an invocation computes a block of texels and reads each input once.
constexpr double block_reads(double texels, double width, double height) {
  return texels / (width * height);
}

// sap/subsurface_sap_setup.comp: light; material and depth of a 4x2 block and a ring without
// corners.
ImageReads sap_setup(const PassType& type, const ReadsInput& input) {
  return {light_reads(type, input) + 2 * block_reads(6 * 4 - 4, 4, 2)};
}

// Material, light, depth; per sample material, depth, light and slope.
ImageReads burley(const PassType& type, const ReadsInput& input) {
  const auto samples = static_cast<double>(setting(type, input, "samples"));
  return {3 + scale_read(type, input) + 4 * samples, samples};
}

// As burley; the direct radius needs no image.
ImageReads fixed(const PassType& type, const ReadsInput& input) {
  return burley(type, input);
}

// separable/subsurface_separable_setup.comp: material, light, depth.
ImageReads separable_setup(const PassType& type, const ReadsInput& input) {
  return {2 + light_reads(type, input)};
}

// Returns the pixels that taps beyond the window of a tile read: one or two on both sides.
double taps_beyond_window(uint32_t taps, bool fitted, const ReadsInput& input) {
  const double d_px = std::max({input.d_px[0], input.d_px[1], input.d_px[2]});
  double beyond = double(taps - 1) / 2;
  if (fitted) {
    double next = 1;
    for (const double offset : separable_offsets(d_px, taps))
      beyond -= offset == next++ ? 1 : 0;
  }
  return 2 * (fitted && taps >= separable_whole_taps ? 1 : 2) * beyond;
}

// Light and depth of the pixel, of 4 pixels of the window that the tile shares, and of the taps
// beyond that window. On the second axis also the pixel's light before the first axis.
ImageReads separable(const PassType& type, const ReadsInput& input) {
  const uint32_t taps = separable_taps[static_cast<size_t>(setting(type, input, "taps"))];
  const bool fitted = setting(type, input, "kernel") == 0;
  return {2 + scale_read(type, input) + one_if(type, input, "blurred", PortSide::read) +
          2 * (4 + taps_beyond_window(taps, fitted, input))};
}

// As separable, but light comes from the host's lighting and material. On the second axis only the
// pixel itself reads them; depth and velocity are read again to find the pixel in the previous
// frame.
ImageReads separable_selected(const PassType& type, const ReadsInput& input) {
  const uint32_t taps = separable_taps[static_cast<size_t>(setting(type, input, "taps"))];
  const double own = 1 + light_reads(type, input),
               blurred = one_if(type, input, "blurred", PortSide::read);
  const double tap = blurred > 0 ? 2 : 1 + own - scale_read(type, input);
  const double place = blurred > 0 ? 1 + one_if(type, input, "velocity", PortSide::read) : 0;
  return {own + 1 + blurred + place + tap * (4 + taps_beyond_window(taps, true, input))};
}

// common/subsurface_tile_change.comp: depth and velocity of a pixel, importance of every fourth
// pixel of the tile.
ImageReads tile_change(const PassType& type, const ReadsInput& input) {
  return {1 + one_if(type, input, "velocity", PortSide::read) +
          16 * one_if(type, input, "importance", PortSide::read)};
}

// sap/subsurface_sap_setup_half_res.comp: material, depth and light of the 4x4 pixels of 2x2
// texels.
ImageReads sap_setup_half_res(const PassType& type, const ReadsInput& input) {
  return {4 * (light_reads(type, input) + 2)};
}

// Inputs of a 4x2 pixel block; surface and scattered light of the level 1 texels below it.
ImageReads sap_gather_half(const PassType& type, const ReadsInput& input) {
  const double widest = std::max({input.d_px[0], input.d_px[1], input.d_px[2]});
  const double own = light_reads(type, input) + 2;
  return {widest < copy_below_d_px ? own : own + 2 * block_reads(4 * 3, 4, 2)};
}

// sap/subsurface_sap_down.comp: surface and light of the 6x6 children of 2x2 parents. Second layers
// are only read where they exist (here and below), so not on a surface that covers the view.
ImageReads sap_down(const PassType&, const ReadsInput&) {
  return {2 * block_reads(6 * 6, 2, 2)};
}

// sap_neighbours.glsl: surface and light of a block's texels, with a ring if the tent filter is on;
// surface and scattered light of the coarser level's texels below them.
ImageReads sap_up(const PassType& type, const ReadsInput& input) {
  const auto variant = static_cast<SapVariant>(setting(type, input, "variant"));
  const bool tent = setting(type, input, "level") <= int64_t{sap_last_tent(variant)};
  const bool last = one_if(type, input, "coarse_scattered", PortSide::read) == 0;
  return {2 * block_reads(tent ? 4 * 4 : 2 * 2, 2, 2) + (last ? 0 : 2 * block_reads(2 * 2, 2, 2))};
}

// Surface and light of the 18x18 children of the tiles of all levels from the first one on, per
// texel of the first level.
ImageReads sap_coarse_down(const PassType& type, const ReadsInput& input) {
  double texels = 0.0, per_texel = 1.0;
  for (int64_t level = setting(type, input, "level"); level < sap_level_count; ++level) {
    texels += per_texel * block_reads(18 * 18, 8, 8);
    per_texel /= 4;
  }
  return {2 * texels};
}

// sap_window.glsl: surface and light of a tile and of its window in every coarser level, each with
// a ring.
ImageReads sap_coarse_up(const PassType& type, const ReadsInput& input) {
  constexpr int with_ring[] = {10, 7, 6, 5};
  double texels = 0.0;
  size_t window = 0;
  for (int64_t level = setting(type, input, "level"); level < sap_level_count; ++level) {
    texels += with_ring[window] * with_ring[window];
    window = std::min(window + 1, std::size(with_ring) - 1);
  }
  return {2 * block_reads(texels, 8, 8)};
}

// Surface and light of the pixel and, if any pixel scatters beyond itself, of the texels around it
// and of level 1. If the step writes the host's images, also albedo and unscattered light.
ImageReads sap_gather(const PassType& type, const ReadsInput& input) {
  const double widest = std::max({input.d_px[0], input.d_px[1], input.d_px[2]});
  const double own = one_if(type, input, "lighting", PortSide::write) *
                         one_if(type, input, "albedo", PortSide::read) +
                     one_if(type, input, "scattered_light", PortSide::write) *
                         one_if(type, input, "unscattered", PortSide::read);
  return {own + (widest < copy_below_d_px
                     ? 2
                     : 2 * block_reads(6 * 4, 4, 2) + 2 * block_reads(4 * 3, 4, 2))};
}

// In each selected tile, like probe().
ImageReads sap_gather_probed(const PassType& type, const ReadsInput& input) {
  return {input.sampled_fraction * sap_gather(type, input).per_invocation};
}

// As fixed, plus one read of the mip levels per sample, or none if `mips` is none.
ImageReads afis(const PassType& type, const ReadsInput& input) {
  ImageReads reads = burley(type, input);
  constexpr double levels[] = {1, 1, 0}; // trilinear, nearest level, none
  reads.per_invocation += levels[setting(type, input, "mips")] * reads.samples;
  return reads;
}

// Material, own light and depth; per sample one filtered read.
ImageReads afis_published(const PassType& type, const ReadsInput& input) {
  const auto samples = static_cast<double>(setting(type, input, "samples"));
  return {2 + scale_read(type, input) + samples, samples};
}

// In tiles with samples, twice the number of the first step: material, depth, light of both
// techniques; samples as in afis.
ImageReads afis_tiles(const PassType& type, const ReadsInput& input) {
  ImageReads reads = afis(type, input);
  constexpr double steps = 2;
  const double each = reads.per_invocation - 3 - scale_read(type, input);
  reads.per_invocation = 4 + scale_read(type, input) + steps * each * input.sampled_fraction;
  reads.samples *= steps;
  return reads;
}

// Material and the light of both techniques.
ImageReads blend_tiles(const PassType&, const ReadsInput&) {
  return {3};
}

// Material, light, depth, slope; history at four positions; per sample as in afis. If the samples
// of tiles are limited, half of max_samples is assumed.
ImageReads guided(const PassType& type, const ReadsInput& input) {
  const bool limited = one_if(type, input, "samples_per_tile", PortSide::read) > 0;
  const double samples = input.sampled_fraction * (limited ? 0.5 : 1) *
                         static_cast<double>(setting(type, input, "max_samples"));
  const double kept = 1 + one_if(type, input, "place", PortSide::read) +
                      one_if(type, input, "control", PortSide::read);
  constexpr double levels[] = {1, 1, 0}; // trilinear, nearest level, none
  return {4 + scale_read(type, input) + one_if(type, input, "velocity", PortSide::read) + 4 * kept +
              (4 + levels[setting(type, input, "mips")]) * samples,
          samples};
}

// Light of the pixel. In pixels with low confidence also its surface and light at the pyramid's
// level 0, and for each sample the surface of the sampled pixel and surface and light of the level
// that the sample reads.
ImageReads refine(const PassType& type, const ReadsInput& input) {
  const double samples =
      input.sampled_fraction * static_cast<double>(setting(type, input, "samples"));
  return {1 + 2 * input.sampled_fraction + 3 * samples, samples};
}

// One pixel of 64: surface, light, velocity, and twice four history texels.
ImageReads global_light_change(const PassType& type, const ReadsInput& input) {
  return {(2 + one_if(type, input, "velocity", PortSide::read) + 4 * 2) / 64.0};
}

// As refine, plus velocity, four texels each of place, ratio and pattern history, and the global
// light change. Where samples count, also place and ratio of the eight pixels around.
ImageReads residual(const PassType& type, const ReadsInput& input) {
  ImageReads reads = refine(type, input);
  reads.per_invocation += 1 + one_if(type, input, "velocity", PortSide::read) + 4 * 3 + 1 +
                          input.sampled_fraction * 8 * 2;
  return reads;
}

// near_light.glsl: material, light, scattered light and depth of the group's pixels and a border of
// three without corners. Also scattered light of a pixel next to the group. Of the previous frame:
// one texel and its surface if the camera rests.
ImageReads accumulate(const PassType& type, const ReadsInput& input) {
  const double scale = scale_read(type, input);
  return {shared_reads(14 * 14 - 4) * (3 + light_reads(type, input) - scale) + 1 + 2 * scale +
          one_if(type, input, "velocity", PortSide::read) + 2};
}

// afis/subsurface_pyramid_setup.comp: material, light, and neighbouring materials if profiles are
// kept apart.
ImageReads pyramid_setup(const PassType& type, const ReadsInput& input) {
  const bool textured = setting(type, input, "texturing") != 0;
  return {2 + (textured ? one_if(type, input, "albedo", PortSide::read) : 0) +
          (setting(type, input, "profiles") != 0 ? 9 : 0)};
}

// Filtered reads: four, or one for a box filter.
ImageReads pyramid_down(const PassType& type, const ReadsInput& input) {
  return {setting(type, input, "halving") != 0 ? 1.0 : 4.0};
}

// Material, depth, own light, and four filtered reads per level with a relevant weight.
ImageReads pyramid_gather(const PassType& type, const ReadsInput& input) {
  constexpr double min_fraction = 0.001; // papers/subsurface_pyramid_gather.comp
  const auto variant = static_cast<int64_t>(SapVariant::plain);
  double reads = 3 + scale_read(type, input), left = 1;
  for (uint32_t level = 0; level < sap_level_count; ++level) {
    const double fraction = largest_fraction(input, variant, level + 1);
    if ((level == 0 ? fraction : left * fraction) >= min_fraction) reads += 4;
    if (level > 0) left *= 1 - fraction;
  }
  return {reads};
}

// Lighting, material, back light, thickness; albedo if lighting contains it.
ImageReads transmission(const PassType& type, const ReadsInput& input) {
  constexpr int64_t demodulate = 3; // of the setting `texturing`
  const bool divided = setting(type, input, "texturing") == demodulate;
  return {4 + scale_read(type, input) +
          (divided ? one_if(type, input, "albedo", PortSide::read) : 0)};
}

// Material, back light, thickness.
ImageReads transmission_stats(const PassType& type, const ReadsInput& input) {
  return {3 + scale_read(type, input)};
}

// Scattered light, albedo; material only in tiles with holes.
ImageReads combine(const PassType& type, const ReadsInput& input) {
  return {1 + one_if(type, input, "albedo", PortSide::read)};
}

// Lighting.
ImageReads copy_tiles(const PassType& type, const ReadsInput& input) {
  const bool textured = setting(type, input, "texturing") != 0;
  return {1 + (textured ? one_if(type, input, "albedo", PortSide::read) : 0)};
}

// Lighting, material, depth, scattered light.
ImageReads export_scattered(const PassType& type, const ReadsInput& input) {
  const bool textured = setting(type, input, "texturing") != 0;
  return {4 + scale_read(type, input) +
          (textured ? one_if(type, input, "albedo", PortSide::read) : 0)};
}

// Scattered light, material, importance.
ImageReads tile_error_estimate(const PassType& type, const ReadsInput& input) {
  return {2 + one_if(type, input, "importance", PortSide::read)};
}

// Material, depth and light of the pixel; material and light of a tap, whose filtered read of the
// mips is not counted; importance.
ImageReads tile_variance(const PassType& type, const ReadsInput& input) {
  return {5 + scale_read(type, input) + one_if(type, input, "importance", PortSide::read)};
}

// In tiles with 16 samples: light twice and surface of the pixel, and for each sample the surface
// of the sampled pixel and surface and light of the level that the sample reads.
ImageReads tile_refine(const PassType&, const ReadsInput& input) {
  constexpr double samples = 16;
  return {3 + 3 * samples * input.sampled_fraction, samples};
}

// Material.
ImageReads debug_tile_class(const PassType&, const ReadsInput&) {
  return {1};
}

// In four pixels of each selected tile: scattered light, and the light and patch of each pixel
// within 20 d. A group of 64 tiles selects at most one tile; `sampled_fraction` is the fraction of
// selected tiles.
ImageReads probe(const PassType& type, const ReadsInput& input) {
  const double widest = std::max({input.d_px[0], input.d_px[1], input.d_px[2]});
  const double side = 2 * std::ceil(20 * widest) + 1, pixels = 4.0 / 64;
  return {input.sampled_fraction * pixels * (light_reads(type, input) + 3 + side * side * 11)};
}

// Material, depth, normal of the pixel. Rays and hits are in buffers; paths count as samples, not
// as texels.
ImageReads restir_initial(const PassType& type, const ReadsInput& input) {
  return {3 + scale_read(type, input), static_cast<double>(setting(type, input, "samples"))};
}

// Inputs of the pixel, its depth and normal again, and velocity; the history is in buffers.
ImageReads restir_temporal(const PassType& type, const ReadsInput& input) {
  return {5 + scale_read(type, input) + one_if(type, input, "velocity", PortSide::read)};
}

// Inputs of the pixel and its depth again; per neighbour its material, then all its inputs.
ImageReads restir_spatial(const PassType& type, const ReadsInput& input) {
  const auto neighbours = static_cast<double>(setting(type, input, "neighbours"));
  return {4 + scale_read(type, input) + neighbours * (4 + scale_read(type, input))};
}

// Material, surface and light of the pixel.
ImageReads restir_resolve(const PassType& type, const ReadsInput& input) {
  const bool textured = setting(type, input, "texturing") != 0;
  return {5 + scale_read(type, input) +
          (textured ? 2 * one_if(type, input, "albedo", PortSide::read) : 0)};
}

struct Entry {
  std::string_view type;
  ImageReads (*reads)(const PassType&, const ReadsInput&);
};
constexpr Entry entries[] = {
    {"subsurface.classify", classify},
    {"subsurface.tile_list", none},
    {"subsurface.classify_uniform_light", none},
    {"subsurface.clear_tiles", none},
    {"subsurface.copy_tiles", copy_tiles},
    {"subsurface.debug_tile_class", debug_tile_class},
    {"subsurface.probe", probe},
    {"subsurface.setup", setup},
    {"subsurface.burley", burley},
    {"subsurface.separable", separable},
    {"subsurface.separable_setup", separable_setup},
    {"subsurface.separable_selected", separable_selected},
    {"subsurface.tile_change", tile_change},
    {"subsurface.tile_histogram", none},
    {"subsurface.select_tiles", none},
    {"subsurface.sap_tiles", none},
    {"subsurface.sap_setup", sap_setup},
    {"subsurface.sap_gather", sap_gather},
    {"subsurface.sap_gather_probed", sap_gather_probed},
    {"subsurface.sap_setup_half_res", sap_setup_half_res},
    {"subsurface.sap_gather_half", sap_gather_half},
    {"subsurface.sap_down", sap_down},
    {"subsurface.sap_up", sap_up},
    {"subsurface.sap_coarse_down", sap_coarse_down},
    {"subsurface.sap_coarse_up", sap_coarse_up},
    {"subsurface.combine", combine},
    {"subsurface.combine_copies", combine},
    {"subsurface.export_scattered", export_scattered},
    {"subsurface.fixed", fixed},
    {"subsurface.pyramid_setup", pyramid_setup},
    {"subsurface.pyramid_down", pyramid_down},
    {"subsurface.pyramid_gather", pyramid_gather},
    {"subsurface.transmission", transmission},
    {"subsurface.transmission_stats", transmission_stats},
    {"subsurface.afis", afis},
    {"subsurface.afis_published", afis_published},
    {"subsurface.guided", guided},
    {"subsurface.refine", refine},
    {"subsurface.global_light_change", global_light_change},
    {"subsurface.residual", residual},
    {"subsurface.accumulate", accumulate},
    {"subsurface.tile_error_estimate", tile_error_estimate},
    {"subsurface.sample_demand", none},
    {"subsurface.allocate_samples", none},
    {"subsurface.tile_refine", tile_refine},
    {"subsurface.tile_variance", tile_variance},
    {"subsurface.separable_tiles", none},
    {"subsurface.blend_tiles", blend_tiles},
    {"subsurface.afis_tiles", afis_tiles},
    {"clear", none},
    {"restir.initial", restir_initial},
    {"restir.resolve", restir_resolve},
    {"restir.temporal", restir_temporal},
    {"restir.spatial", restir_spatial},
};

} // namespace

std::optional<ImageReads> image_reads(const PassType& type, const ReadsInput& input) {
  for (const Entry& entry : entries)
    if (entry.type == type.name) return entry.reads(type, input);
  return std::nullopt;
}

std::vector<std::string_view> pass_types_with_known_reads() {
  std::vector<std::string_view> names;
  for (const Entry& entry : entries)
    names.push_back(entry.type);
  return names;
}

} // namespace dermis::subsurface
