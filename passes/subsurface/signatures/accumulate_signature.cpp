// Light over frames, for hosts without anti-aliasing of their own.

#include "passes/subsurface/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Format past_formats[] = {Format::rgba32_uint};
constexpr std::string_view past_doc = "light, number of frames behind it, view depth, profile id";

constexpr Port ports[] = {
    {"scattered", Usage::sampled_image, false, "texture2D", "scattered light of this frame", {}},
    port::material,
    port::depth,
    port::velocity,
    port::classes_before,
    {"past", Usage::sampled_image, false, "utexture2D", past_doc, past_formats},
    port::tiles,
    port::arguments,
    {"accumulated", Usage::storage_image_write, false, "image2D", "scattered light over frames", {}},
    {"past_out", Usage::storage_image_write, false, "uimage2D", past_doc, past_formats},
};

constexpr KindSetting settings[] = {
    setting::real("weight", 0.1, 0.001, 1, "", "of a new frame, at least"),
    setting::real("clip", 1.5, 0, 64, "standard deviations",
                  "of the 3x3 pixels around, that history may lie from their mean; 0: as far as it likes"),
};

} // namespace

const PassKind accumulate_kind{
    .name = "subsurface.accumulate",
    .shader = "subsurface_accumulate",
    .doc = "Mixes scattered light with that of earlier frames, found again along surfaces.",
    .ports = ports,
    .settings = settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
