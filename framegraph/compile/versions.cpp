// Which version of which resource each port sees. Versions follow the order of the file; a pass that is off
// makes the names it would have written stand for their `otherwise`.

#include "framegraph/compile/phases.hpp"
#include "framegraph/text/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

namespace dermis {
namespace {

struct VersionScan {
  CompileContext& c;
  uint64_t part_uses = 0;
  std::pair<PassId, uint16_t> refused{};

  void begin() {
    const size_t resources = c.graph->resources.size();
    const size_t parts = std::max(resources, c.parts.size());
    c.values.clear();
    c.uses.clear();
    c.first_use.clear();
    c.forward.clear();
    c.overwrites = false;
    c.current.assign(parts, {});
    c.last_version.assign(parts, no_value);
    c.definitions.assign(parts, {});
    for (uint32_t i = 0; i < resources; ++i) {
      if (!c.info[i].imported || !c.bound[i]) continue;
      c.current[i].value = add_value({ResourceId{i}, 0, PassId{}, no_value});
      c.last_version[i] = c.current[i].value;
    }
  }

  uint32_t add_value(Value value) {
    c.values.push_back(value);
    return static_cast<uint32_t>(c.values.size() - 1);
  }

  bool unbound_import(ResourceId id) const { return c.info[id.value].imported && !c.bound[id.value]; }

  // One use for each part that the port sees.
  void add_parts(Use use, const ImagePart& seen) {
    for (uint32_t i = 0; i < c.info[use.requested.value].parts; ++i) {
      use.part = c.part_number(use.requested, i);
      if (meets(seen, c.parts[use.part])) c.uses.push_back(use);
    }
    part_uses += c.info[use.requested.value].parts;
  }

  // A port of which no part can be read is not bound; one of which some parts can is refused, unless the
  // others wait for a profile and the port is optional.
  void spread_trouble() {
    for (size_t first = 0; first < c.uses.size();) {
      const Use& one = c.uses[first];
      size_t end = first + 1;
      while (end < c.uses.size() && c.uses[end].pass == one.pass && c.uses[end].port == one.port &&
             c.uses[end].binding == one.binding)
        ++end;
      spread_trouble(std::span(c.uses).subspan(first, end - first));
      first = end;
    }
  }

  // Whether all passes that would write what the use reads are off for want of a profile.
  bool lacks_profile(const Use& use) const {
    bool unmet = false;
    for (const PassDeclaration& pass : c.graph->passes)
      for (const PortBinding& written : c.graph->writes(pass)) {
        if (written.resource != use.requested || !meets(written.part, c.parts[use.part])) continue;
        if (pass.absence == PassDeclaration::Absence::none) return false;
        unmet = true;
      }
    return unmet;
  }

  // `uses` are the parts of one binding.
  void spread_trouble(std::span<Use> uses) const {
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
    const bool partly = some && !(c.type(bad->pass).ports[bad->port].optional &&
                                  std::all_of(uses.begin(), uses.end(), may_be_missing));
    const BindError all = partly ? BindError::partly_unwritten : bad->bind_error;
    for (Use& use : uses)
      if (partly || use.bind_error == BindError::none) use.bind_error = all;
  }

  void scan_uses(PassId pass) {
    const PassDeclaration& declared = c.graph->passes[pass.value];
    const PassType& type = (*c.pass_types)[declared.type];
    const auto first = static_cast<uint32_t>(c.uses.size());
    c.first_use.push_back(first);
    uint16_t number = 0;
    uint32_t port_before = 0;
    bool sorted = true;
    for (const PortBinding& binding : c.graph->bindings_of(declared)) {
      sorted &= port_before <= binding.port;
      port_before = binding.port;
      Use& use = c.uses.emplace_back();
      use.pass = pass;
      use.port = static_cast<uint16_t>(binding.port);
      use.usage = type.ports[binding.port].usage;
      const UsageInfo& usage = usage_info(use.usage);
      use.reads = usage.reads;
      use.writes = usage.writes;
      use.resource = use.requested = binding.resource;
      use.frames_back = binding.frames_back;
      use.when = binding.when;
      use.part = use.requested.value;
      use.binding = number++;
      if (c.split(use.requested)) {
        const Use whole = use;
        c.uses.pop_back();
        add_parts(whole, binding.part);
      }
    }
    if (!sorted)
      std::stable_sort(c.uses.begin() + first, c.uses.end(),
                       [](const Use& a, const Use& b) { return a.port < b.port; });
    const auto end = static_cast<uint32_t>(c.uses.size());
    for (uint32_t u = first; u < end; ++u)
      read(c.uses[u], u);
    for (uint32_t u = first; u < end; ++u)
      write(c.uses[u]);
  }

  void read(Use& use, uint32_t index) {
    if (!use.reads || use.frames_back > 0) return;
    const Binding& meaning = c.current[use.part];
    if (unbound_import(use.requested))
      use.bind_error = Use::BindError::unbound;
    else if (meaning.value != no_value)
      see(use, meaning.value);
    else
      c.forward.emplace_back(index, meaning.later.valid() ? meaning.later.value : use.part);
  }

  void see(Use& use, uint32_t value) {
    use.read_value = value;
    use.resource = c.values[value].resource;
    if (use.writes && use.resource != use.requested) use.bind_error = Use::BindError::replaced;
  }

  bool reads_too(PassId pass, uint32_t part) const {
    for (uint32_t u = c.first_use[pass.value]; u < c.uses.size(); ++u) {
      const Use& use = c.uses[u];
      if (use.part == part && use.frames_back == 0 && use.reads) return true;
    }
    return false;
  }

  void write(Use& use) {
    if (!use.writes) return;
    if (unbound_import(use.requested)) {
      use.bind_error = Use::BindError::unbound;
      return;
    }
    const uint32_t id = use.requested.value;
    const uint32_t before = c.current[use.part].value;
    const PassId producer = before == no_value ? PassId{} : c.values[before].producer;
    const bool own = before != no_value && c.values[before].resource == use.requested;
    const bool second = own && (producer == use.pass ||
                                (!c.info[id].imported && producer.valid() && !reads_too(use.pass, use.part)));
    if (second) return report_second(use, producer);
    const uint32_t previous = c.last_version[use.part];
    const uint32_t version = previous == no_value ? 1 : c.values[previous].version + 1;
    c.overwrites |= previous != no_value;
    use.write_value = add_value({use.requested, version, use.pass, previous});
    c.last_version[use.part] = use.write_value;
    c.current[use.part] = {use.write_value, {}};
    ResourceDef& definition = c.definitions[use.part];
    if (++definition.producers == 1) definition.first_value = use.write_value;
  }

  void report_second(const Use& use, PassId producer) {
    const std::pair port{use.pass, use.port};
    if (std::exchange(refused, port) == port) return; // another part of what it writes
    auto& diagnostic = c.diagnostics->add(
        DiagnosticId::second_producer, c.place_of(use),
        producer == use.pass
            ? fmt::format("pass '{}' writes '{}' through two ports", c.name(use.pass), c.name(use.requested))
            : fmt::format("passes '{}' and '{}' both write '{}', and '{}' does not read what '{}' wrote",
                          c.name(producer), c.name(use.pass), c.name(use.requested), c.name(use.pass),
                          c.name(producer)));
    diagnostic.related.emplace_back(c.graph->passes[producer.value].where,
                                    fmt::format("'{}' is declared here", c.name(producer)));
  }

  void scan_otherwise(PassId pass) {
    c.first_use.push_back(static_cast<uint32_t>(c.uses.size()));
    std::vector<std::pair<ResourceId, Binding>> replaced; // all look at the state before the pass
    for (const PassThrough& through : c.graph->passes[pass.value].otherwise) {
      if (c.graph->resources[through.output.value].type != c.graph->resources[through.instead.value].type) {
        c.diagnostics->add(DiagnosticId::otherwise_mismatch, through.where,
                           fmt::format("'{}' cannot stand in for '{}': one is {}, the other {}",
                                       c.name(through.instead), c.name(through.output),
                                       type_phrase(c.graph->resources[through.instead.value].type),
                                       type_phrase(c.graph->resources[through.output.value].type)));
        continue;
      }
      if (c.split(through.output) || c.split(through.instead)) {
        c.diagnostics->add(DiagnosticId::otherwise_mismatch, through.where,
                           fmt::format("'{}' cannot stand in for '{}': ports name parts of '{}'",
                                       c.name(through.instead), c.name(through.output),
                                       c.name(c.split(through.output) ? through.output : through.instead)));
        continue;
      }
      Binding meaning = c.current[through.instead.value];
      if (meaning.value == no_value && !meaning.later.valid()) meaning.later = through.instead;
      replaced.emplace_back(through.output, meaning);
      c.record_reason(Reason::About::resource, through.output.value, Reason::ReasonKind::stands_for,
                      through.instead.value, pass.value);
    }
    for (const auto& [output, meaning] : replaced) {
      ResourceDef& definition = c.definitions[output.value];
      if (!definition.replaced) {
        definition.replaced = true;
        definition.instead = meaning;
      }
      c.current[output.value] = meaning;
    }
  }

  // A reader before all writers sees the only producer's version. Follows `otherwise` at most once per
  // resource.
  void look_ahead(uint32_t index, uint32_t part) {
    Use& use = c.uses[index];
    for (size_t step = 0; step <= c.definitions.size(); ++step) {
      const ResourceDef& definition = c.definitions[part];
      const bool writes_it = definition.first_value != no_value && writes(use.pass, part);
      if (part < c.graph->resources.size() && unbound_import(ResourceId{part})) {
        use.bind_error = Use::BindError::unbound;
        return;
      }
      if (definition.producers == 1 && !writes_it) return see(use, definition.first_value);
      if (definition.producers > 0) {
        use.bind_error = writes_it ? Use::BindError::unwritten : Use::BindError::ambiguous;
        return;
      }
      if (!definition.replaced) break;
      if (definition.instead.value != no_value) return see(use, definition.instead.value);
      part = definition.instead.later.value;
    }
    use.bind_error = Use::BindError::unwritten;
  }

  bool writes(PassId pass, uint32_t part) const {
    for (uint32_t u = c.first_use[pass.value]; u < c.first_use[pass.value + 1]; ++u)
      if (c.uses[u].part == part && c.uses[u].write_value != no_value) return true;
    return false;
  }
};

} // namespace

void resolve_versions(CompileContext& c) {
  VersionScan scan{c};
  scan.begin();
  const auto passes = static_cast<uint32_t>(c.graph->passes.size());
  for (uint32_t i = 0; i < passes; ++i) {
    if (c.on[i])
      scan.scan_uses(PassId{i});
    else
      scan.scan_otherwise(PassId{i});
    if (scan.part_uses <= limits::part_uses) continue;
    c.diagnostics->add(DiagnosticId::limit_exceeded, c.graph->passes[i].where,
                       fmt::format("ports see more than {} parts of images", limits::part_uses));
    return;
  }
  c.first_use.push_back(static_cast<uint32_t>(c.uses.size()));
  for (const auto& [use, part] : c.forward)
    scan.look_ahead(use, part);

  c.final_value.assign(c.current.size(), no_value);
  const size_t resources = c.graph->resources.size(), parts = c.final_value.size();
  for (uint32_t i = 0; i < parts; ++i) {
    const uint32_t last = c.current[i].value; // parts have no stand-ins
    const bool further = i >= resources;
    if (last != no_value && (further || c.values[last].resource == ResourceId{i})) c.final_value[i] = last;
  }
  for (Use& use : c.uses)
    if (use.frames_back > 0 && c.final_value[use.part] == no_value)
      use.bind_error = Use::BindError::history_unwritten;
  if (c.graph->parts) scan.spread_trouble();
}

} // namespace dermis
