#include "framegraph/compile/written_size.hpp"

#include <algorithm>

namespace dermis {

TexelSize first_written_size(const Plan& plan, const PlanPass& pass, const PassType& type) {
  for (uint32_t port = 0; port < type.ports.size(); ++port)
    for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
      const PlanAccess& access = plan.accesses[a];
      const PlanResource& resource = plan.resources[access.resource];
      if (access.port == port && (access.access & access::shader_storage_write) != 0 &&
          resource.type == ResourceType::image)
        return {std::max(resource.width >> access.range.first_mip, 1u),
                std::max(resource.height >> access.range.first_mip, 1u)};
    }
  return {};
}

} // namespace dermis
