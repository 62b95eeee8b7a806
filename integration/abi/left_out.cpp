#include "integration/abi/left_out.hpp"

#include "framegraph/text/limits.hpp"

#include <algorithm>
#include <span>

namespace dermis::abi {
namespace {

bool is_off(const PassDeclaration& pass) {
  return pass.absence != PassDeclaration::Absence::none;
}

// A set of subresources of a graph or plan. A buffer is one subresource.
class Subresources {
public:
  explicit Subresources(size_t resources) : ranges_(resources) {}

  void add(uint32_t resource, const SubresourceRange& range) { ranges_[resource].push_back(range); }

  bool has(uint32_t resource, const SubresourceRange& range) const {
    for (uint32_t mip = range.first_mip; mip < uint32_t{range.first_mip} + range.mips; ++mip)
      for (uint32_t layer = range.first_layer;
           layer < uint32_t{range.first_layer} + range.layers;) {
        const uint32_t next = end_of_known(resource, mip, layer);
        if (next == layer) return false;
        layer = next;
      }
    return true;
  }

private:
  // Returns the first unknown layer at or after `layer`; `layer` itself if it is unknown.
  uint32_t end_of_known(uint32_t resource, uint32_t mip, uint32_t layer) const {
    for (const SubresourceRange& known : ranges_[resource]) {
      const uint32_t end = uint32_t{known.first_layer} + known.layers;
      if (mip >= known.first_mip && mip < uint32_t{known.first_mip} + known.mips &&
          layer >= known.first_layer && layer < end)
        return end;
    }
    return layer;
  }

  std::vector<std::vector<SubresourceRange>> ranges_; // by resource
};

SubresourceRange declared_range(const ResourceDeclaration& resource,
                                const ImageRange& image_range) {
  const uint32_t mips = resource.mips == 0 ? limits::image_mips : resource.mips;
  SubresourceRange range;
  range.first_mip = image_range.first_mip;
  range.mips = image_range.mips == 0
                   ? static_cast<uint16_t>(mips - std::min<uint32_t>(mips, image_range.first_mip))
                   : image_range.mips;
  range.first_layer = image_range.first_layer;
  range.layers =
      image_range.layers == 0
          ? static_cast<uint16_t>(resource.layers -
                                  std::min<uint32_t>(resource.layers, image_range.first_layer))
          : image_range.layers;
  return range;
}

// Returns the readable subresources: imported, written by a pass that is on, or replaced by a
// readable resource. Update ports do not count as writes, because they need earlier contents.
Subresources provided_subresources(const Graph& graph, const PassTypeRegistry& pass_types) {
  Subresources provided(graph.resources.size());
  for (uint32_t r = 0; r < graph.resources.size(); ++r)
    if (graph.resources[r].origin == Origin::imported)
      provided.add(r, declared_range(graph.resources[r], {}));
  for (const PassDeclaration& pass : graph.passes)
    for (const PortBinding& binding : graph.writes(pass))
      if (!is_off(pass) && !usage_info(pass_types[pass.type].ports[binding.port].usage).reads)
        provided.add(binding.resource.value,
                     declared_range(graph.resources[binding.resource.value], binding.range));
  for (bool again = true; again;) {
    again = false;
    for (const PassDeclaration& pass : graph.passes)
      for (const PassThrough& through : pass.otherwise) {
        const SubresourceRange output = declared_range(graph.resources[through.output.value], {}),
                               instead = declared_range(graph.resources[through.instead.value], {});
        if (!is_off(pass) || provided.has(through.output.value, output) ||
            !provided.has(through.instead.value, instead))
          continue;
        provided.add(through.output.value, output);
        again = true;
      }
  }
  return provided;
}

bool turned_off_writer(const Graph& graph, ResourceId resource) {
  return std::any_of(graph.passes.begin(), graph.passes.end(), [&](const PassDeclaration& pass) {
    const auto writes = graph.writes(pass);
    return is_off(pass) &&
           std::any_of(writes.begin(), writes.end(),
                       [&](const PortBinding& binding) { return binding.resource == resource; });
  });
}

// Returns a resource that the pass must read but that only passes that are off write; invalid if
// there is none.
ResourceId missing_input(const Graph& graph, const Subresources& provided, const PassType& type,
                         const PassDeclaration& pass) {
  for (const PortBinding& binding : graph.bindings_of(pass)) {
    const Port& port = type.ports[binding.port];
    if (port.optional || !usage_info(port.usage).reads || binding.when != ReadWhen::always)
      continue;
    const SubresourceRange range =
        declared_range(graph.resources[binding.resource.value], binding.range);
    if (!provided.has(binding.resource.value, range) && turned_off_writer(graph, binding.resource))
      return binding.resource;
  }
  return {};
}

std::span<const PlanAccess> accesses_of(const Plan& plan, size_t pass) {
  return std::span(plan.accesses)
      .subspan(plan.passes[pass].first_access, plan.passes[pass].access_count);
}

bool writes_needed(const Plan& plan, size_t pass, const std::vector<uint8_t>& needed) {
  const auto accesses = accesses_of(plan, pass);
  return std::any_of(accesses.begin(), accesses.end(), [&](const PlanAccess& access) {
    return (access.access & all_write_access) != 0 && needed[access.resource] != 0;
  });
}

} // namespace

void turn_scattering_off(Graph& graph, const PassTypeRegistry& pass_types) {
  Expression never;
  never.op = Expression::Op::literal;
  never.literal = {SettingType::boolean, 0, 0.0};
  const ExpressionId id{static_cast<uint32_t>(graph.expressions.size())};
  graph.expressions.push_back(never);
  for (PassDeclaration& pass : graph.passes)
    if (pass_types[pass.type].serves_scattering) {
      pass.when = id;
      pass.absence = PassDeclaration::Absence::no_profile;
    }
  for (bool again = true; again;) { // turning a pass off may leave further passes without input
    again = false;
    const Subresources provided = provided_subresources(graph, pass_types);
    for (PassDeclaration& pass : graph.passes) {
      if (is_off(pass)) continue;
      const ResourceId missing = missing_input(graph, provided, pass_types[pass.type], pass);
      if (!missing.valid()) continue;
      pass.when = id;
      pass.absence = PassDeclaration::Absence::no_input;
      pass.missing = missing;
      again = true;
    }
  }
}

std::vector<uint8_t> left_out_without_bounds(const PassTypeRegistry& pass_types, const Plan& plan) {
  std::vector<uint8_t> left_out(plan.passes.size(), 1), needed(plan.resources.size(), 0);
  for (size_t r = 0; r < plan.resources.size(); ++r)
    needed[r] = plan.resources[r].slot >= 0;
  for (bool again = true; again;) { // passes that feed the writers of a history are needed too
    again = false;
    for (size_t p = plan.passes.size(); p-- > 0;) {
      const PassType& type = pass_types[plan.passes[p].type];
      if (left_out[p] == 0 || type.serves_scattering) continue;
      if (!type.side_effects && !writes_needed(plan, p, needed)) continue;
      left_out[p] = 0;
      again = true;
      for (const PlanAccess& access : accesses_of(plan, p))
        needed[access.resource] = 1;
    }
  }
  return left_out;
}

bool reads_what_is_left_out(const Graph& graph, const PassTypeRegistry& pass_types,
                            const Plan& plan) {
  Subresources written(plan.resources.size());
  std::vector<uint8_t> replaced(graph.resources.size(), 0); // by `otherwise` of a left-out pass
  for (uint32_t r = 0; r < plan.resources.size(); ++r)
    if (plan.resources[r].origin == Origin::imported) written.add(r, plan.resources[r].whole());
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    if (pass_types[plan.passes[p].type].serves_scattering) {
      for (const PassThrough& through : graph.passes[plan.passes[p].declared.value].otherwise)
        replaced[through.output.value] = 1;
      continue;
    }
    for (const PlanAccess& access : accesses_of(plan, p))
      if ((access.access & ~all_write_access) != 0 && access.frames_back == 0 &&
          (!written.has(access.resource, access.range) ||
           replaced[plan.resources[access.resource].declared.value] != 0))
        return true;
    for (const PlanAccess& access : accesses_of(plan, p))
      if ((access.access & all_write_access) != 0) written.add(access.resource, access.range);
  }
  return false;
}

void explain_lacking_inputs(const Graph& without_scattering, CompiledPlan& compiled) {
  for (const PlanPass& pass : compiled.plan.passes) {
    const PassDeclaration& declared = without_scattering.passes[pass.declared.value];
    if (declared.absence == PassDeclaration::Absence::no_input)
      compiled.reasons.push_back({Reason::About::pass,
                                  Reason::ReasonKind::lacks_input_without_bounds,
                                  pass.declared.value, declared.missing.value, 0, 0});
  }
}

} // namespace dermis::abi
