// Reads any bytes as a saved plan. The result is an error, or a plan that is written as equal
// bytes, and that can be verified and compared within its memory.

#include "framegraph/explain/plan_diff.hpp"
#include "framegraph/serialize/plan_file.hpp"
#include "framegraph/verify/verify.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace dermis;
  const std::string bytes = fuzz::text_of(data, size);
  Diagnostics diagnostics;
  const auto saved = read_plan("input.plan", bytes, diagnostics);
  if (!saved) return fuzz::demand_error(diagnostics);
  fuzz::demand(write_plan(*saved) == bytes, "a plan that was read is written as other bytes");
  verify(saved->plan);
  fuzz::demand(diff_plans(*saved, *saved).same, "a plan differs from itself");
  return 0;
}
