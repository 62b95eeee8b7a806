#pragma once
// What the fuzz targets share. Each is a law over any bytes: it ends, it stays inside its memory, and what it
// refuses it explains.

#include "framegraph/text/diagnostic.hpp"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace dermis::fuzz {

inline std::string text_of(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// Ends the run as a finding.
inline void demand(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", property);
  std::abort();
}

// What was refused has an error, and its messages can be written. Always 0, which keeps the input.
inline int demand_error(const Diagnostics& diagnostics) {
  demand(diagnostics.has_errors(), "refused without an error");
  demand(!format_for_people(diagnostics, diagnostics.list.front()).empty(), "an error without a text");
  demand(format_as_json(diagnostics).size() > 2, "an error that programs do not see");
  return 0;
}

} // namespace dermis::fuzz
