#include "passes/common/kinds.hpp"

#include "passes/common/signatures/needs.hpp"
#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

KindRegistry make_kinds() {
  KindRegistry registry;
  for (const PassKind* kind : {&classify_kind,
                               &tile_list_kind,
                               &setup_kind,
                               &burley_kind,
                               &separable_kind,
                               &combine_kind,
                               &light_kind,
                               &sap_tiles_kind,
                               &sap_setup_kind,
                               &sap_down_kind,
                               &sap_up_kind,
                               &sap_gather_kind,
                               &fixed_kind,
                               &pyramid_setup_kind,
                               &pyramid_down_kind,
                               &pyramid_gather_kind,
                               &transmission_kind,
                               &afis_kind,
                               &blend_kind,
                               &residual_kind,
                               &guided_kind,
                               &flat_kind,
                               &copy_kind,
                               &doubt_kind,
                               &allot_kind,
                               &mend_kind,
                               &accumulate_kind,
                               &skips_kind,
                               &probe_kind,
                               &clear_kind,
                               &contrast_kind,
                               &afis_tiles_kind,
                               &sap_down_layered_kind,
                               &sap_up_layered_kind,
                               &sap_gather_layered_kind,
                               &brightness_kind,
                               &sap_halve_kind,
                               &sap_gather_half_kind,
                               &thin_parts_kind,
                               &restir_initial_kind,
                               &restir_resolve_kind,
                               &restir_temporal_kind,
                               &restir_spatial_kind}) {
    PassKind known = *kind;
    known.needs = needs_of(known.name);
    known.serves_scattering = kind != &light_kind && kind != &transmission_kind && kind != &clear_kind;
    registry.add(known);
  }
  return registry;
}

} // namespace dermis::subsurface
