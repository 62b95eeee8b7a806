// Passes that read what they write, with these settings. The reader of graphs refuses those that any settings
// lead to; this holds for graphs that were made otherwise, and where the settings are too many to judge.

#include "framegraph/model/in_place.hpp"
#include "framegraph/compile/phases.hpp"

namespace dermis {
namespace {

bool is_race(const CompileContext& c, const Use& read, const Use& write) {
  if (!read.reads || read.writes || read.frames_back > 0 || read.bind_error != Use::BindError::none)
    return false;
  if (read.resource != write.resource || c.type(read.pass).ports[read.port].own_texels) return false;
  return read.requested != read.resource || read.part == write.part; // what stands in has no parts
}

} // namespace

void report_races(CompileContext& c) {
  if (!c.overwrites) return;
  for (const Use& write : c.uses) {
    if (write.write_value == no_value || c.values[write.write_value].previous == no_value) continue;
    for (uint32_t u = c.first_use[write.pass.value]; u < c.first_use[write.pass.value + 1]; ++u) {
      const Use& read = c.uses[u];
      if (!is_race(c, read, write)) continue;
      const PassType& type = c.type(read.pass);
      InPlaceRace race;
      race.pass = c.name(read.pass);
      race.reading_port = type.ports[read.port].name;
      race.writing_port = type.ports[write.port].name;
      race.read = c.name(read.requested);
      race.written = c.name(write.requested);
      if (read.requested != read.resource) race.placeholder = c.name(read.resource);
      c.diagnostics->add(DiagnosticId::in_place_race, c.place_of(read), text_of(race))
          .related.emplace_back(c.place_of(write), "it is written here");
    }
  }
}

} // namespace dermis
