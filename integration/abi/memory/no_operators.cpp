// Leaves operator new to the program: a static library must not replace it, and sanitizers have
// their own.
#include "integration/abi/memory/host_memory.hpp"

bool dermis::abi::serves_host_allocator() noexcept {
  return false;
}
