// Finds the passes that run: passes with side effects, passes that write a bound export, and the producers of
// everything that live passes read.

#include "framegraph/compile/hardware.hpp"
#include "framegraph/compile/phases.hpp"
#include "framegraph/model/image_range.hpp"
#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace dermis {
namespace {

struct Culler {
  const CompileInput& in;
  const Graph& graph;
  const Sizes& sizes;
  const Activation& active;
  const Subresources& subresources;
  const Versions& versions;
  Report& report;
  CullScratch& scratch;
  LiveSet& live = scratch.result;
  std::vector<uint64_t>& unvisited = scratch.unvisited;

  void mark_live(PassId pass, Reason::ReasonKind why, uint32_t a = 0, uint32_t b = 0) {
    if (report.reasons_requested && !live.contains(pass))
      report.record_reason(Reason::About::pass, pass.value, why, a, b);
    unvisited[pass.value / 64] |= uint64_t{!live.contains(pass)} << pass.value % 64;
    live.passes[pass.value] = 1;
  }

  void mark_producer(uint32_t version, Reason::ReasonKind why, uint32_t a, uint32_t b = 0) {
    if (version != invalid_index && versions[version].producer.valid())
      mark_live(versions[version].producer, why, a, b);
  }

  // Same as mark_producer, for the hot loop. Marks `reader`, which is live already, if there is no producer:
  // that avoids a branch.
  void mark_producer_of_read(uint32_t version, PassId reader, uint32_t resource) {
    if (versions.list.empty()) return;
    const PassId producer = versions[select(version != invalid_index, version, 0u)].producer;
    const bool exists = (int{version != invalid_index} & int{producer.valid()}) != 0;
    mark_live(PassId{select(exists, producer.value, reader.value)}, Reason::ReasonKind::read_by, reader.value,
              resource);
  }

  void visit(PassId pass) {
    for (const Use& use : versions.uses_of(pass)) {
      if (use.bind_error != Use::BindError::none) {
        examine_bind_error(use);
        continue;
      }
      const uint32_t resource = use.resource.value;
      if (use.frames_back > 0)
        mark_producer(versions.final_version[use.subresource], Reason::ReasonKind::read_later_by, pass.value,
                      resource);
      mark_producer_of_read(use.read_version, pass, resource);
      // A pass that writes in place may keep texels of the version before.
      if (versions.overwrites && use.write_version != invalid_index)
        mark_producer(versions[use.write_version].previous, Reason::ReasonKind::overwritten_by, pass.value,
                      resource);
    }
  }

  // Visits the last pass first: most passes are located after their producers, so one sweep usually suffices.
  void visit_all() {
    for (bool any = true; any;) {
      any = false;
      for (size_t word = unvisited.size(); word-- > 0;) {
        uint64_t below = ~uint64_t{0}; // passes of this word before the one visited last
        while (const uint64_t left = unvisited[word] & below) {
          const auto bit = static_cast<uint32_t>(std::bit_width(left) - 1);
          below = (uint64_t{1} << bit) - 1;
          unvisited[word] &= ~(uint64_t{1} << bit);
          any = true;
          visit(PassId{static_cast<uint32_t>(word * 64 + bit)});
        }
      }
    }
  }

  // Without culling: keeps every pass whose inputs exist, and their producers.
  void keep_runnable() {
    std::vector<uint8_t> lacks_input(live.passes.size(), 0);
    for (const Use& use : versions.uses)
      if (use.bind_error != Use::BindError::none) lacks_input[use.pass.value] = 1;
    for (uint32_t i = 0; i < live.passes.size(); ++i)
      if (active.on[i] && !lacks_input[i]) mark_live(PassId{i}, Reason::ReasonKind::culling_off);
    for (bool again = true; again;) { // until all producers of each live pass are live
      again = false;
      for (const Use& use : versions.uses) {
        if (!live.passes[use.pass.value] || use.read_version == invalid_index) continue;
        const PassId producer = versions[use.read_version].producer;
        if (!producer.valid() || live.passes[producer.value]) continue;
        live.passes[use.pass.value] = 0;
        again = true;
      }
    }
  }

  // Whether the port reads its placeholder in every frame, because no pass writes the history.
  bool has_placeholder(const Use& use) const {
    if (use.when != ReadWhen::history_valid || use.bind_error != Use::BindError::history_unwritten)
      return false;
    const Use* next = &use + 1; // the placeholder follows the history at the same port
    const bool last = next == end_of_pass(use);
    return !last && next->when == ReadWhen::history_invalid && next->port == use.port &&
           next->bind_error == Use::BindError::none;
  }

  // Whether the pass cannot run without the port. Of several alternative ports the first is reported.
  bool is_required(const Use& use) const {
    const PassType& type = active.type(use.pass);
    if (!type.ports[use.port].optional) return true;
    if (!is_one_of(type, use.port)) return false;
    for (const Use& other : versions.uses_of(use.pass)) {
      if (!is_one_of(type, other.port)) continue;
      if (other.bind_error == Use::BindError::none || &other < &use) return false;
    }
    return true;
  }

  // A live pass has a port without a version: an error unless the port is optional, or if it is ambiguous.
  void examine_bind_error(const Use& use) {
    const Port& port = active.type(use.pass).ports[use.port];
    const bool missing = use.bind_error == Use::BindError::unbound ||
                         use.bind_error == Use::BindError::unwritten ||
                         use.bind_error == Use::BindError::history_unwritten;
    if (has_placeholder(use)) {
      report.record_reason(Reason::About::pass, use.pass.value, Reason::ReasonKind::always_otherwise,
                           use.port, use.requested.value);
      return;
    }
    if (missing && !is_required(use)) {
      if (first_of_binding(use))
        report.record_reason(Reason::About::pass, use.pass.value, Reason::ReasonKind::port_unbound, use.port,
                             use.requested.value);
      return;
    }
    if (scratch.reported[use.requested.value]) return;
    scratch.reported[use.requested.value] = 1;
    const auto report_error = [&](DiagnosticId id, std::string text) {
      auto& diagnostic = report.diagnostics.add(id, location_of(graph, use), std::move(text));
      diagnostic.related.emplace_back(graph.resources[use.requested.value].where,
                                      fmt::format("'{}' is declared here", name_of(graph, use.requested)));
      relate_producers(diagnostic, use);
    };
    const std::string reader = fmt::format("pass '{}', port '{}'", name_of(graph, use.pass), port.name);
    const std::string& resource = name_of(graph, use.requested);
    switch (use.bind_error) {
    case Use::BindError::none:
      break;
    case Use::BindError::unbound:
      return report_error(DiagnosticId::unbound_import,
                          fmt::format("{} needs '{}', which the host leaves unbound", reader, resource));
    case Use::BindError::unwritten:
      return report_error(
          DiagnosticId::read_before_write,
          fmt::format("{} reads '{}', which no pass that is on writes before it", reader, seen_text(use)));
    case Use::BindError::ambiguous:
      return report_error(DiagnosticId::ambiguous_version,
                          fmt::format("{} reads '{}' before any pass wrote it, and several write it later",
                                      reader, resource));
    case Use::BindError::replaced:
      return report_error(
          DiagnosticId::replaced_update,
          fmt::format("{} updates '{}' in place, but it stands for '{}' because its producer is off", reader,
                      resource, name_of(graph, use.resource)));
    case Use::BindError::history_unwritten:
      return report_error(DiagnosticId::history_unwritten,
                          fmt::format("{0} reads '{1}@-{2}', but no pass that is on writes '{1}'", reader,
                                      seen_text(use), use.frames_back));
    case Use::BindError::partly_unwritten:
      return use.frames_back > 0
                 ? report_error(DiagnosticId::history_unwritten,
                                fmt::format("{} reads '{}@-{}', but no pass that is on writes {}", reader,
                                            seen_text(use), use.frames_back, unwritten_ranges(use)))
                 : report_error(DiagnosticId::read_before_write,
                                fmt::format("{} reads '{}', but no pass that is on writes {} before it",
                                            reader, seen_text(use), unwritten_ranges(use)));
    }
  }

  const char* state_of(PassId pass) const {
    if (active.on[pass.value]) return "on";
    const bool by_settings = graph.passes[pass.value].absence == PassDeclaration::Absence::none;
    return by_settings ? "off with these settings" : "off: the graph has no profile";
  }

  const Use* end_of_pass(const Use& use) const {
    return versions.uses.data() + versions.first_use[use.pass.value + 1];
  }

  bool first_of_binding(const Use& use) const {
    return &use == versions.uses_of(use.pass).data() || (&use - 1)->binding != use.binding;
  }

  // Names the range as the file does, without the frame.
  std::string seen_text(const Use& use) const {
    const PortBinding& binding = graph.bindings_of(graph.passes[use.pass.value])[use.binding];
    return name_of(graph, use.requested) + image_range_text(binding.range);
  }

  // Omits mips and layers that the range covers completely.
  ImageRange part_of(const Use& use) const {
    const SubresourceRange& range = subresources.ranges[use.subresource];
    ImageRange named;
    if (range.mips != sizes.extents[use.requested.value].mips) {
      named.first_mip = static_cast<uint8_t>(range.first_mip);
      named.mips = static_cast<uint8_t>(range.mips);
    }
    if (range.layers != sizes.info[use.requested.value].layers) {
      named.first_layer = range.first_layer;
      named.layers = range.layers;
    }
    return named;
  }

  // Lists the ranges of the binding that no pass writes: "'chain#1' or 'chain#4..5'".
  std::string unwritten_ranges(const Use& use) const {
    std::vector<std::string> names;
    for (const Use* at = &use; at != end_of_pass(use); ++at) {
      if (at->binding != use.binding || versions.is_written(*at)) continue;
      names.push_back(name_of(graph, use.requested) + image_range_text(part_of(*at)));
    }
    return list_words(std::vector<std::string_view>(names.begin(), names.end()));
  }

  // Adds the passes that would write the missing ranges, on or off: the likely cause.
  void relate_producers(Diagnostic& diagnostic, const Use& use) {
    relate_producers(diagnostic, use.requested, [&](const PortBinding& written) {
      if (!subresources.divided(use.requested)) return true;
      for (const Use* at = &use; at != end_of_pass(use); ++at)
        if (at->binding == use.binding && !versions.is_written(*at) &&
            overlaps(written.range, subresources.ranges[at->subresource]))
          return true;
      return false;
    });
  }

  void relate_producers(Diagnostic& diagnostic, ResourceId resource) {
    relate_producers(diagnostic, resource, [](const PortBinding&) { return true; });
  }

  void relate_producers(Diagnostic& diagnostic, ResourceId resource, const auto& counts) {
    for (uint32_t i = 0; i < graph.passes.size(); ++i)
      for (const PortBinding& binding : graph.writes(graph.passes[i]))
        if (binding.resource == resource && counts(binding))
          diagnostic.related.emplace_back(
              graph.place_of(binding),
              fmt::format("'{}' writes it and is {}", name_of(graph, PassId{i}), state_of(PassId{i})));
  }

  // Marks the producers of all bound exports.
  void visit_exports() {
    for (uint32_t i = 0; i < graph.resources.size(); ++i) {
      if (!sizes.info[i].exported || !sizes.info[i].bound) continue;
      if (versions.final_version[i] != invalid_index) {
        mark_producer(versions.final_version[i], Reason::ReasonKind::writes_export, i);
      } else if (sizes.info[i].optional) {
        report.record_reason(Reason::About::resource, i, Reason::ReasonKind::unwritten_export);
      } else {
        const ResourceDeclaration& declared = graph.resources[i];
        auto& diagnostic =
            report.diagnostics.add(DiagnosticId::export_unwritten, declared.where,
                                   fmt::format("no pass that is on writes the export '{}'", declared.name));
        relate_producers(diagnostic, ResourceId{i});
      }
    }
  }
};

} // namespace

const LiveSet& cull(const CompileInput& in, const Sizes& sizes, const Activation& active,
                    const Subresources& subresources, const Versions& versions, Report& report,
                    CullScratch& scratch) {
  const Graph& graph = *in.graph;
  LiveSet& live = scratch.result;
  const auto passes = static_cast<uint32_t>(graph.passes.size());
  live.passes.assign(passes, 0);
  scratch.unvisited.assign((passes + 63) / 64, 0);
  scratch.reported.assign(graph.resources.size(), 0);
  Culler culler{in, graph, sizes, active, subresources, versions, report, scratch};
  culler.visit_exports();
  for (uint32_t i = 0; i < passes; ++i)
    if (active.on[i] && active.type(PassId{i}).side_effects)
      culler.mark_live(PassId{i}, Reason::ReasonKind::side_effects);
  culler.visit_all();
  if (!in.cull) culler.keep_runnable();
  for (uint32_t i = 0; i < passes; ++i)
    if (active.on[i] && !live.passes[i])
      report.record_reason(Reason::About::pass, i, Reason::ReasonKind::not_needed);
  return live;
}

} // namespace dermis
