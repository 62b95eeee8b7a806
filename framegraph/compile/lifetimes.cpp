// From which pass to which each resource is alive, how it is used, and the settings each pass runs with.

#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis {
namespace {

constexpr uint32_t threads_per_side = 8;    // kernels run 8x8 groups, one per tile
constexpr uint32_t tiles_per_group = 64;    // DispatchShape::over_tile_grid
constexpr uint32_t push_constant_bytes = 4; // the port mask, and each setting

void mark(Lifetime& life, uint32_t position, const Use& use) {
  if (!life.used) life.first = position;
  life.used = true;
  life.last = position;
  life.vk_usage |= usage_info(use.usage).vk_usage;
  life.deepest_read = std::max(life.deepest_read, use.frames_back);
}

void add_settings(CompileContext& c, PassId pass, PlanPass& planned) {
  const PassDeclaration& declared = c.graph.passes[pass.value];
  const PassKind& kind = c.kind(pass);
  planned.first_setting = static_cast<uint32_t>(c.out.plan.settings.size());
  for (uint32_t s = 0; s < kind.settings.size(); ++s) {
    PlanSetting setting;
    setting.value = kind.settings[s].default_value;
    for (const SettingBinding& binding : declared.settings) {
      if (binding.setting != s) continue;
      setting.from = binding.from;
      setting.value = binding.from.valid() ? c.settings[binding.from.value] : binding.literal;
    }
    c.out.plan.settings.push_back(setting);
  }
}

void check_limits(CompileContext& c, PassId pass) {
  const PassKind& kind = c.kind(pass);
  const auto refuse = [&](const std::string& text) {
    c.diagnostics.add(DiagnosticId::device_limit, c.graph.passes[pass.value].where,
                      fmt::format("pass '{}' {} (device '{}')", c.name(pass), text, c.device.name));
  };
  const uint64_t push_bytes = push_constant_bytes * (1 + uint64_t{kind.settings.size()});
  if (push_bytes > c.device.max_push_constants_bytes)
    refuse(fmt::format("needs {} bytes of push constants; the limit is {}", push_bytes,
                       c.device.max_push_constants_bytes));
  const auto tiles = [](uint32_t side) { return (uint64_t{side} + threads_per_side - 1) / threads_per_side; };
  const uint64_t across = tiles(c.input.view_width), down = tiles(c.input.view_height);
  uint64_t groups = 1;
  if (kind.dispatch == DispatchShape::over_view) groups = std::max(across, down);
  if (kind.dispatch == DispatchShape::over_tile_grid)
    groups = (across * down + tiles_per_group - 1) / tiles_per_group;
  if (groups > c.device.max_workgroup_count)
    refuse(fmt::format("dispatches {} groups in one dimension; the limit is {}", groups,
                       c.device.max_workgroup_count));
}

} // namespace

void lifetimes(CompileContext& c) {
  c.lifetimes.assign(c.graph.resources.size(), {});
  for (uint32_t position = 0; position < c.order.size(); ++position) {
    const PassId pass = c.order[position];
    PlanPass planned;
    planned.declared = pass;
    planned.kind = c.graph.passes[pass.value].kind;
    add_settings(c, pass, planned);
    c.out.plan.passes.push_back(planned);
    check_limits(c, pass);
    for (uint32_t u = c.first_use[pass.value]; u < c.first_use[pass.value + 1]; ++u)
      if (c.uses[u].trouble == Use::Trouble::none)
        mark(c.lifetimes[c.uses[u].resource.value], position, c.uses[u]);
  }
  for (uint32_t i = 0; i < c.graph.resources.size(); ++i) {
    const ResourceDeclaration& declared = c.graph.resources[i];
    const Lifetime& life = c.lifetimes[i];
    if (declared.history.frames == 0) continue;
    if (!life.used)
      c.because(Reason::About::resource, i, "no memory: no pass that runs uses it");
    else if (life.deepest_read == 0)
      c.because(Reason::About::resource, i,
                "kept like a transient: no pass that runs reads its earlier frames");
    else {
      c.lifetimes[i].vk_usage |= usage_info(Usage::clear).vk_usage; // instances start from zero
      c.because(Reason::About::resource, i,
                fmt::format("{} instances: earlier frames are read down to @-{}", life.deepest_read + 1,
                            life.deepest_read));
    }
  }
}

} // namespace dermis
