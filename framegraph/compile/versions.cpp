// Resolves which version of which resource each port accesses. Versions follow the order of the
// file. If a pass is off, the names that it would have written refer to their `otherwise` instead.

#include "framegraph/compile/phases.hpp"
#include "framegraph/text/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

namespace dermis {
namespace {

struct VersionResolver {
  const CompileInput& in;
  const Graph& graph;
  const Sizes& sizes;
  const Activation& active;
  const Subresources& subresources;
  Report& report;
  VersionScratch& scratch;
  Versions& versions = scratch.result;
  const bool any_divided = subresources.any();
  uint64_t divided_uses = 0; // uses of divided images, for limits::range_uses
  std::pair<PassId, uint16_t> last_second_producer{}; // pass and port reported last

  void begin() {
    const size_t resources = graph.resources.size();
    const size_t count = std::max(resources, subresources.ranges.size());
    versions.list.clear();
    versions.uses.clear();
    versions.first_use.clear();
    scratch.forward_references.clear();
    versions.overwrites = false;
    scratch.current.assign(count, {});
    scratch.last_version.assign(count, invalid_index);
    scratch.definitions.assign(count, {});
    find_unneeded();
    for (uint32_t i = 0; i < resources; ++i) {
      if (!sizes.info[i].imported || !sizes.info[i].bound) continue;
      scratch.current[i].version = add_version({ResourceId{i}, 0, PassId{}, invalid_index});
      scratch.last_version[i] = scratch.current[i].version;
    }
  }

  uint32_t add_version(Version version) {
    versions.list.push_back(version);
    return static_cast<uint32_t>(versions.list.size() - 1);
  }

  // Finds the exports that the host leaves unbound and that are only read at optional ports of
  // passes that write them: nobody needs their contents, so optional ports are unbound too.
  void find_unneeded() {
    const auto unbound_export = [](const ResourceInfo& info) {
      return info.exported && !info.imported && !info.bound && !info.history;
    };
    scratch.unneeded.clear();
    if (std::none_of(sizes.info.begin(), sizes.info.end(), unbound_export)) return;
    for (const ResourceInfo& info : sizes.info)
      scratch.unneeded.push_back(unbound_export(info));
    for (uint32_t i = 0; i < graph.passes.size(); ++i) {
      const PassDeclaration& pass = graph.passes[i];
      const std::span<const Port> ports = active.type(PassId{i}).ports;
      const auto writes = graph.writes(pass);
      for (const PortBinding& read : graph.reads(pass)) {
        if (!ports[read.port].optional ||
            std::none_of(writes.begin(), writes.end(), [&](const PortBinding& written) {
              return written.resource == read.resource;
            }))
          scratch.unneeded[read.resource.value] = 0;
      }
      for (const PortBinding& written : writes)
        if (!ports[written.port].optional && usage_info(ports[written.port].usage).reads)
          scratch.unneeded[written.resource.value] = 0;
      for (const PassThrough& through : pass.otherwise)
        scratch.unneeded[through.instead.value] = 0;
    }
  }

  bool unbound_import(ResourceId id) const {
    return sizes.info[id.value].imported && !sizes.info[id.value].bound;
  }
  bool is_unbound(const Use& use) const {
    return unbound_import(use.requested) ||
           (!scratch.unneeded.empty() && scratch.unneeded[use.requested.value] != 0 &&
            active.type(use.pass).ports[use.port].optional);
  }

  // Adds one use for each subresource range that the port accesses.
  void add_divided(Use use, const ImageRange& seen) {
    for (uint32_t i = 0; i < subresources.counts[use.requested.value]; ++i) {
      use.subresource = subresources.number(use.requested, i);
      if (overlaps(seen, subresources.ranges[use.subresource])) versions.uses.push_back(use);
    }
    divided_uses += subresources.counts[use.requested.value];
  }

  // Gives all uses of one binding the same bind error. A port whose ranges all lack a writer is
  // unbound. A port with some written ranges is an error, unless the port is optional and the
  // others lack only a profile.
  void spread_bind_errors() {
    for (size_t first = 0; first < versions.uses.size();) {
      const Use& one = versions.uses[first];
      size_t end = first + 1;
      while (end < versions.uses.size() && versions.uses[end].pass == one.pass &&
             versions.uses[end].port == one.port && versions.uses[end].binding == one.binding)
        ++end;
      spread_bind_errors(std::span(versions.uses).subspan(first, end - first));
      first = end;
    }
  }

  // Returns whether all passes that would write what the use reads are off because the graph has no
  // profile.
  bool lacks_profile(const Use& use) const {
    bool unmet = false;
    for (const PassDeclaration& pass : graph.passes)
      for (const PortBinding& written : graph.writes(pass)) {
        if (written.resource != use.requested ||
            !overlaps(written.range, subresources.ranges[use.subresource]))
          continue;
        if (pass.absence == PassDeclaration::Absence::none) return false;
        unmet = true;
      }
    return unmet;
  }

  // `uses` belong to one binding.
  void spread_bind_errors(std::span<Use> uses) const {
    using BindError = Use::BindError;
    const auto has = [](BindError bind_error) {
      return [bind_error](const Use& use) { return use.bind_error == bind_error; };
    };
    const auto bad = std::find_if_not(uses.begin(), uses.end(), has(BindError::none));
    if (bad == uses.end()) return;
    const bool missing =
        bad->bind_error == BindError::unwritten || bad->bind_error == BindError::history_unwritten;
    const auto may_be_missing = [&](const Use& use) {
      return use.bind_error == BindError::none || lacks_profile(use);
    };
    const bool some = missing && std::any_of(uses.begin(), uses.end(), has(BindError::none));
    const bool partly = some && !(active.type(bad->pass).ports[bad->port].optional &&
                                  std::all_of(uses.begin(), uses.end(), may_be_missing));
    const BindError all = partly ? BindError::partly_unwritten : bad->bind_error;
    for (Use& use : uses)
      if (partly || use.bind_error == BindError::none) use.bind_error = all;
  }

  void scan_uses(PassId pass) {
    const PassDeclaration& declared = graph.passes[pass.value];
    const PassType& type = (*in.pass_types)[declared.type];
    const auto first = static_cast<uint32_t>(versions.uses.size());
    versions.first_use.push_back(first);
    uint16_t number = 0;
    uint32_t port_before = 0;
    bool sorted = true;
    for (const PortBinding& binding : graph.bindings_of(declared)) {
      sorted &= port_before <= binding.port;
      port_before = binding.port;
      Use& use = versions.uses.emplace_back();
      use.pass = pass;
      use.port = static_cast<uint16_t>(binding.port);
      use.usage = type.ports[binding.port].usage;
      const UsageInfo& usage = usage_info(use.usage);
      use.reads = usage.reads;
      use.writes = usage.writes;
      use.resource = use.requested = binding.resource;
      use.frames_back = binding.frames_back;
      use.when = binding.when;
      use.subresource = use.requested.value;
      use.binding = number++;
      if (any_divided && subresources.divided(use.requested)) {
        const Use whole = use;
        versions.uses.pop_back();
        add_divided(whole, binding.range);
      }
    }
    if (!sorted)
      std::stable_sort(versions.uses.begin() + first, versions.uses.end(),
                       [](const Use& a, const Use& b) { return a.port < b.port; });
    const auto end = static_cast<uint32_t>(versions.uses.size());
    for (uint32_t u = first; u < end; ++u)
      bind_read(versions.uses[u], u);
    for (uint32_t u = first; u < end; ++u)
      bind_write(versions.uses[u]);
  }

  void bind_read(Use& use, uint32_t index) {
    if (!use.reads || use.frames_back > 0) return;
    const VersionScratch::Binding& binding = scratch.current[use.subresource];
    if (is_unbound(use))
      use.bind_error = Use::BindError::unbound;
    else if (binding.version != invalid_index)
      bind_version(use, binding.version);
    else
      scratch.forward_references.push_back(
          {index, binding.later.valid() ? binding.later.value : use.subresource});
  }

  void bind_version(Use& use, uint32_t version) {
    use.read_version = version;
    use.resource = versions[version].resource;
    if (use.writes && use.resource != use.requested) use.bind_error = Use::BindError::replaced;
  }

  bool reads_too(PassId pass, uint32_t subresource) const {
    for (uint32_t u = versions.first_use[pass.value]; u < versions.uses.size(); ++u) {
      const Use& use = versions.uses[u];
      if (use.subresource == subresource && use.frames_back == 0 && use.reads) return true;
    }
    return false;
  }

  void bind_write(Use& use) {
    if (!use.writes) return;
    if (is_unbound(use)) {
      use.bind_error = Use::BindError::unbound;
      return;
    }
    const uint32_t id = use.requested.value;
    const uint32_t before = scratch.current[use.subresource].version;
    const PassId producer = before == invalid_index ? PassId{} : versions[before].producer;
    const bool own = before != invalid_index && versions[before].resource == use.requested;
    const bool second =
        own && (producer == use.pass || (!sizes.info[id].imported && producer.valid() &&
                                         !reads_too(use.pass, use.subresource)));
    if (second) return report_second(use, producer);
    const uint32_t previous = scratch.last_version[use.subresource];
    const uint32_t number = previous == invalid_index ? 1 : versions[previous].number + 1;
    versions.overwrites |= previous != invalid_index;
    use.write_version = add_version({use.requested, number, use.pass, previous});
    scratch.last_version[use.subresource] = use.write_version;
    scratch.current[use.subresource] = {use.write_version, {}};
    VersionScratch::ResourceDef& definition = scratch.definitions[use.subresource];
    if (++definition.producers == 1) definition.first_version = use.write_version;
  }

  void report_second(const Use& use, PassId producer) {
    const std::pair port{use.pass, use.port};
    if (std::exchange(last_second_producer, port) == port) return; // another range of the binding
    auto& diagnostic = report.diagnostics.add(
        DiagnosticId::second_producer, location_of(graph, use),
        producer == use.pass
            ? fmt::format("pass '{}' writes '{}' through two ports", name_of(graph, use.pass),
                          name_of(graph, use.requested))
            : fmt::format(
                  "passes '{}' and '{}' both write '{}', and '{}' does not read what '{}' wrote",
                  name_of(graph, producer), name_of(graph, use.pass), name_of(graph, use.requested),
                  name_of(graph, use.pass), name_of(graph, producer)));
    diagnostic.related.emplace_back(graph.passes[producer.value].where,
                                    fmt::format("'{}' is declared here", name_of(graph, producer)));
  }

  void scan_otherwise(PassId pass) {
    versions.first_use.push_back(static_cast<uint32_t>(versions.uses.size()));
    std::vector<std::pair<ResourceId, VersionScratch::Binding>>
        replaced; // bindings from before the pass
    for (const PassThrough& through : graph.passes[pass.value].otherwise) {
      if (graph.resources[through.output.value].type !=
          graph.resources[through.instead.value].type) {
        report.diagnostics.add(
            DiagnosticId::otherwise_mismatch, through.where,
            fmt::format("'{}' cannot replace '{}': one is {}, the other {}",
                        name_of(graph, through.instead), name_of(graph, through.output),
                        type_phrase(graph.resources[through.instead.value].type),
                        type_phrase(graph.resources[through.output.value].type)));
        continue;
      }
      if (subresources.divided(through.output) || subresources.divided(through.instead)) {
        report.diagnostics.add(
            DiagnosticId::otherwise_mismatch, through.where,
            fmt::format("'{}' cannot replace '{}': ports name mips or layers of '{}'",
                        name_of(graph, through.instead), name_of(graph, through.output),
                        name_of(graph, subresources.divided(through.output) ? through.output
                                                                            : through.instead)));
        continue;
      }
      VersionScratch::Binding binding = scratch.current[through.instead.value];
      if (binding.version == invalid_index && !binding.later.valid())
        binding.later = through.instead;
      replaced.emplace_back(through.output, binding);
      report.record_reason(Reason::About::resource, through.output.value,
                           Reason::ReasonKind::replaced_by, through.instead.value, pass.value);
    }
    for (const auto& [output, binding] : replaced) {
      VersionScratch::ResourceDef& definition = scratch.definitions[output.value];
      if (!definition.replaced) {
        definition.replaced = true;
        definition.substitute = binding;
      }
      scratch.current[output.value] = binding;
    }
  }

  // A use before all writers in file order reads the version of the only producer. Follows
  // `otherwise` at most once per resource.
  void resolve_forward_reference(uint32_t index, uint32_t subresource) {
    Use& use = versions.uses[index];
    for (size_t step = 0; step <= scratch.definitions.size(); ++step) {
      const VersionScratch::ResourceDef& definition = scratch.definitions[subresource];
      const bool writes_it =
          definition.first_version != invalid_index && writes(use.pass, subresource);
      if (subresource < graph.resources.size() && unbound_import(ResourceId{subresource})) {
        use.bind_error = Use::BindError::unbound;
        use.resource = ResourceId{subresource};
        return;
      }
      if (definition.producers == 1 && !writes_it)
        return bind_version(use, definition.first_version);
      if (definition.producers > 0) {
        use.bind_error = writes_it ? Use::BindError::unwritten : Use::BindError::ambiguous;
        return;
      }
      if (!definition.replaced) break;
      if (definition.substitute.version != invalid_index)
        return bind_version(use, definition.substitute.version);
      subresource = definition.substitute.later.value;
    }
    use.bind_error = Use::BindError::unwritten;
  }

  bool writes(PassId pass, uint32_t subresource) const {
    for (uint32_t u = versions.first_use[pass.value]; u < versions.first_use[pass.value + 1]; ++u)
      if (versions.uses[u].subresource == subresource &&
          versions.uses[u].write_version != invalid_index)
        return true;
    return false;
  }

  void find_final_versions() {
    // `otherwise` redirects readers; the resource itself keeps what the last pass that is on wrote.
    versions.final_version = scratch.last_version;
  }
};

} // namespace

const Versions& resolve_versions(const CompileInput& in, const Sizes& sizes,
                                 const Activation& active, const Subresources& subresources,
                                 Report& report, VersionScratch& scratch) {
  const Graph& graph = *in.graph;
  Versions& versions = scratch.result;
  VersionResolver resolver{in, graph, sizes, active, subresources, report, scratch};
  resolver.begin();
  const auto passes = static_cast<uint32_t>(graph.passes.size());
  for (uint32_t i = 0; i < passes; ++i) {
    if (active.on[i])
      resolver.scan_uses(PassId{i});
    else
      resolver.scan_otherwise(PassId{i});
    if (resolver.divided_uses <= limits::range_uses) continue;
    report.diagnostics.add(
        DiagnosticId::limit_exceeded, graph.passes[i].where,
        fmt::format("the ports of the graph together access more than {} subresource ranges",
                    limits::range_uses));
    return versions;
  }
  versions.first_use.push_back(static_cast<uint32_t>(versions.uses.size()));
  for (const auto& [use, subresource] : scratch.forward_references)
    resolver.resolve_forward_reference(use, subresource);
  resolver.find_final_versions();
  for (Use& use : versions.uses)
    if (use.frames_back > 0 && versions.final_version[use.subresource] == invalid_index)
      use.bind_error = Use::BindError::history_unwritten;
  if (subresources.any()) resolver.spread_bind_errors();
  return versions;
}

} // namespace dermis
