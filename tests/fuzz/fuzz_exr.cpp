// Reads any bytes as a picture of a capture.

#include "integration/tools/files/exr.hpp"
#include "tests/fuzz/fuzz_input.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace dermis;
  static const int file = memfd_create("input.exr", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  fuzz::demand(ftruncate(file, 0) == 0 && pwrite(file, data, size, 0) == static_cast<ssize_t>(size),
               "the input has a file");
  const tools::ChannelNames accepted[] = {{"R", "G", "B"}, {"Y"}, {"Z"}};
  std::string error;
  if (!tools::read_exr(path, accepted, error))
    fuzz::demand(!error.empty(), "rejected without a reason");
  return 0;
}
