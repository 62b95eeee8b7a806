#include "framegraph/model/in_place.hpp"

#include <fmt/format.h>

namespace dermis {

std::string text_of(const InPlaceRace& race) {
  const std::string replaced =
      race.substitute.empty() ? "" : fmt::format(", which '{}' replaces,", race.substitute);
  return fmt::format(
      "pass '{}' reads '{}'{} through its port '{}' and writes '{}' through '{}': an "
      "invocation may read what another invocation has already written",
      race.pass, race.read, replaced, race.reading_port, race.written, race.writing_port);
}

} // namespace dermis
