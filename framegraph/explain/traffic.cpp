#include "framegraph/explain/traffic.hpp"

#include <algorithm>

namespace dermis {
namespace {

double texels_of(const PlanResource& resource, const SubresourceRange& range) {
  double texels = 0.0;
  for (uint32_t mip = range.first_mip; mip < uint32_t{range.first_mip} + range.mips; ++mip)
    texels += 1.0 * std::max(resource.width >> mip, 1u) * std::max(resource.height >> mip, 1u);
  return texels * range.layers;
}

class PassCounter {
public:
  PassCounter(const Plan& plan, const PassTypeRegistry& pass_types,
              const TrafficAssumptions& assumptions)
      : plan_(plan), pass_types_(pass_types), assumptions_(assumptions),
        view_pixels_(1.0 * plan.view_width * plan.view_height) {}

  PassTraffic count(const PlanPass& pass) const {
    PassTraffic traffic;
    const PassType& type = pass_types_[pass.type];
    if (type.dispatch.domain == DispatchRule::Domain::host) return traffic;
    const double written_area = written_texels(pass) / view_pixels_;
    for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
      const PlanAccess& access = plan_.accesses[a];
      const Port& port = type.ports[access.port];
      if (access.when == ReadWhen::history_invalid || port.usage == Usage::indirect_arguments)
        continue;
      const double bytes = bytes_of(port, access, written_area) * fraction(type, port, access) /
                           (assumptions_.covered * view_pixels_);
      if (usage_info(port.usage).reads) traffic.read += bytes;
      if (usage_info(port.usage).writes) traffic.written += bytes;
    }
    return traffic;
  }

private:
  // Returns the texels of the largest image that the pass writes; those of the view if there is
  // none.
  double written_texels(const PlanPass& pass) const {
    double largest = 0.0;
    for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
      const PlanAccess& access = plan_.accesses[a];
      const PlanResource& resource = plan_.resources[access.resource];
      if (resource.type == ResourceType::image && (access.access & all_write_access) != 0)
        largest = std::max(largest, texels_of(resource, access.range));
    }
    return largest > 0.0 ? largest : view_pixels_;
  }

  double bytes_of(const Port& port, const PlanAccess& access, double written_area) const {
    const PlanResource& resource = plan_.resources[access.resource];
    switch (resource.type) {
    case ResourceType::image:
      return texels_of(resource, access.range) * format_info(resource.format).bytes_per_texel;
    case ResourceType::buffer:
      return port.bytes_per_tile > 0 ? port.bytes_per_tile * written_area * view_pixels_ / 64.0
                                     : static_cast<double>(resource.bytes) * written_area;
    case ResourceType::acceleration_structure:
      break;
    }
    return 0.0;
  }

  // Returns the fraction of the resource that the pass accesses at the port.
  double fraction(const PassType& type, const Port& port, const PlanAccess& access) const {
    if (port.extent == AccessExtent::few) return 0;
    const bool listed = type.dispatch.domain == DispatchRule::Domain::indirect;
    const double covered =
        listed || port.extent != AccessExtent::dispatched ? assumptions_.covered : 1.0;
    if (port.extent != AccessExtent::flagged) return covered;
    const bool fine = 4 * texels_of(plan_.resources[access.resource], access.range) >= view_pixels_;
    return covered * (fine ? assumptions_.flagged_fine : assumptions_.flagged);
  }

  const Plan& plan_;
  const PassTypeRegistry& pass_types_;
  const TrafficAssumptions& assumptions_;
  double view_pixels_;
};

} // namespace

std::vector<PassTraffic> count_traffic(const Plan& plan, const PassTypeRegistry& pass_types,
                                       const TrafficAssumptions& assumptions) {
  const PassCounter counter(plan, pass_types, assumptions);
  std::vector<PassTraffic> traffic;
  for (const PlanPass& pass : plan.passes)
    traffic.push_back(counter.count(pass));
  return traffic;
}

} // namespace dermis
