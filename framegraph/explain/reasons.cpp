#include "framegraph/explain/reasons.hpp"

#include "framegraph/compile/availability.hpp"
#include "framegraph/compile/compile.hpp"
#include "framegraph/explain/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace dermis {
namespace {

struct ReasonFormatter {
  const Graph& graph;
  const PassTypeRegistry& pass_types;
  const Plan& plan;
  const Reason& reason;

  const std::string& pass(uint32_t id) const { return graph.passes[id].name; }
  const std::string& resource(uint32_t id) const { return graph.resources[id].name; }
  const std::string& pass_at(uint32_t position) const {
    return pass(plan.passes[position].declared.value);
  }
  std::string_view port(uint32_t of_pass, uint32_t number) const {
    return pass_types[graph.passes[of_pass].type].ports[number].name;
  }
  std::string_view format() const { return format_info(static_cast<Format>(reason.a)).name; }
  const char* when() const { return reason.b != 0 ? " in the previous frame" : ""; }

  std::string needed(const char* verb) const {
    return fmt::format("runs: '{}' {} its '{}'", pass(reason.a), verb, resource(reason.b));
  }

  std::string not_needed() const {
    std::string names;
    for (const PortBinding& binding : graph.writes(graph.passes[reason.index]))
      names += fmt::format("{}'{}'", names.empty() ? "" : ", ", resource(binding.resource.value));
    return names.empty() ? "culled: it writes nothing" : "culled: no bound export needs " + names;
  }

  std::string not_available() const {
    const SettingDeclaration& declared = graph.settings[reason.index];
    MissingRequirements unmet{reason.b, {}};
    if (reason.b == 0) unmet.imports.push_back(ResourceId{reason.c});
    return fmt::format("{} = {} instead of '{}', which is not available: {}", declared.name,
                       setting_text(declared, plan.setting_values[reason.index]),
                       declared.options[reason.a], missing_text(graph, unmet));
  }

  // Names the values of the settings that `when` reads.
  std::string off() const {
    const PassDeclaration& declared = graph.passes[reason.index];
    if (declared.absence == PassDeclaration::Absence::no_profile)
      return "off: its pass type only serves scattering, and the graph has no profile";
    if (declared.absence == PassDeclaration::Absence::no_input)
      return fmt::format(
          "off: it reads '{}', whose producers are off because the graph has no profile",
          resource(declared.missing.value));
    std::vector<uint32_t> requested;
    std::vector<ExpressionId> left{graph.passes[reason.index].when};
    while (!left.empty()) {
      const ExpressionId id = left.back();
      left.pop_back();
      if (!id.valid()) continue;
      const Expression& one = graph.expressions[id.value];
      if (one.op == Expression::Op::setting) requested.push_back(one.setting.value);
      left.insert(left.end(), {one.left, one.right});
    }
    std::sort(requested.begin(), requested.end());
    requested.erase(std::unique(requested.begin(), requested.end()), requested.end());
    std::string values;
    for (const uint32_t s : requested)
      values += fmt::format("{}{} = {}", values.empty() ? " with " : ", ", graph.settings[s].name,
                            setting_text(graph.settings[s], plan.setting_values[s]));
    return "off: its 'when' is false" + values;
  }

  std::string order(const char* chosen, const char* other) const {
    constexpr uint64_t kib = 1024;
    return fmt::format("{}: at most {} of transients are alive at once; {} {}", chosen,
                       bytes_text(reason.a * kib), other, bytes_text(reason.b * kib));
  }

  std::string chosen_format() const {
    if (graph.resources[reason.index].formats.size() == 1 && reason.b != 2)
      return fmt::format("format {}: the only declared format", format());
    constexpr std::string_view how[] = {
        "first declared format", "first declared format that is usable", "bound by the host"};
    return fmt::format("format {}: {}", format(), how[reason.b]);
  }

  std::string setting(const char* whose) const {
    const SettingDeclaration& declared = graph.settings[reason.index];
    return fmt::format("{} = {}: {}", declared.name,
                       setting_text(declared, plan.setting_values[reason.index]), whose);
  }

  std::string dependency() const {
    const PlanBarrier& barrier = plan.barriers[reason.index];
    const std::string& later = pass_at(reason.c);
    const std::string name = resource(plan.resources[barrier.resource].declared.value) +
                             range_text(plan.resources[barrier.resource], barrier.range);
    const std::string what = barrier.frames_back == 0
                                 ? fmt::format("'{}'", name)
                                 : fmt::format("'{}@-{}'", name, barrier.frames_back);
    const std::string last = fmt::format("'{}'{}", pass_at(reason.a), when());
    switch (barrier.why) {
    case PlanBarrier::ReasonKind::write_after_read:
      return fmt::format("'{}' overwrites {} after {} reads it", later, what, last);
    case PlanBarrier::ReasonKind::write_after_write:
      return fmt::format("'{}' writes {} after {}", later, what, last);
    case PlanBarrier::ReasonKind::layout:
      return fmt::format("'{}' needs {} in a different layout than {}", later, what, last);
    default:
      return fmt::format("'{}' reads {} after {} writes it", later, what, last);
    }
  }

  std::string text() const {
    switch (reason.why) {
    case Reason::ReasonKind::off:
      return off();
    case Reason::ReasonKind::read_by:
      return needed("reads");
    case Reason::ReasonKind::read_later_by:
      return needed("reads in later frames");
    case Reason::ReasonKind::overwritten_by:
      return needed("overwrites");
    case Reason::ReasonKind::writes_export:
      return fmt::format("runs: it writes the export '{}'", resource(reason.a));
    case Reason::ReasonKind::side_effects:
      return "runs: its pass type has side effects";
    case Reason::ReasonKind::culling_off:
      return "runs: culling is disabled";
    case Reason::ReasonKind::port_unbound:
      return fmt::format("optional port '{}' is unbound: nothing provides '{}'",
                         port(reason.index, reason.a), resource(reason.b));
    case Reason::ReasonKind::async_queue:
      return "runs on the async queue";
    case Reason::ReasonKind::after_pass:
      return fmt::format("runs after '{}': {}", pass(reason.a),
                         graph.passes[reason.index].after[reason.b].reason);
    case Reason::ReasonKind::not_async:
      return fmt::format("runs on the main queue: '{}' is owned by the host, kept across frames, "
                         "or bound by mip or layer",
                         resource(reason.a));
    case Reason::ReasonKind::always_otherwise:
      return fmt::format(
          "port '{}' reads its 'otherwise' in every frame: no enabled pass writes '{}'",
          port(reason.index, reason.a), resource(reason.b));
    case Reason::ReasonKind::lacks_input_without_bounds:
      return fmt::format(
          "skipped in frames with empty bounds: it reads '{}', which only scattering passes write",
          resource(reason.a));
    case Reason::ReasonKind::not_needed:
      return not_needed();
    case Reason::ReasonKind::unbound:
      return "optional slot that the host does not bind";
    case Reason::ReasonKind::replaced_by:
      return fmt::format("replaces '{}' after pass '{}', which is off", resource(reason.a),
                         pass(reason.b));
    case Reason::ReasonKind::unwritten_export:
      return "unchanged: no enabled pass writes this optional export";
    case Reason::ReasonKind::format:
      return chosen_format();
    case Reason::ReasonKind::format_not_ported:
      return fmt::format("not {}: port '{}' of pass '{}' does not support it", format(),
                         port(reason.b, reason.c), pass(reason.b));
    case Reason::ReasonKind::format_unfiltered:
      return fmt::format("not {}: the device '{}' does not filter it, as port '{}' of pass '{}' "
                         "needs",
                         format(), plan.device_profile, port(reason.b, reason.c), pass(reason.b));
    case Reason::ReasonKind::format_unsupported:
      return fmt::format("not {}: the device '{}' does not support it with usage {}", format(),
                         plan.device_profile, usage_text(ResourceType::image, reason.b));
    case Reason::ReasonKind::history_unused:
      return "no memory: no running pass uses it";
    case Reason::ReasonKind::history_unread:
      return "placed like a transient: no running pass reads its earlier frames";
    case Reason::ReasonKind::history_read:
      return fmt::format("earlier frames are read back to @-{}", reason.a);
    case Reason::ReasonKind::overwritten_in_place:
      return fmt::format("each frame reuses the memory of @-{}, which {}", reason.a,
                         reason.b != 0 ? "its writer reads texel by texel" : "no later pass reads");
    case Reason::ReasonKind::aliases_history:
      return fmt::format("aliases memory of the history '{}', {}", resource(reason.a),
                         reason.b != 0 ? "after the last read of its oldest frame"
                                       : "before this frame's first write to it");
    case Reason::ReasonKind::from_host:
      return fmt::format("acquires '{}' from the host", resource(reason.a));
    case Reason::ReasonKind::oldest_instance:
      return fmt::format("reuses the oldest instance of '{}' for this frame", resource(reason.a));
    case Reason::ReasonKind::first_use:
      return fmt::format("first use of '{}'", resource(reason.a));
    case Reason::ReasonKind::after_last_use:
      return fmt::format("after its last use{}", when());
    case Reason::ReasonKind::acquires_memory:
      return fmt::format("reuses memory of '{}'{}", resource(reason.a), when());
    case Reason::ReasonKind::dependency:
      return dependency();
    case Reason::ReasonKind::to_host:
      return fmt::format("returns '{}' to the host{}", resource(reason.a),
                         reason.b != 0 ? "; no pass uses it" : "");
    case Reason::ReasonKind::requested:
      return setting("requested by the caller");
    case Reason::ReasonKind::by_default:
      return setting("the default");
    case Reason::ReasonKind::not_available:
      return not_available();
    case Reason::ReasonKind::order_of_file:
      return order("file order", "depth-first order would need");
    case Reason::ReasonKind::depth_first:
      return order("depth-first order", "file order would need");
    case Reason::ReasonKind::program_order:
      return "file order: requested by the caller";
    case Reason::ReasonKind::random_order:
      return "random order: requested by the caller";
    }
    return {};
  }
};

auto subject(const Reason& reason) {
  return std::tuple(reason.about, reason.index);
}

bool share_bytes(const Placement& a, const Placement& b) {
  return a.heap == b.heap && a.offset < b.offset + b.size && b.offset < a.offset + a.size;
}

bool overlap(const Placement& a, const Placement& b) {
  return a.first_use <= b.last_use && b.first_use <= a.last_use;
}

// In large plans only the neighbours nearest in time are named.
constexpr size_t named_neighbours = 24;

} // namespace

std::string reason_text(const Graph& graph, const PassTypeRegistry& pass_types, const Plan& plan,
                        const Reason& reason) {
  return ReasonFormatter{graph, pass_types, plan, reason}.text();
}

ReasonIndex::ReasonIndex(const Graph& graph, const PassTypeRegistry& pass_types,
                         const CompiledPlan& compiled)
    : graph_(graph), pass_types_(pass_types), compiled_(compiled) {
  for (const Reason& reason : compiled.reasons)
    sorted_.push_back(&reason);
  std::stable_sort(sorted_.begin(), sorted_.end(),
                   [](const Reason* a, const Reason* b) { return subject(*a) < subject(*b); });
}

std::string ReasonIndex::about(Reason::About about, uint32_t index) const {
  const auto subject_key = std::tuple(about, index);
  auto at =
      std::lower_bound(sorted_.begin(), sorted_.end(), subject_key,
                       [](const Reason* one, const auto& key) { return subject(*one) < key; });
  const auto first = at;
  std::string all;
  for (; at != sorted_.end() && subject(**at) == subject_key; ++at) {
    const Reason& one = **at;
    const auto alike = [&](const Reason* other) {
      return one.why == Reason::ReasonKind::acquires_memory && other->why == one.why &&
             other->b == one.b;
    };
    if (std::any_of(first, at, alike)) continue; // already named there
    all += (all.empty() ? "" : "; ") + reason_text(graph_, pass_types_, compiled_.plan, one);
    std::string others;
    for (auto later = at + 1; later != sorted_.end() && subject(**later) == subject_key; ++later)
      if (alike(*later)) others += fmt::format(", '{}'", graph_.resources[(*later)->a].name);
    if (!others.empty()) all.insert(all.rfind('\'') + 1, others); // after the name of the first
  }
  return all;
}

std::vector<std::string> placement_reasons(const Graph& graph, const Plan& plan) {
  std::vector<uint32_t> by_first(plan.placements.size());
  for (uint32_t i = 0; i < by_first.size(); ++i)
    by_first[i] = i;
  std::stable_sort(by_first.begin(), by_first.end(), [&](uint32_t a, uint32_t b) {
    return plan.placements[a].first_use < plan.placements[b].first_use;
  });
  std::vector<std::string> texts(plan.placements.size());
  for (size_t at = 0; at < by_first.size(); ++at) {
    const Placement& own = plan.placements[by_first[at]];
    std::string& text = texts[by_first[at]];
    if (own.persistent) {
      const bool is_aliased =
          std::any_of(plan.placements.begin(), plan.placements.end(), [&](const Placement& other) {
            return !other.persistent && other.heap == own.heap && share_bytes(own, other);
          });
      text = is_aliased
                 ? "kept across frames; transients alias its memory while it holds no contents"
                 : "not aliased: kept across frames";
      continue;
    }
    const size_t from = at > named_neighbours ? at - named_neighbours : 0;
    const size_t to = std::min(by_first.size(), at + named_neighbours + 1);
    std::string shared, apart;
    for (size_t k = from; k < to; ++k) {
      const Placement& other = plan.placements[by_first[k]];
      if (k == at || other.heap != own.heap) continue;
      const std::string& name = graph.resources[plan.resources[other.resource].declared.value].name;
      if (share_bytes(own, other))
        shared += fmt::format("{}'{}'", shared.empty() ? "" : ", ", name);
      else if (overlap(own, other))
        apart += fmt::format("{}'{}' [{}, {}]", apart.empty() ? "" : ", ", name, other.first_use,
                             other.last_use);
    }
    text = fmt::format("alive in passes [{}, {}]", own.first_use, own.last_use);
    if (!shared.empty()) text += "; aliases " + shared;
    if (!apart.empty()) text += "; not with " + apart + ", which live at the same time";
    if (from > 0 || to < by_first.size()) text += "; more neighbours are not listed";
  }
  return texts;
}

} // namespace dermis
