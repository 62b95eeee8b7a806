// Checks what passes may read for all values of `when` and `otherwise`. A pass must not read what
// it writes itself, unless the port declares `own_texels`, and the port must support the resource's
// format.

#include "framegraph/model/in_place.hpp"
#include "framegraph/model/expression.hpp"
#include "framegraph/model/image_range.hpp"
#include "framegraph/model/read/graph_reader.hpp"
#include "framegraph/text/limits.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis {

namespace {

struct Write {
  PassId pass;
  ImageRange range;
  ResourceId instead; // valid: readers get it if the pass is off
  SourceLocation where;
};

class Reads {
public:
  explicit Reads(GraphReader& reader) : reader_(reader), writes_(reader.graph.resources.size()) {
    for (uint32_t p = 0; p < graph().passes.size(); ++p)
      for (const PortBinding& binding : graph().writes(graph().passes[p])) {
        Write write{{p}, binding.range, {}, {}};
        for (const PassThrough& through : graph().passes[p].otherwise)
          if (through.output == binding.resource) {
            write.instead = through.instead;
            write.where = through.where;
            replaces_scattering_ = replaces_scattering_ || serves_scattering({p});
          }
        writes_[binding.resource.value].push_back(write);
      }
  }

  // Returns false if no steps of the search are left.
  bool check(PassId id) {
    const PassDeclaration& pass = graph().passes[id.value];
    if (!pass.type.valid() || !condition_known(id)) return true;
    for (const PortBinding& binding : graph().reads(pass)) {
      if (binding.port == unknown_port || binding.frames_back > 0) continue;
      pass_ = id;
      read_ = &binding;
      port_ = &reader_.pass_types[pass.type].ports[binding.port];
      const uint64_t errors = reader_.diagnostics.errors();
      nothing_scatters_ = false;
      follow();
      if (replaces_scattering_ && !serves_scattering(id) &&
          reader_.diagnostics.errors() == errors) {
        nothing_scatters_ = true;
        follow();
      }
      if (steps_left_ == 0) {
        report_limit();
        return false;
      }
    }
    return true;
  }

private:
  const Graph& graph() const { return reader_.graph; }

  // Returns whether the pass has no `when`, or a `when` that could be read.
  bool condition_known(PassId id) const {
    return graph().passes[id.value].when.valid() ||
           !reader_.document.find(reader_.pass_nodes[id.value], "when").valid();
  }

  bool serves_scattering(PassId id) const {
    const PassTypeId type = graph().passes[id.value].type;
    return type.valid() && reader_.pass_types[type].serves_scattering;
  }

  // Walks from the pass backwards. A read sees the last earlier write whose pass is on.
  void follow() {
    conditions_.assign(1, {graph().passes[pass_.value].when, true});
    steps_.clear();
    seen_ = read_->range;
    ResourceId resource = read_->resource;
    uint32_t before = pass_.value; // only writes of earlier passes count
    for (size_t later = 0; later <= writes_.size();) {
      const std::vector<Write>& writes = writes_[resource.value];
      const auto end = std::partition_point(writes.begin(), writes.end(), [&](const Write& write) {
        return write.pass.value < before;
      });
      const Write* replaced = nullptr;
      for (auto at = end; at != writes.begin() && !replaced;) {
        --at;
        if (!spend_step()) return;
        if (!overlap(at->range, seen_)) continue;
        if (!condition_known(at->pass)) return;
        if (!turned_off(at->pass) && (done(resource, &*at) || !turn_off(at->pass))) return;
        if (at->instead.valid()) replaced = &*at;
      }
      if (!replaced) {
        if (graph().resources[resource.value].origin == Origin::imported) {
          done(resource, nullptr);
          return;
        }
        // No earlier pass writes the resource: its only producer counts, or, if all are off, the
        // first replacement.
        for (auto at = end; at != writes.end(); ++at) {
          if (!spend_step()) return;
          if (!condition_known(at->pass)) return;
          if (!turned_off(at->pass) && !turn_off(at->pass)) return;
          if (!replaced && at->instead.valid()) replaced = &*at;
        }
        if (!replaced) return;
        ++later;
      }
      steps_.push_back({resource, replaced});
      resource = replaced->instead;
      before = replaced->pass.value;
      seen_ = {};
    }
  }

  bool spend_step() { return steps_left_ > 0 && --steps_left_ > 0; }

  // Returns whether the pass is off because nothing scatters, whatever its `when` says.
  bool turned_off(PassId pass) const { return nothing_scatters_ && serves_scattering(pass); }

  // Adds the condition that the pass is off. Returns false if the pass is always on.
  bool turn_off(PassId pass) {
    const ExpressionId when = graph().passes[pass.value].when;
    if (when.valid()) conditions_.push_back({when, false});
    return when.valid();
  }

  // Checks the read of `write`, or of the host's contents if it is null. Returns true if the walk
  // ends here: an error was reported, or no steps are left.
  bool done(ResourceId resource, const Write* write) {
    const PortBinding* written = port_->own_texels ? nullptr : written_too(resource);
    const ResourceDeclaration& declared = graph().resources[resource.value];
    const bool replaces = !steps_.empty() && declared.type == ResourceType::image &&
                          !reader_.broken_resources[resource.value];
    const PassType& type = reader_.pass_types[graph().passes[pass_.value].type];
    const bool unusable = replaces && !formats_fit(*port_, declared);
    const bool other_layers = replaces && !layers_fit(type, *port_, declared.layers);
    if (!written && !unusable && !other_layers) return false;
    conditions_.push_back({write ? graph().passes[write->pass.value].when : ExpressionId(), true});
    const bool possible = can_hold(graph(), conditions_, steps_left_);
    conditions_.pop_back();
    if (steps_left_ == 0) return true; // `check` reports it
    if (!possible) return false;
    if (written) report_race(*written);
    if (unusable) report_unusable(resource);
    if (other_layers) report_layers(resource);
    return true;
  }

  const PortBinding* written_too(ResourceId resource) const {
    for (const PortBinding& binding : graph().writes(graph().passes[pass_.value]))
      if (binding.resource == resource && binding.port != unknown_port &&
          overlap(binding.range, seen_))
        return &binding;
    return nullptr;
  }

  std::string name_of(const PortBinding& binding) const {
    return graph().resources[binding.resource.value].name + image_range_text(binding.range);
  }

  void report_race(const PortBinding& written) {
    const PassDeclaration& pass = graph().passes[pass_.value];
    InPlaceRace race;
    race.pass = pass.name;
    race.reading_port = port_->name;
    race.writing_port = reader_.pass_types[pass.type].ports[written.port].name;
    race.read = name_of(*read_);
    race.written = name_of(written);
    if (!steps_.empty()) race.substitute = graph().resources[written.resource.value].name;
    Diagnostic& diagnostic =
        reader_.error(DiagnosticId::in_place_race, graph().place_of(*read_), text_of(race));
    diagnostic.related.emplace_back(graph().place_of(written),
                                    fmt::format("'{}' is written here", name_of(written)));
    relate_steps(diagnostic);
  }

  void report_unusable(ResourceId resource) {
    report_formats(
        reader_, resource, graph().place_of(*read_),
        fmt::format("port '{}' of pass '{}' reads the replacement of '{}' and supports {}",
                    port_->name, graph().passes[pass_.value].name, name_of(*read_),
                    formats_taken(*port_)));
  }

  void report_layers(ResourceId resource) {
    const ResourceDeclaration& declared = graph().resources[resource.value];
    relate_steps(reader_.error(
        DiagnosticId::bad_subresource, graph().place_of(*read_),
        fmt::format("port '{}' of pass '{}' accesses {}, but the replacement '{}' of '{}' has {}",
                    port_->name, graph().passes[pass_.value].name,
                    port_->glsl_type.ends_with("Array") ? "several layers" : "one layer",
                    declared.name, name_of(*read_), declared.layers)));
  }

  void report_limit() {
    reader_
        .error(DiagnosticId::limit_exceeded, graph().place_of(*read_),
               fmt::format("checking the graph's reads for all values of 'when' takes more than {} "
                           "steps; port '{}' of pass '{}' and the passes after it are not checked",
                           limits::read_search_steps, port_->name,
                           graph().passes[pass_.value].name))
        .suggestion = "use fewer passes with 'when' and 'otherwise' that write the same resources";
  }

  void relate_steps(Diagnostic& diagnostic) const {
    for (const Step& step : steps_)
      diagnostic.related.emplace_back(
          step.replaced->where, fmt::format("'{}' replaces '{}' if '{}' is off",
                                            graph().resources[step.replaced->instead.value].name,
                                            graph().resources[step.of.value].name,
                                            graph().passes[step.replaced->pass.value].name));
  }

  struct Step {
    ResourceId of;
    const Write* replaced = nullptr;
  };

  GraphReader& reader_;
  std::vector<std::vector<Write>> writes_; // by resource, in file order
  bool replaces_scattering_ = false;       // a pass that serves scattering has `otherwise`
  bool nothing_scatters_ = false;          // during a second walk, with such passes off
  uint64_t steps_left_ = limits::read_search_steps;
  PassId pass_;
  const PortBinding* read_ = nullptr;
  const Port* port_ = nullptr;
  ImageRange seen_;
  std::vector<Condition> conditions_; // conditions under which the read happens
  std::vector<Step> steps_;           // replacements followed so far
};

} // namespace

void check_reads(GraphReader& reader) {
  Reads reads(reader);
  for (uint32_t i = 0; i < reader.graph.passes.size(); ++i)
    if (!reads.check({i})) break;
}

} // namespace dermis
