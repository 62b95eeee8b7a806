// Reads any bytes as a frame.json; the profiles that it names do not exist.

#include "framegraph/text/document.hpp"
#include "integration/tools/files/capture.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace dermis;
  Diagnostics diagnostics;
  const auto document = parse_document("frame.json", fuzz::text_of(data, size), diagnostics);
  if (!document) return fuzz::demand_error(diagnostics);
  const auto frame =
      tools::read_description(*document, "no such folder", "no such folder", diagnostics);
  if (!frame) return fuzz::demand_error(diagnostics);
  fuzz::demand(!tools::describe_frame(frame->description).empty(),
               "an accepted frame cannot be written");
  return 0;
}
