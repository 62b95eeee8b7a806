#pragma once
// Shared by the fuzz targets. For any bytes a target has to terminate, stay within its memory, and
// explain what it rejects.

#include "framegraph/text/diagnostic.hpp"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace dermis::fuzz {

inline std::string text_of(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// Aborts the run, which reports the input.
inline void demand(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "broken: %s\n", property);
  std::abort();
}

// Checks that rejected input has an error, and that its messages can be written. Returns 0, which
// keeps the input.
inline int demand_error(const Diagnostics& diagnostics) {
  demand(diagnostics.has_errors(), "rejected without an error");
  demand(!format_for_people(diagnostics, diagnostics.list.front()).empty(),
         "an error without a text");
  demand(format_as_json(diagnostics).size() > 2, "an error that programs do not see");
  return 0;
}

} // namespace dermis::fuzz
