#include "framegraph/explain/plan_diff.hpp"

#include "framegraph/explain/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace dermis {
namespace {

// Collects one line per entry of a section. Repeated names get a number.
class Lines {
public:
  void add(std::string name, std::string text) {
    if (const uint32_t before = count_[name]++; before > 0) name += fmt::format(" #{}", before + 1);
    all_.emplace_back(std::move(name), std::move(text));
  }
  const std::vector<std::pair<std::string, std::string>>& all() const { return all_; }

private:
  std::vector<std::pair<std::string, std::string>> all_;
  std::map<std::string, uint32_t> count_;
};

std::string object_text(const SavedPlan& saved, uint32_t resource, uint32_t frames_back,
                        const SubresourceRange& range) {
  const std::string name =
      saved.names.resources[resource] + range_text(saved.plan.resources[resource], range);
  return frames_back == 0 ? name : fmt::format("{}@-{}", name, frames_back);
}

// Returns the resource's name if one of two plans of one graph has it, else its number.
std::string declared_text(uint32_t declared, const SavedPlan& saved, const SavedPlan& other) {
  for (const SavedPlan* plan : {&saved, &other})
    for (size_t r = 0; plan->key.graph == saved.key.graph && r < plan->plan.resources.size(); ++r)
      if (plan->plan.resources[r].declared.value == declared) return plan->names.resources[r];
  return fmt::format("resource {}", declared);
}

Lines compiled_from(const SavedPlan& saved, const SavedPlan& other) {
  const PlanKey& key = saved.key;
  constexpr std::string_view orders[] = {"memory", "program", "random"};
  constexpr std::string_view levels[] = {"fast", "tight", "optimize"};
  const auto yes_no = [](bool flag) { return flag ? "yes" : "no"; };
  Lines lines;
  lines.add("graph", fmt::format("{} {}", saved.plan.graph, digest_text(key.graph).substr(0, 16)));
  lines.add("view", fmt::format("{}x{}", key.view_width, key.view_height));
  lines.add("pixel grid", fmt::format("{}", key.pixel_grid));
  lines.add("device", key.device_profile);
  lines.add(
      "device limits",
      fmt::format(
          "granularity {} B, images {} px, {} layers, storage buffers {}, memory types {:#x}, {} "
          "work groups, push constants {} B",
          key.buffer_image_granularity, key.max_image_dimension, key.max_image_layers,
          bytes_text(key.max_storage_buffer_bytes), key.device_local_type_bits,
          key.max_workgroup_count, key.max_push_constants_bytes));
  std::string features;
  for (uint32_t f = 0; f < static_cast<uint32_t>(Feature::count); ++f)
    if ((key.features & bit_of(static_cast<Feature>(f))) != 0)
      features +=
          (features.empty() ? "" : ", ") + std::string(feature_name(static_cast<Feature>(f)));
  lines.add("device features", features.empty() ? "none" : features);
  std::string unbound, formats;
  for (size_t r = 0; r < key.bound.size(); ++r)
    if (key.bound[r] == 0)
      unbound +=
          (unbound.empty() ? "" : ", ") + declared_text(static_cast<uint32_t>(r), saved, other);
  for (size_t r = 0; r < key.host_formats.size(); ++r)
    if (key.host_formats[r] != Format::undefined)
      formats += fmt::format("{}{}: {}", formats.empty() ? "" : ", ",
                             declared_text(static_cast<uint32_t>(r), saved, other),
                             format_info(key.host_formats[r]).name);
  lines.add("unbound slots", unbound.empty() ? "none" : unbound);
  lines.add("host formats", formats.empty() ? "as declared" : formats);
  lines.add("order",
            fmt::format("{}{}", orders[static_cast<size_t>(key.order)],
                        key.order == PassOrder::random ? fmt::format(" {}", key.order_seed) : ""));
  lines.add("packing", std::string(levels[static_cast<size_t>(key.packing)]));
  lines.add("aliasing", yes_no(key.alias));
  lines.add("culling", yes_no(key.cull));
  lines.add("poison", yes_no(key.poison));
  lines.add("single queue", yes_no(key.single_queue));
  lines.add("kept alive",
            key.keep_alive.valid() ? declared_text(key.keep_alive.value, saved, other) : "none");
  return lines;
}

Lines settings(const SavedPlan& saved) {
  Lines lines;
  for (const NamedSettingValue& setting : saved.names.settings)
    lines.add(setting.name, setting.text);
  return lines;
}

std::string pass_text(const SavedPlan& saved, size_t p) {
  const PlanPass& pass = saved.plan.passes[p];
  std::string text = saved.names.pass_types[p];
  if (pass.queue == Queue::async) text += " async";
  if (pass.wait != no_point) text += fmt::format(" wait={}", pass.wait);
  if (pass.signal != 0) text += fmt::format(" signal={}", pass.signal);
  const auto [first, last] =
      std::equal_range(saved.plan.orderings.begin(), saved.plan.orderings.end(),
                       PlanOrdering{0, static_cast<uint32_t>(p)});
  for (auto at = first; at != last; ++at)
    text += fmt::format(" after={}", saved.names.passes[at->earlier]);
  for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
    const PlanAccess& access = saved.plan.accesses[a];
    const bool writes = (access.access & all_write_access) != 0;
    text += fmt::format(" {}{}{}{}", saved.names.ports[a], writes ? "=>" : "<=",
                        object_text(saved, access.resource, access.frames_back, access.range),
                        read_when_text(access.when));
  }
  const size_t settings_end = p + 1 < saved.plan.passes.size()
                                  ? saved.plan.passes[p + 1].first_setting
                                  : saved.plan.settings.size();
  for (size_t s = pass.first_setting; s < settings_end; ++s) {
    const NamedSettingValue& setting = saved.names.pass_settings[s];
    const SettingId from = saved.plan.settings[s].from;
    text += fmt::format(" {}={}{}", setting.name,
                        from.valid() ? fmt::format("${}=", saved.names.settings[from.value].name)
                                     : std::string(),
                        setting.text);
  }
  return text;
}

Lines passes(const SavedPlan& saved) {
  Lines lines;
  for (size_t p = 0; p < saved.plan.passes.size(); ++p)
    lines.add(saved.names.passes[p], pass_text(saved, p));
  return lines;
}

Lines resources(const SavedPlan& saved) {
  Lines lines;
  for (size_t r = 0; r < saved.plan.resources.size(); ++r) {
    const PlanResource& resource = saved.plan.resources[r];
    std::string text =
        resource.type == ResourceType::image
            ? fmt::format("{} {}", format_info(resource.format).name, shape_text(resource))
        : resource.type == ResourceType::buffer ? bytes_text(resource.bytes)
                                                : "acceleration structure";
    if (resource.type != ResourceType::acceleration_structure)
      text += fmt::format(", used as {}", usage_text(resource.type, resource.vk_usage));
    text += resource.first_instance == no_instance
                ? ", the host's"
                : fmt::format(", {} instance{}", resource.instance_count,
                              resource.instance_count == 1 ? "" : "s");
    lines.add(saved.names.resources[r], std::move(text));
  }
  return lines;
}

Lines heaps(const SavedPlan& saved) {
  Lines lines;
  for (size_t h = 0; h < saved.plan.heaps.size(); ++h) {
    const Heap& heap = saved.plan.heaps[h];
    lines.add(fmt::format("heap {}", h),
              fmt::format("{} B, alignment {} B, memory types {:#x}, {}, at most {} B live",
                          heap.size, heap.alignment, heap.memory_type_bits,
                          heap.persistent ? "histories" : "transients", heap.max_live_bytes));
  }
  return lines;
}

Lines placements(const SavedPlan& saved) {
  Lines lines;
  for (const Placement& placement : saved.plan.placements)
    lines.add(saved.names.resources[placement.resource],
              fmt::format("heap {} at {}, {}, {}", placement.heap, placement.offset,
                          bytes_text(placement.size),
                          placement.persistent ? "always"
                                               : fmt::format("passes {} .. {}", placement.first_use,
                                                             placement.last_use)));
  return lines;
}

Lines histories(const SavedPlan& saved) {
  Lines lines;
  for (const PlanHistory& history : saved.plan.histories) {
    const HistoryDeclaration& declared = history.declaration;
    lines.add(
        saved.names.resources[history.resource],
        fmt::format("{} frames in {} instances, first={} on_cut={} on_resize={}", history.frames,
                    saved.plan.resources[history.resource].instance_count,
                    declared.first == HistoryDeclaration::First::clear ? "clear" : "discard",
                    declared.on_cut == HistoryDeclaration::OnCut::keep ? "keep" : "invalidate",
                    declared.on_resize == HistoryDeclaration::OnResize::rescale ? "rescale"
                                                                                : "invalidate"));
  }
  return lines;
}

void add_batch(const SavedPlan& saved, std::string_view where, uint32_t first, uint32_t count,
               Lines& lines) {
  for (uint32_t b = first; b < first + count; ++b) {
    const PlanBarrier& barrier = saved.plan.barriers[b];
    lines.add(fmt::format("{}: {}", where,
                          object_text(saved, barrier.resource, barrier.frames_back, barrier.range)),
              fmt::format("{}, {} {} {} -> {} {} {}", why_name(barrier.why),
                          barrier.from_host ? "host" : stage_text(barrier.source_stages),
                          access_text(barrier.source_access), layout_name(barrier.old_layout),
                          barrier.to_host ? "host" : stage_text(barrier.destination_stages),
                          access_text(barrier.destination_access),
                          layout_name(barrier.new_layout)));
  }
}

Lines barriers(const SavedPlan& saved) {
  Lines lines;
  for (size_t p = 0; p < saved.plan.passes.size(); ++p)
    add_batch(saved, "before " + saved.names.passes[p], saved.plan.passes[p].first_barrier,
              saved.plan.passes[p].barrier_count, lines);
  for (size_t p = 0; p < saved.plan.passes.size(); ++p)
    add_batch(saved, "after " + saved.names.passes[p],
              saved.plan.passes[p].first_barrier + saved.plan.passes[p].barrier_count,
              saved.plan.passes[p].release_count, lines);
  add_batch(saved, "at the end", saved.plan.first_final_barrier, saved.plan.final_barrier_count,
            lines);
  return lines;
}

// Returns the entries that differ or exist on one side only: in the order of a, then those that
// only b has.
std::vector<PlanDifference> differences(const Lines& a, const Lines& b) {
  const std::map<std::string, std::string> in_a(a.all().begin(), a.all().end());
  const std::map<std::string, std::string> in_b(b.all().begin(), b.all().end());
  std::vector<PlanDifference> out;
  for (const auto& [name, text] : a.all()) {
    const auto other = in_b.find(name);
    if (other == in_b.end())
      out.push_back({name, text, ""});
    else if (other->second != text)
      out.push_back({name, text, other->second});
  }
  for (const auto& [name, text] : b.all())
    if (!in_a.contains(name)) out.push_back({name, "", text});
  return out;
}

// Returns the minimal set of passes that moved: passes of both plans that are not part of the
// longest common order.
std::vector<PlanDifference> moved(const SavedPlan& a, const SavedPlan& b) {
  std::map<std::string, size_t> place_in_b;
  for (size_t p = 0; p < b.names.passes.size(); ++p)
    place_in_b.emplace(b.names.passes[p], p);
  struct Common {
    size_t in_a, in_b;
    size_t before = SIZE_MAX; // predecessor in the longest rising run that ends here
    bool kept = false;
  };
  std::vector<Common> common;
  for (size_t p = 0; p < a.names.passes.size(); ++p)
    if (const auto at = place_in_b.find(a.names.passes[p]); at != place_in_b.end())
      common.push_back({p, at->second});
  // by length - 1: the common pass with the lowest place in b that ends a run of that length
  std::vector<size_t> tails;
  for (size_t i = 0; i < common.size(); ++i) {
    const auto at =
        std::lower_bound(tails.begin(), tails.end(), common[i].in_b,
                         [&](size_t tail, size_t place) { return common[tail].in_b < place; });
    if (at != tails.begin()) common[i].before = *(at - 1);
    if (at == tails.end())
      tails.push_back(i);
    else
      *at = i;
  }
  for (size_t i = tails.empty() ? SIZE_MAX : tails.back(); i != SIZE_MAX; i = common[i].before)
    common[i].kept = true;
  std::vector<PlanDifference> out;
  for (const Common& one : common)
    if (!one.kept)
      out.push_back({a.names.passes[one.in_a], fmt::format("position {}", one.in_a),
                     fmt::format("position {}", one.in_b)});
  return out;
}

PlanTotals totals(const Plan& plan) {
  PlanTotals totals{plan.passes.size(), plan.barriers.size(),
                    plan.final_barrier_count > 0 ? 1u : 0u, plan.transient_bytes,
                    plan.history_bytes};
  for (const PlanPass& pass : plan.passes)
    totals.batches += pass.barrier_count > 0 ? 1 : 0;
  return totals;
}

} // namespace

PlanDiff diff_plans(const SavedPlan& a, const SavedPlan& b) {
  PlanDiff diff;
  diff.a = totals(a.plan);
  diff.b = totals(b.plan);
  const auto compare = [&](std::string_view name, Lines (*lines)(const SavedPlan&)) {
    diff.sections.push_back({name, differences(lines(a), lines(b))});
  };
  diff.sections.push_back({"compiled_from", differences(compiled_from(a, b), compiled_from(b, a))});
  compare("settings", settings);
  compare("passes", passes);
  diff.sections.push_back({"order", moved(a, b)});
  compare("resources", resources);
  compare("heaps", heaps);
  compare("placements", placements);
  compare("histories", histories);
  compare("barriers", barriers);
  SavedPlan with_key_of_a = b;
  with_key_of_a.key = a.key;
  diff.same = write_plan(with_key_of_a) == write_plan(a);
  return diff;
}

} // namespace dermis
