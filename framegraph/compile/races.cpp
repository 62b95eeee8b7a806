// Reports passes that read what they write, with these settings. read_graph checks all combinations
// of settings; this phase covers graphs from other sources and graphs with too many combinations.

#include "framegraph/compile/phases.hpp"
#include "framegraph/model/in_place.hpp"

namespace dermis {
namespace {

bool is_race(const Activation& active, const Use& read, const Use& write) {
  if (!read.reads || read.writes || read.frames_back > 0 || read.bind_error != Use::BindError::none)
    return false;
  if (read.resource != write.resource || active.type(read.pass).ports[read.port].own_texels)
    return false;
  return read.requested != read.resource ||
         read.subresource == write.subresource; // a substitute is never divided
}

} // namespace

void report_races(const CompileInput& in, const Activation& active, const Versions& versions,
                  Report& report) {
  const Graph& graph = *in.graph;
  if (!versions.overwrites) return;
  for (const Use& write : versions.uses) {
    if (write.write_version == invalid_index ||
        versions[write.write_version].previous == invalid_index)
      continue;
    for (const Use& read : versions.uses_of(write.pass)) {
      if (!is_race(active, read, write)) continue;
      const PassType& type = active.type(read.pass);
      InPlaceRace race;
      race.pass = name_of(graph, read.pass);
      race.reading_port = type.ports[read.port].name;
      race.writing_port = type.ports[write.port].name;
      race.read = name_of(graph, read.requested);
      race.written = name_of(graph, write.requested);
      if (read.requested != read.resource) race.substitute = name_of(graph, read.resource);
      report.diagnostics.add(DiagnosticId::in_place_race, location_of(graph, read), text_of(race))
          .related.emplace_back(location_of(graph, write), "it is written here");
    }
  }
}

} // namespace dermis
