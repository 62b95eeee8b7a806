// Reads any bytes as a scene file.

#include "integration/examples/demo_engine/scene/read_scene.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace dermis;
  Diagnostics diagnostics;
  if (!demo::parse_scene("configs/scenes/input.json", fuzz::text_of(data, size), diagnostics))
    return fuzz::demand_error(diagnostics);
  return 0;
}
