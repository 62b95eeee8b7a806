// Reads any bytes as a profile file.

#include "framegraph/text/document.hpp"
#include "passes/common/profiles/profile.hpp"
#include "tests/fuzz/fuzz_input.hpp"

#include <cmath>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace dermis;
  Diagnostics diagnostics;
  const auto document = parse_document("input.json", fuzz::text_of(data, size), diagnostics);
  if (!document) return fuzz::demand_error(diagnostics);
  const auto profile = subsurface::read_profile(*document, diagnostics);
  if (!profile) return fuzz::demand_error(diagnostics);
  for (const double d : profile->d_mm)
    fuzz::demand(std::isfinite(d) && d >= 0.0, "an accepted profile has a length that is none");
  return 0;
}
