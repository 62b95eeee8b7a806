#pragma once
// One signature per kernel; pass_types.cpp lists them. Grouped by purpose: tiles, light in and out,
// scattering. The comment above a declaration names its file.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/ports.hpp"
#include "passes/common/signatures/settings.hpp"

namespace dermis::subsurface {

// tile_signatures.cpp
extern const PassType classify_type, classify_uniform_light_type, tile_list_type,
    debug_tile_class_type;
// selection_signatures.cpp
extern const PassType tile_change_type, tile_histogram_type, select_tiles_type;
// light_signatures.cpp
extern const PassType setup_type, combine_type, combine_copies_type, export_scattered_type,
    copy_tiles_type, transmission_type, transmission_stats_type;
// burley/burley_signature.cpp
extern const PassType burley_type;
// separable/separable_signature.cpp
extern const PassType separable_setup_type, separable_type, separable_tiles_type,
    separable_selected_type;
// papers/fixed_signature.cpp
extern const PassType fixed_type;
// afis/afis_signatures.cpp
extern const PassType afis_type, guided_type, afis_tiles_type, afis_published_type,
    blend_tiles_type;
// afis/pyramid_signatures.cpp
extern const PassType pyramid_setup_type, pyramid_down_type;
// papers/pyramid_gather_signature.cpp
extern const PassType pyramid_gather_type;
// sap/sap_signatures.cpp
extern const PassType sap_tiles_type, sap_setup_type, sap_down_type, sap_up_type, sap_gather_type,
    sap_gather_probed_type, sap_setup_half_res_type, sap_gather_half_type, sap_coarse_down_type,
    sap_coarse_up_type;
// papers/residual_signatures.cpp
extern const PassType refine_type, global_light_change_type, residual_type;
// sap/sample_signatures.cpp
extern const PassType tile_error_estimate_type, sample_demand_type, allocate_samples_type,
    tile_refine_type;
// papers/tile_variance_signature.cpp
extern const PassType tile_variance_type;
// probe_signature.cpp
extern const PassType probe_type;
// accumulate_signature.cpp
extern const PassType accumulate_type;
// clear_signature.cpp
extern const PassType clear_type, clear_tiles_type;
// restir/restir_signatures.cpp
extern const PassType restir_initial_type, restir_temporal_type, restir_spatial_type,
    restir_resolve_type;

} // namespace dermis::subsurface
