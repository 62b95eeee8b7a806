#include "passes/common/kernel_tables.hpp"

namespace dermis::subsurface {

TableUse table_use(const Graph& graph, const PassTypeRegistry& pass_types) {
  return {uses_separable(graph, pass_types), pyramid_use(graph, pass_types)};
}

KernelTables make_kernel_tables(const TableUse& use, std::span<const NumberedProfile> profiles) {
  const auto fitted = use.separable ? profiles : std::span<const NumberedProfile>();
  return {use, make_profile_table(profiles, use.separable, use.pyramid.pixel_grid),
          make_separable_table(fitted), make_sap_tables(use.pyramid, profiles),
          make_radial_table(profiles)};
}

} // namespace dermis::subsurface
