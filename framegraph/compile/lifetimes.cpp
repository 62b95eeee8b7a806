// From which pass to which each resource is alive, how it is used, and the settings each pass runs with.

#include "framegraph/compile/availability.hpp"
#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis {
namespace {

constexpr uint32_t threads_per_side = 8;        // kernels run 8x8 groups, one per tile
constexpr uint32_t tiles_per_group = 64;        // DispatchShape::over_tile_grid
constexpr uint32_t block_side = 4;              // tiles; DispatchShape::over_tile_blocks
constexpr uint32_t transfer_source_usage = 0x1; // VK_IMAGE_USAGE_TRANSFER_SRC_BIT, the same bit for buffers
constexpr uint32_t push_constant_bytes = 4;     // the port mask, and each setting

void add_settings(CompileContext& c, PassId pass, PlanPass& planned) {
  const PassDeclaration& declared = c.graph->passes[pass.value];
  const PassType& type = c.type(pass);
  planned.first_setting = static_cast<uint32_t>(c.out->plan.settings.size());
  for (uint32_t s = 0; s < type.settings.size(); ++s) {
    PlanSetting setting;
    setting.value = type.settings[s].default_value;
    for (const SettingBinding& binding : declared.settings) {
      if (binding.setting != s) continue;
      setting.from = binding.from;
      setting.value = binding.from.valid() ? c.settings[binding.from.value] : binding.literal;
    }
    c.out->plan.settings.push_back(setting);
  }
}

// Whether all limits of the device hold; what is beyond them is said of each pass.
bool check_limits(CompileContext& c, PassId pass) {
  const PassType& type = c.type(pass);
  bool fits = (type.features & ~c.device->features) == 0;
  const auto refuse = [&](const std::string& text) {
    fits = false;
    c.diagnostics->add(DiagnosticId::device_limit, c.graph->passes[pass.value].where,
                       fmt::format("pass '{}' {} (device '{}')", c.name(pass), text, c.device->name));
  };
  if (const Features missing = type.features & ~c.device->features; missing != 0)
    c.diagnostics->add(DiagnosticId::device_feature, c.graph->passes[pass.value].where,
                       fmt::format("pass '{}' cannot run on '{}': {}", c.name(pass), c.device->name,
                                   missing_text(*c.graph, {missing, {}})));
  const uint64_t push_bytes = push_constant_bytes * (1 + uint64_t{type.settings.size()});
  if (push_bytes > c.device->max_push_constants_bytes)
    refuse(fmt::format("needs {} bytes of push constants; the limit is {}", push_bytes,
                       c.device->max_push_constants_bytes));
  const auto tiles = [](uint32_t side) { return (uint64_t{side} + threads_per_side - 1) / threads_per_side; };
  const uint64_t across = tiles(c.input->view_width), down = tiles(c.input->view_height);
  uint64_t groups = 1;
  if (type.dispatch == DispatchShape::over_tile_blocks)
    groups = (std::max(across, down) + block_side - 1) / block_side;
  if (type.dispatch == DispatchShape::over_view) groups = std::max(across, down);
  if (type.dispatch == DispatchShape::over_tile_grid)
    groups = (across * down + tiles_per_group - 1) / tiles_per_group;
  if (groups > c.device->max_workgroup_count)
    refuse(fmt::format("dispatches {} groups in one dimension; the limit is {}", groups,
                       c.device->max_workgroup_count));
  return fits;
}

// Whether the port, which names no formats, works with all that the resource may get. The reader of graphs
// has judged single formats, except those of a resource that stands in for another.
bool takes_all_formats(const CompileContext& c, const Use& use, const Port& port) {
  const FormatList& formats = c.graph->resources[use.resource.value].formats;
  if (formats.size() <= 1 && use.resource == use.requested) return true;
  return std::all_of(formats.begin(), formats.end(), [&](Format format) { return works_with(port, format); });
}

// What one use asks of the resource.
void note(CompileContext& c, uint32_t u, const PassType& type) {
  const Use& use = c.uses[u];
  if (use.bind_error != Use::BindError::none) return;
  Lifetime& life = c.lifetimes[use.resource.value];
  life.used = true;
  life.vk_usage |= usage_info(use.usage).vk_usage;
  life.deepest_read = std::max(life.deepest_read, use.frames_back);
  const Port& port = type.ports[use.port];
  if (port.formats.empty() && takes_all_formats(c, use, port)) return;
  c.narrow.push_back({u, life.first_narrow});
  life.first_narrow = static_cast<uint32_t>(c.narrow.size() - 1);
}

Renewal renewal_of(const CompileContext& c, ResourceId id, uint32_t deepest) {
  Renewal result;
  for (uint32_t position = 0; position < c.order.size(); ++position) {
    const uint32_t pass = c.order[position].value;
    bool reads_freely = false, touches = false;
    for (uint32_t u = c.first_use[pass]; u < c.first_use[pass + 1]; ++u) {
      const Use& use = c.uses[u];
      if (use.bind_error != Use::BindError::none || use.resource != id) continue;
      touches |= use.frames_back == 0;
      if (use.frames_back != deepest) continue;
      result.last_read = position;
      reads_freely |= !c.type(PassId{pass}).ports[use.port].own_texels;
    }
    if (touches && result.first_touch == no_value) {
      result.first_touch = position;
      result.own_texels = !reads_freely;
    }
  }
  return result;
}

// A history needs no instance beyond the frames it keeps where the oldest has been read before its memory is
// written, or is read by the writer alone, each texel by the invocation that writes it.
void renew_in_place(CompileContext& c) {
  for (PlanResource& resource : c.out->plan.resources) {
    Lifetime& life = c.lifetimes[resource.declared.value];
    if (life.deepest_read == 0 || !c.input->alias || resource.declared == c.input->keep_alive) continue;
    const Renewal renewal = life.renewal = renewal_of(c, resource.declared, life.deepest_read);
    life.updates_oldest = renewal.last_read == renewal.first_touch && renewal.own_texels;
    if (renewal.last_read >= renewal.first_touch && !life.updates_oldest) continue;
    resource.instance_count = life.deepest_read;
    c.record_reason(Reason::About::resource, resource.declared.value, Reason::ReasonKind::renewed_in_place,
                    life.deepest_read, life.updates_oldest ? 1 : 0);
  }
}

void explain_history(CompileContext& c, uint32_t resource, const Lifetime& life) {
  const Reason::ReasonKind why = !life.used               ? Reason::ReasonKind::history_unused
                                 : life.deepest_read == 0 ? Reason::ReasonKind::history_unread
                                                          : Reason::ReasonKind::history_read;
  c.record_reason(Reason::About::resource, resource, why, life.deepest_read);
}

} // namespace

void gather_usage(CompileContext& c) {
  c.lifetimes.assign(c.graph->resources.size(), {});
  c.narrow.clear();
  for (auto u = static_cast<uint32_t>(c.uses.size()); u-- > 0;) // last first: `narrow` is a stack
    if (c.live[c.uses[u].pass.value]) note(c, u, c.type(c.uses[u].pass));
  for (uint32_t i = 0; i < c.graph->resources.size(); ++i) {
    if (!c.info[i].history) continue;
    Lifetime& life = c.lifetimes[i];
    if (life.deepest_read > 0)
      // Instances start from zero, or from what another plan of the graph kept.
      life.vk_usage |= usage_info(Usage::clear).vk_usage | transfer_source_usage;
    const uint32_t stored = usage_info(Usage::storage_image_write).vk_usage;
    if (c.graph->resources[i].history.on_resize == HistoryDeclaration::OnResize::rescale &&
        (life.vk_usage & stored) != 0)
      life.vk_usage |= usage_info(Usage::sampled_image).vk_usage; // the rescaling kernel reads the old size
    explain_history(c, i, life);
  }
  if (!c.input->poison) return;
  for (uint32_t i = 0; i < c.graph->resources.size(); ++i)
    if (c.lifetimes[i].used && !c.info[i].host_owned)
      c.lifetimes[i].vk_usage |= usage_info(Usage::clear).vk_usage;
}

void lifetimes(CompileContext& c) {
  std::vector<PlanPass>& passes = c.out->plan.passes;
  c.pass_type_fits.assign(c.pass_types->size(), 0);
  for (uint32_t position = 0; position < c.order.size(); ++position) {
    const PassId pass = c.order[position];
    PlanPass& planned = passes.emplace_back();
    planned.declared = pass;
    planned.type = c.kind_of[pass.value];
    if (!c.queue.empty()) planned.queue = c.queue[pass.value];
    add_settings(c, pass, planned);
    uint8_t& fits = c.pass_type_fits[planned.type.value];
    if (fits != 1) fits = check_limits(c, pass) ? 1 : 2;
  }
  renew_in_place(c);
}

} // namespace dermis
