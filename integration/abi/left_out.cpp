#include "integration/abi/left_out.hpp"

#include <algorithm>
#include <span>

namespace dermis::abi {
namespace {

bool is_off(const PassDeclaration& pass) {
  return pass.absence != PassDeclaration::Absence::none;
}

// By resource: can it be read? Imported, written by a pass that is not turned off, or replaced by what can.
// Ports that update need contents themselves.
std::vector<uint8_t> provided_resources(const Graph& graph, const KindRegistry& kinds) {
  std::vector<uint8_t> provided;
  for (const ResourceDeclaration& resource : graph.resources)
    provided.push_back(resource.origin == Origin::imported ? 1 : 0);
  for (const PassDeclaration& pass : graph.passes)
    for (const PortBinding& binding : graph.writes(pass))
      if (!is_off(pass) && !usage_info(kinds[pass.kind].ports[binding.port].usage).reads)
        provided[binding.resource.value] = 1;
  for (bool again = true; again;) {
    again = false;
    for (const PassDeclaration& pass : graph.passes)
      for (const PassThrough& through : pass.otherwise) {
        if (!is_off(pass) || provided[through.output.value] != 0 || provided[through.instead.value] == 0)
          continue;
        provided[through.output.value] = 1;
        again = true;
      }
  }
  return provided;
}

bool turned_off_writer(const Graph& graph, ResourceId resource) {
  return std::any_of(graph.passes.begin(), graph.passes.end(), [&](const PassDeclaration& pass) {
    const auto writes = graph.writes(pass);
    return is_off(pass) && std::any_of(writes.begin(), writes.end(), [&](const PortBinding& binding) {
             return binding.resource == resource;
           });
  });
}

// A resource that the pass has to read and that only passes which are turned off write; or none.
ResourceId missing_input(const Graph& graph, const std::vector<uint8_t>& provided, const PassKind& kind,
                         const PassDeclaration& pass) {
  for (const PortBinding& binding : graph.bindings_of(pass)) {
    const Port& port = kind.ports[binding.port];
    if (port.optional || !usage_info(port.usage).reads || binding.when != ReadWhen::always) continue;
    if (provided[binding.resource.value] == 0 && turned_off_writer(graph, binding.resource))
      return binding.resource;
  }
  return {};
}

constexpr uint32_t bit_of_port(uint32_t port) {
  return uint32_t{1} << port;
}

struct EmptyFrame {
  const Plan& plan;
  const KindRegistry& kinds;
  LeftOut out;
  std::vector<uint32_t> missing; // by plan pass: resource that it lacks, into Plan::resources; or nothing

  static constexpr uint32_t nothing = 0xffffffffu;

  std::span<const PlanAccess> accesses_of(size_t p) const {
    return std::span(plan.accesses).subspan(plan.passes[p].first_access, plan.passes[p].access_count);
  }

  // In the order of the plan: what has been written by then. True: another pass of the host lacks an input.
  bool follow_contents() {
    std::vector<uint8_t> filled(plan.resources.size(), 0);
    for (size_t r = 0; r < plan.resources.size(); ++r)
      filled[r] = plan.resources[r].origin == Origin::imported;
    bool changed = false;
    for (size_t p = 0; p < plan.passes.size(); ++p) {
      if (out.passes[p] != 0) continue;
      const PassKind& kind = kinds[plan.passes[p].kind];
      for (const PlanAccess& access : accesses_of(p)) {
        const bool reads = (access.access & ~all_write_access) != 0 && access.frames_back == 0;
        if (!reads || filled[access.resource] != 0 || kind.dispatch != DispatchShape::host) continue;
        if (kind.ports[access.port].optional) {
          out.unbound_ports[p] |= bit_of_port(access.port);
          continue;
        }
        out.passes[p] = 1;
        missing[p] = access.resource;
        changed = true;
        break;
      }
      for (const PlanAccess& access : accesses_of(p))
        if (out.passes[p] == 0 && (access.access & all_write_access) != 0) filled[access.resource] = 1;
    }
    return changed;
  }

  void leave_out_what_nobody_needs() {
    std::vector<uint8_t> wanted(plan.resources.size(), 0), needed(plan.passes.size(), 0);
    for (size_t r = 0; r < plan.resources.size(); ++r)
      wanted[r] = plan.resources[r].slot >= 0;
    for (bool again = true; again;) { // histories are wanted by passes before their writers, too
      again = false;
      for (size_t p = plan.passes.size(); p-- > 0;) {
        if (out.passes[p] != 0 || needed[p] != 0) continue;
        const auto accesses = accesses_of(p);
        const bool writes_wanted =
            std::any_of(accesses.begin(), accesses.end(), [&](const PlanAccess& access) {
              return (access.access & all_write_access) != 0 && wanted[access.resource] != 0;
            });
        if (!writes_wanted && !kinds[plan.passes[p].kind].side_effects) continue;
        needed[p] = 1;
        again = true;
        for (const PlanAccess& access : accesses)
          wanted[access.resource] = 1;
      }
    }
    for (size_t p = 0; p < plan.passes.size(); ++p)
      out.passes[p] = needed[p] == 0;
  }
};

} // namespace

void turn_scattering_off(Graph& graph, const KindRegistry& kinds) {
  Expression never;
  never.op = Expression::Op::literal;
  never.literal = {SettingType::boolean, 0, 0.0};
  const ExpressionId id{static_cast<uint32_t>(graph.expressions.size())};
  graph.expressions.push_back(never);
  for (PassDeclaration& pass : graph.passes)
    if (kinds[pass.kind].serves_scattering) {
      pass.when = id;
      pass.absence = PassDeclaration::Absence::no_profile;
    }
  for (bool again = true; again;) { // what lacks its input leaves others without theirs
    again = false;
    const std::vector<uint8_t> provided = provided_resources(graph, kinds);
    for (PassDeclaration& pass : graph.passes) {
      if (is_off(pass)) continue;
      const ResourceId missing = missing_input(graph, provided, kinds[pass.kind], pass);
      if (!missing.valid()) continue;
      pass.when = id;
      pass.absence = PassDeclaration::Absence::no_input;
      pass.missing = missing;
      again = true;
    }
  }
}

LeftOut left_out_without_bounds(const KindRegistry& kinds, CompiledPlan& compiled) {
  const Plan& plan = compiled.plan;
  EmptyFrame frame{plan, kinds, {}, std::vector<uint32_t>(plan.passes.size(), EmptyFrame::nothing)};
  frame.out.unbound_ports.assign(plan.passes.size(), 0);
  for (const PlanPass& pass : plan.passes)
    frame.out.passes.push_back(kinds[pass.kind].serves_scattering ? 1 : 0);
  while (frame.follow_contents()) {
  }
  frame.leave_out_what_nobody_needs();
  for (size_t p = 0; p < plan.passes.size(); ++p)
    if (frame.missing[p] != EmptyFrame::nothing)
      compiled.reasons.push_back({Reason::About::pass, Reason::Why::lacks_input_without_bounds,
                                  plan.passes[p].declared.value,
                                  plan.resources[frame.missing[p]].declared.value, 0, 0});
  return std::move(frame.out);
}

} // namespace dermis::abi
