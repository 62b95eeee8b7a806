#include "passes/common/pass_types.hpp"

#include "passes/common/signatures/needs.hpp"
#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

PassTypeRegistry make_pass_types() {
  PassTypeRegistry registry;
  for (const PassType* type : {&classify_type,
                               &tile_list_type,
                               &setup_type,
                               &burley_type,
                               &separable_setup_type,
                               &separable_type,
                               &combine_type,
                               &export_scattered_type,
                               &sap_tiles_type,
                               &sap_setup_type,
                               &sap_down_type,
                               &sap_up_type,
                               &sap_gather_type,
                               &fixed_type,
                               &pyramid_setup_type,
                               &pyramid_down_type,
                               &pyramid_gather_type,
                               &transmission_type,
                               &afis_type,
                               &refine_type,
                               &residual_type,
                               &guided_type,
                               &classify_uniform_light_type,
                               &copy_tiles_type,
                               &tile_error_estimate_type,
                               &allocate_samples_type,
                               &tile_refine_type,
                               &accumulate_type,
                               &debug_tile_class_type,
                               &probe_type,
                               &clear_type,
                               &tile_variance_type,
                               &afis_tiles_type,
                               &afis_published_type,
                               &global_light_change_type,
                               &sap_setup_half_res_type,
                               &sap_gather_half_type,
                               &transmission_stats_type,
                               &restir_initial_type,
                               &restir_resolve_type,
                               &restir_temporal_type,
                               &restir_spatial_type,
                               &sample_demand_type,
                               &sap_coarse_down_type,
                               &sap_coarse_up_type,
                               &separable_tiles_type,
                               &blend_tiles_type,
                               &tile_change_type,
                               &tile_histogram_type,
                               &select_tiles_type,
                               &separable_selected_type,
                               &clear_tiles_type,
                               &combine_copies_type,
                               &sap_gather_probed_type}) {
    PassType known = *type;
    known.needs = needs_of(known.name);
    known.serves_scattering =
        type != &export_scattered_type && type != &transmission_type && type != &clear_type;
    registry.add(known);
  }
  return registry;
}

} // namespace dermis::subsurface
