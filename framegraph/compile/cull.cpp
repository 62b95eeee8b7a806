// Which passes run: those with side effects, those that write a bound export, and whatever these read.

#include "framegraph/compile/phases.hpp"
#include "framegraph/model/image_part.hpp"
#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace dermis {
namespace {

struct Culler {
  CompileContext& c;

  PassId following{};                         // whose reads are looked at
  std::vector<uint64_t>& waiting = c.waiting; // bit set of passes that are needed and not yet followed

  void need(PassId pass, Reason::ReasonKind why, uint32_t a = 0, uint32_t b = 0) {
    if (c.input->reasons && !c.live[pass.value]) c.record_reason(Reason::About::pass, pass.value, why, a, b);
    waiting[pass.value / 64] |= uint64_t{c.live[pass.value] == 0} << pass.value % 64;
    c.live[pass.value] = 1;
  }

  void need_value(uint32_t value, Reason::ReasonKind why, uint32_t a, uint32_t b = 0) {
    if (value != no_value && c.values[value].producer.valid()) need(c.values[value].producer, why, a, b);
  }

  // Likewise, for the pass that is followed: it stands in for a producer that there is not, since it runs
  // anyway.
  void need_producer(uint32_t value, Reason::ReasonKind why, uint32_t a, uint32_t b) {
    if (c.values.empty()) return;
    const PassId producer = c.values[pick(value != no_value, value, 0u)].producer;
    const bool exists = (int{value != no_value} & int{producer.valid()}) != 0;
    need(PassId{pick(exists, producer.value, following.value)}, why, a, b);
  }

  void follow(PassId pass) {
    for (uint32_t u = c.first_use[pass.value]; u < c.first_use[pass.value + 1]; ++u) {
      const Use& use = c.uses[u];
      if (use.bind_error != Use::BindError::none) {
        examine(use);
        continue;
      }
      const uint32_t resource = use.resource.value;
      if (use.frames_back > 0)
        need_value(c.final_value[use.part], Reason::ReasonKind::read_later_by, pass.value, resource);
      need_producer(use.read_value, Reason::ReasonKind::read_by, pass.value, resource);
      // What is written in place may keep texels of the version before.
      if (c.overwrites && use.write_value != no_value)
        need_value(c.values[use.write_value].previous, Reason::ReasonKind::written_over_by, pass.value,
                   resource);
    }
  }

  // Most passes stand behind those that they need: the last one first, once.
  void follow_all() {
    for (bool any = true; any;) {
      any = false;
      for (size_t word = waiting.size(); word-- > 0;) {
        uint64_t below = ~uint64_t{0}; // passes of this word that come before the one followed last
        while (const uint64_t left = waiting[word] & below) {
          const auto bit = static_cast<uint32_t>(std::bit_width(left) - 1);
          below = (uint64_t{1} << bit) - 1;
          waiting[word] &= ~(uint64_t{1} << bit);
          any = true;
          following = PassId{static_cast<uint32_t>(word * 64 + bit)};
          follow(following);
        }
      }
    }
  }

  // Without culling: every pass that has all it needs, and whatever these read.
  void keep_runnable() {
    std::vector<uint8_t> unmet(c.live.size(), 0);
    for (const Use& use : c.uses)
      if (use.bind_error != Use::BindError::none) unmet[use.pass.value] = 1;
    for (uint32_t i = 0; i < c.live.size(); ++i)
      if (c.on[i] && !unmet[i]) need(PassId{i}, Reason::ReasonKind::culling_off);
    for (bool again = true; again;) { // a pass needs all its producers to have what they need
      again = false;
      for (const Use& use : c.uses) {
        if (!c.live[use.pass.value] || use.read_value == no_value) continue;
        const PassId producer = c.values[use.read_value].producer;
        if (!producer.valid() || c.live[producer.value]) continue;
        c.live[use.pass.value] = 0;
        again = true;
      }
    }
  }

  // A history that nobody writes is never valid: where the port says what it reads then, it always reads
  // that.
  bool has_placeholder(const Use& use) const {
    if (use.when != ReadWhen::history_valid || use.bind_error != Use::BindError::history_unwritten)
      return false;
    const Use* next = &use + 1; // the stand-in stands behind it, at the same port
    const bool last = next == c.uses.data() + c.first_use[use.pass.value + 1];
    return !last && next->when == ReadWhen::history_invalid && next->port == use.port &&
           next->bind_error == Use::BindError::none;
  }

  // Whether the pass has no other port to go on with. Of several such ports the first is told.
  bool needs_it(const Use& use) const {
    const PassType& type = c.type(use.pass);
    if (!type.ports[use.port].optional) return true;
    if (!is_one_of(type, use.port)) return false;
    for (uint32_t u = c.first_use[use.pass.value]; u < c.first_use[use.pass.value + 1]; ++u) {
      const Use& other = c.uses[u];
      if (!is_one_of(type, other.port)) continue;
      if (other.bind_error == Use::BindError::none || &other < &use) return false;
    }
    return true;
  }

  // A port of a pass that runs has nothing behind it: fine for an optional port, except for ambiguity.
  void examine(const Use& use) {
    const Port& port = c.type(use.pass).ports[use.port];
    const bool missing = use.bind_error == Use::BindError::unbound ||
                         use.bind_error == Use::BindError::unwritten ||
                         use.bind_error == Use::BindError::history_unwritten;
    if (has_placeholder(use)) {
      c.record_reason(Reason::About::pass, use.pass.value, Reason::ReasonKind::always_otherwise, use.port,
                      use.requested.value);
      return;
    }
    if (missing && !needs_it(use)) {
      if (first_of_binding(use))
        c.record_reason(Reason::About::pass, use.pass.value, Reason::ReasonKind::port_unbound, use.port,
                        use.requested.value);
      return;
    }
    if (c.reported[use.requested.value]) return;
    c.reported[use.requested.value] = 1;
    const auto refuse = [&](DiagnosticId id, std::string text) {
      auto& diagnostic = c.diagnostics->add(id, c.place_of(use), std::move(text));
      diagnostic.related.emplace_back(c.graph->resources[use.requested.value].where,
                                      fmt::format("'{}' is declared here", c.name(use.requested)));
      relate_producers(diagnostic, use);
    };
    const std::string reader = fmt::format("pass '{}', port '{}'", c.name(use.pass), port.name);
    const std::string& resource = c.name(use.requested);
    switch (use.bind_error) {
    case Use::BindError::none:
      break;
    case Use::BindError::unbound:
      return refuse(DiagnosticId::unbound_import,
                    fmt::format("{} needs '{}', which the host leaves unbound", reader, resource));
    case Use::BindError::unwritten:
      return refuse(
          DiagnosticId::read_before_write,
          fmt::format("{} reads '{}', which no pass that is on writes before it", reader, seen_text(use)));
    case Use::BindError::ambiguous:
      return refuse(DiagnosticId::ambiguous_version,
                    fmt::format("{} reads '{}' before any pass wrote it, and several write it later", reader,
                                resource));
    case Use::BindError::replaced:
      return refuse(
          DiagnosticId::replaced_update,
          fmt::format("{} updates '{}' in place, but it stands for '{}' because its producer is off", reader,
                      resource, c.name(use.resource)));
    case Use::BindError::history_unwritten:
      return refuse(DiagnosticId::history_unwritten,
                    fmt::format("{0} reads '{1}@-{2}', but no pass that is on writes '{1}'", reader,
                                seen_text(use), use.frames_back));
    case Use::BindError::partly_unwritten:
      return use.frames_back > 0
                 ? refuse(DiagnosticId::history_unwritten,
                          fmt::format("{} reads '{}@-{}', but no pass that is on writes {}", reader,
                                      seen_text(use), use.frames_back, unwritten_parts(use)))
                 : refuse(DiagnosticId::read_before_write,
                          fmt::format("{} reads '{}', but no pass that is on writes {} before it", reader,
                                      seen_text(use), unwritten_parts(use)));
    }
  }

  const char* state_of(PassId pass) const {
    if (c.on[pass.value]) return "on";
    const bool by_settings = c.graph->passes[pass.value].absence == PassDeclaration::Absence::none;
    return by_settings ? "off with these settings" : "off: the graph has no profile";
  }

  bool first_of_binding(const Use& use) const {
    const Use* before = &use - 1;
    return c.first_use[use.pass.value] == static_cast<uint32_t>(&use - c.uses.data()) ||
           before->binding != use.binding;
  }

  // Names the part that the port sees as the file does, without the frame.
  std::string seen_text(const Use& use) const {
    const PortBinding& binding = c.graph->bindings_of(c.graph->passes[use.pass.value])[use.binding];
    return c.name(use.requested) + part_text(binding.part);
  }

  // Without the numbers that the part has all of.
  ImagePart part_of(const Use& use) const {
    const SubresourceRange& range = c.parts[use.part];
    ImagePart part;
    if (range.mips != c.extents[use.requested.value].mips) {
      part.first_mip = static_cast<uint8_t>(range.first_mip);
      part.mips = static_cast<uint8_t>(range.mips);
    }
    if (range.layers != c.info[use.requested.value].layers) {
      part.first_layer = range.first_layer;
      part.layers = range.layers;
    }
    return part;
  }

  // The parts of the binding that nobody writes: "'chain#1' or 'chain#4..5'".
  std::string unwritten_parts(const Use& use) const {
    std::vector<std::string> names;
    for (const Use* at = &use; at != c.uses.data() + c.first_use[use.pass.value + 1]; ++at) {
      if (at->binding != use.binding || c.is_written(*at)) continue;
      names.push_back(c.name(use.requested) + part_text(part_of(*at)));
    }
    return list_words(std::vector<std::string_view>(names.begin(), names.end()));
  }

  // Locates the passes that would write the missing parts, on or off: the likely cause.
  void relate_producers(Diagnostic& diagnostic, const Use& use) {
    relate_producers(diagnostic, use.requested, [&](const PortBinding& written) {
      if (!c.split(use.requested)) return true;
      for (const Use* at = &use; at != c.uses.data() + c.first_use[use.pass.value + 1]; ++at)
        if (at->binding == use.binding && !c.is_written(*at) && meets(written.part, c.parts[at->part]))
          return true;
      return false;
    });
  }

  void relate_producers(Diagnostic& diagnostic, ResourceId resource) {
    relate_producers(diagnostic, resource, [](const PortBinding&) { return true; });
  }

  void relate_producers(Diagnostic& diagnostic, ResourceId resource, const auto& counts) {
    for (uint32_t i = 0; i < c.graph->passes.size(); ++i)
      for (const PortBinding& binding : c.graph->writes(c.graph->passes[i]))
        if (binding.resource == resource && counts(binding))
          diagnostic.related.emplace_back(
              c.graph->place_of(binding),
              fmt::format("'{}' writes it and is {}", c.name(PassId{i}), state_of(PassId{i})));
  }
};

} // namespace

void cull(CompileContext& c) {
  const auto passes = static_cast<uint32_t>(c.graph->passes.size());
  c.live.assign(passes, 0);
  c.waiting.assign((passes + 63) / 64, 0);
  c.reported.assign(c.graph->resources.size(), 0);
  Culler culler{c};
  for (uint32_t i = 0; i < c.graph->resources.size(); ++i) {
    if (!c.info[i].exported || !c.bound[i]) continue;
    if (c.final_value[i] != no_value) {
      culler.need_value(c.final_value[i], Reason::ReasonKind::writes_export, i);
    } else if (c.info[i].optional) {
      c.record_reason(Reason::About::resource, i, Reason::ReasonKind::unwritten_export);
    } else {
      const ResourceDeclaration& declared = c.graph->resources[i];
      auto& diagnostic =
          c.diagnostics->add(DiagnosticId::export_unwritten, declared.where,
                             fmt::format("no pass that is on writes the export '{}'", declared.name));
      culler.relate_producers(diagnostic, ResourceId{i});
    }
  }
  for (uint32_t i = 0; i < passes; ++i)
    if (c.on[i] && c.type(PassId{i}).side_effects) culler.need(PassId{i}, Reason::ReasonKind::side_effects);
  culler.follow_all();
  if (!c.input->cull) culler.keep_runnable();
  for (uint32_t i = 0; i < passes; ++i)
    if (c.on[i] && !c.live[i]) c.record_reason(Reason::About::pass, i, Reason::ReasonKind::not_needed);
}

} // namespace dermis
