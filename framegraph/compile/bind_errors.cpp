// Reports bindings without a version: ports of live passes, and exports. Ports of passes that are
// culled may lack one.

#include "framegraph/compile/phases.hpp"
#include "framegraph/model/image_range.hpp"
#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>

namespace dermis {
namespace {

struct BindErrorReporter {
  const Graph& graph;
  const Sizes& sizes;
  const Activation& active;
  const Subresources& subresources;
  const Versions& versions;
  Report& report;
  std::vector<uint8_t>& reported; // by resource: one root cause gives one diagnostic

  // Returns whether the port reads its substitute in every frame, because no pass writes the
  // history.
  bool has_substitute(const Use& use) const {
    if (use.when != ReadWhen::history_valid || use.bind_error != Use::BindError::history_unwritten)
      return false;
    // The substitute follows all subresources of the history, at the same port.
    const Use* next = &use + 1;
    while (next != end_of_pass(use) && next->binding == use.binding)
      ++next;
    return next != end_of_pass(use) && next->when == ReadWhen::history_invalid &&
           next->port == use.port && next->bind_error == Use::BindError::none;
  }

  // Returns whether the pass cannot run without the port. Of several alternative ports the first is
  // reported.
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

  // Reports a port without a version. A missing version is not an error at an optional port.
  void report_use(const Use& use) {
    const Port& port = active.type(use.pass).ports[use.port];
    const bool missing = use.bind_error == Use::BindError::unbound ||
                         use.bind_error == Use::BindError::unwritten ||
                         use.bind_error == Use::BindError::history_unwritten;
    if (has_substitute(use)) {
      if (first_of_binding(use))
        report.record_reason(Reason::About::pass, use.pass.value,
                             Reason::ReasonKind::always_otherwise, use.port, use.requested.value);
      return;
    }
    if (missing && !is_required(use)) {
      if (first_of_binding(use))
        report.record_reason(Reason::About::pass, use.pass.value, Reason::ReasonKind::port_unbound,
                             use.port, use.requested.value);
      return;
    }
    if (reported[use.requested.value]) return;
    reported[use.requested.value] = 1;
    const auto report_error = [&](DiagnosticId id, std::string text) {
      auto& diagnostic = report.diagnostics.add(id, location_of(graph, use), std::move(text));
      const auto relate_declaration = [&](ResourceId declared) {
        diagnostic.related.emplace_back(
            graph.resources[declared.value].where,
            fmt::format("'{}' is declared here", name_of(graph, declared)));
      };
      relate_declaration(use.requested);
      if (use.resource != use.requested) relate_declaration(use.resource);
      relate_producers(diagnostic, use);
    };
    const std::string reader =
        fmt::format("pass '{}', port '{}'", name_of(graph, use.pass), port.name);
    const std::string& resource = name_of(graph, use.requested);
    switch (use.bind_error) {
    case Use::BindError::none:
      break;
    case Use::BindError::unbound:
      return report_error(
          DiagnosticId::unbound_import,
          use.resource == use.requested
              ? fmt::format("{} needs '{}', which the host leaves unbound", reader, resource)
              : fmt::format("{} needs '{}', whose producer is off, so that '{}' replaces it, "
                            "and the host leaves '{}' unbound",
                            reader, resource, name_of(graph, use.resource),
                            name_of(graph, use.resource)));
    case Use::BindError::unwritten:
      return report_error(DiagnosticId::read_before_write,
                          fmt::format("{} reads '{}', which no pass that is on writes before it",
                                      reader, seen_text(use)));
    case Use::BindError::ambiguous:
      return report_error(
          DiagnosticId::ambiguous_version,
          fmt::format("{} reads '{}' before any pass wrote it, and several write it later", reader,
                      resource));
    case Use::BindError::replaced:
      return report_error(
          DiagnosticId::replaced_update,
          fmt::format(
              "{0} updates '{1}' in place, but the producer of '{1}' is off and '{2}' replaces it",
              reader, resource, name_of(graph, use.resource)));
    case Use::BindError::history_unwritten:
      return report_error(DiagnosticId::history_unwritten,
                          fmt::format("{0} reads '{1}@-{2}', but no pass that is on writes '{1}'",
                                      reader, seen_text(use), use.frames_back));
    case Use::BindError::partly_unwritten:
      return use.frames_back > 0
                 ? report_error(DiagnosticId::history_unwritten,
                                fmt::format("{} reads '{}@-{}', but no pass that is on writes {}",
                                            reader, seen_text(use), use.frames_back,
                                            unwritten_ranges(use)))
                 : report_error(
                       DiagnosticId::read_before_write,
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

  void relate_producers(Diagnostic& diagnostic, ResourceId resource, const auto& counts) {
    constexpr size_t most = 16; // places; a graph may have thousands of passes
    size_t found = 0;
    SourceLocation next; // the first place that is left out
    for (uint32_t i = 0; i < graph.passes.size(); ++i)
      for (const PortBinding& binding : graph.writes(graph.passes[i])) {
        if (binding.resource != resource || !counts(binding)) continue;
        if (++found <= most)
          diagnostic.related.emplace_back(
              graph.place_of(binding), fmt::format("'{}' writes it and is {}",
                                                   name_of(graph, PassId{i}), state_of(PassId{i})));
        else if (found == most + 1)
          next = graph.place_of(binding);
      }
    if (found > most)
      diagnostic.related.emplace_back(
          next, fmt::format("this pass and {} more write it, too", found - most - 1));
  }

  // Reports a bound export that no pass writes.
  void report_export(uint32_t i) {
    const ResourceDeclaration& declared = graph.resources[i];
    if (sizes.info[i].optional) {
      report.record_reason(Reason::About::resource, i, Reason::ReasonKind::unwritten_export);
      return;
    }
    auto& diagnostic = report.diagnostics.add(
        DiagnosticId::export_unwritten, declared.where,
        fmt::format("no pass that is on writes the export '{}'", declared.name));
    relate_producers(diagnostic, ResourceId{i}, [](const PortBinding&) { return true; });
  }
};

} // namespace

void report_bind_errors(const CompileInput& in, const Sizes& sizes, const Activation& active,
                        const Subresources& subresources, const Versions& versions,
                        const LiveSet& live, Report& report, BindErrorScratch& scratch) {
  const Graph& graph = *in.graph;
  scratch.reported.assign(graph.resources.size(), 0);
  BindErrorReporter reporter{graph,    sizes,  active,          subresources,
                             versions, report, scratch.reported};
  for (uint32_t i = 0; i < graph.resources.size(); ++i)
    if (sizes.info[i].exported && sizes.info[i].bound && versions.final_version[i] == invalid_index)
      reporter.report_export(i);
  for (const uint32_t use : live.failed_uses)
    reporter.report_use(versions.uses[use]);
}

} // namespace dermis
