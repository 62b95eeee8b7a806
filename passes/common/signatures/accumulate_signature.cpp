// Accumulation of light over frames, for hosts without their own temporal anti-aliasing.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Format past_formats[] = {Format::rgba16f};
constexpr Format place_formats[] = {Format::rg16f};
constexpr std::string_view past_doc =
    "scattered light minus the part that the nearest pixels explain, "
    "divided by the local mean; number of accumulated frames";
constexpr std::string_view place_doc =
    "view depth in metres, profile id; 0 where nothing was written";

constexpr Port ports[] = {
    port::lighting,
    port::albedo,
    port::sampled("scattered", "scattered light of this frame", port::color_formats),
    port::material,
    port::depth,
    port::scatter_scale,
    port::velocity,
    port::sampled("past", past_doc, past_formats),
    port::sampled("place", place_doc, place_formats),
    port::tiles,
    port::arguments,
    port::written("accumulated", "scattered light, accumulated over frames", port::color_formats),
    port::written("past_out", past_doc, past_formats),
    port::written_in_part("place_out", place_doc, place_formats),
};

constexpr PassTypeSetting settings[] = {
    setting::per_frame(setting::real("weight", 0.1, 0.001, 1, "", "minimum weight of a new frame")),
    setting::per_frame(setting::real(
        "clip", 1.5, 0, 64, "standard deviations",
        "largest distance of the history from the mean of the 3x3 neighbourhood; 0: no limit")),
    setting::per_frame(
        setting::real("disocclusion_frames", 0, 0, 64, "frames",
                      "number of frames of history from which on a pixel shows its own mean; with "
                      "less history, it shows more of the mean of the 3x3 neighbourhood; 0: off")),
    setting::texturing,
};

constexpr HistoryWeight accumulate_mixes[] = {{"past_out", "weight"}};

} // namespace

const PassType accumulate_type{
    .name = "subsurface.accumulate",
    .shader = "common/subsurface_accumulate",
    .doc = "Blends scattered light with that of earlier frames, reprojected along surfaces.",
    .ports = ports,
    .settings = settings,
    .dispatch = over_tiles,
    .mixes = accumulate_mixes,
};

} // namespace dermis::subsurface
