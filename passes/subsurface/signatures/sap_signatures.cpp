// The surface-aware pyramid: one kind a step, one pass a level. Level 0 is the view, level l has a texel
// every 2^l pixels and a border of one texel, which takes what lies beyond the last pixels.

#include "passes/subsurface/sap/sap_weights.hpp"
#include "passes/subsurface/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view variant_options[] = {"base", "smooth"};

constexpr std::string_view light_doc = "rgb light, a = area of the surface over its cross-section, capped";
constexpr std::string_view surface_doc =
    "depth in mm (bits of a float); slope x, y (halves); factor on d, share of the texel's kernel that met "
    "its own surface (halves); profile id, 0 = nothing here";
constexpr std::string_view scattered_doc =
    "rgb scattered light of this level and coarser ones, a = confidence";
constexpr std::string_view mass_doc = "rgb share of the kernel that met the surface";

constexpr Format light_formats[] = {Format::rgba16f, Format::rgba32f};
constexpr Format surface_formats[] = {Format::rgba32_uint};

constexpr KindSetting level_setting(double first, std::string_view doc) {
  return {.name = "level",
          .type = SettingType::integer,
          .default_value = integer_value(static_cast<int64_t>(first)),
          .minimum = first,
          .maximum = sap_level_count - 1,
          .options = {},
          .unit = "",
          .doc = doc};
}

constexpr KindSetting variant =
    setting::choice("variant", variant_options,
                    "base: tent at level 0 alone; smooth: at every level, which hides the grid", 1);

constexpr Port setup_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear", {}},
    port::material,
    port::depth,
    port::scatter_scale,
    port::albedo,
    port::tiles,
    port::arguments,
    {"light", Usage::storage_image_write, false, "image2D", light_doc, light_formats},
    {"surface", Usage::storage_image_write, false, "uimage2D", surface_doc, surface_formats},
};
constexpr KindSetting setup_settings[] = {setting::texturing};

constexpr Port down_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "of the finer level", {}},
    {"surface", Usage::sampled_image, false, "utexture2D", "of the finer level", surface_formats},
    {"classes",
     Usage::storage_buffer_read,
     true,
     "uint",
     "as subsurface.classify writes them; bound where the finer level is 0, which holds listed tiles only",
     {}},
    {"coarse_light", Usage::storage_image_write, false, "image2D", light_doc, light_formats},
    {"coarse_surface", Usage::storage_image_write, false, "uimage2D", surface_doc, surface_formats},
};
constexpr KindSetting down_settings[] = {level_setting(1, "that is written")};

constexpr Port up_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "of this level", {}},
    {"surface", Usage::sampled_image, false, "utexture2D", "of this level", surface_formats},
    {"coarse_surface", Usage::sampled_image, true, "utexture2D", "of the coarser level; unbound at the last",
     surface_formats},
    {"coarse_scattered",
     Usage::sampled_image,
     true,
     "texture2D",
     "of the coarser level; unbound at the last",
     {}},
    {"coarse_mass", Usage::sampled_image, true, "texture2D", "of the coarser level; unbound at the last", {}},
    {"scattered", Usage::storage_image_write, false, "image2D", scattered_doc, light_formats},
    {"mass", Usage::storage_image_write, false, "image2D", mass_doc, light_formats},
};
constexpr KindSetting up_settings[] = {level_setting(1, "that is written"), variant};

constexpr Port gather_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "of level 0", {}},
    {"surface", Usage::sampled_image, false, "utexture2D", "of level 0", surface_formats},
    {"coarse_surface", Usage::sampled_image, false, "utexture2D", "of level 1", surface_formats},
    {"coarse_scattered", Usage::sampled_image, false, "texture2D", "of level 1", {}},
    {"coarse_mass", Usage::sampled_image, false, "texture2D", "of level 1", {}},
    {"classes", Usage::storage_buffer_read, false, "uint", "as subsurface.classify writes them", {}},
    port::tiles,
    port::arguments,
    {"scattered", Usage::storage_image_write, false, "image2D",
     "rgb scattered light where there is subsurface, undefined elsewhere; a = confidence", light_formats},
};
constexpr KindSetting gather_settings[] = {variant};

} // namespace

const PassKind sap_setup_kind{
    .name = "subsurface.sap_setup",
    .shader = "subsurface_sap_setup",
    .doc = "Level 0 of the surface-aware pyramid: light and surface of every pixel of listed tiles.",
    .ports = setup_ports,
    .settings = setup_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

const PassKind sap_down_kind{
    .name = "subsurface.sap_down",
    .shader = "subsurface_sap_down",
    .doc = "Reduces one level of the pyramid along the surface; stops at depth steps and other profiles.",
    .ports = down_ports,
    .settings = down_settings,
    .dispatch = DispatchShape::over_written,
    .side_effects = false,
};

const PassKind sap_up_kind{
    .name = "subsurface.sap_up",
    .shader = "subsurface_sap_up",
    .doc = "Blends one level of the pyramid with what comes from the coarser ones.",
    .ports = up_ports,
    .settings = up_settings,
    .dispatch = DispatchShape::over_written,
    .side_effects = false,
};

const PassKind sap_gather_kind{
    .name = "subsurface.sap_gather",
    .shader = "subsurface_sap_gather",
    .doc = "Level 0 of the way up: the scattered light of every listed pixel.",
    .ports = gather_ports,
    .settings = gather_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
