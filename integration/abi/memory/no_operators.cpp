// operator new is the program's: a static library must not take it over, and sanitizers bring their own.
#include "integration/abi/memory/host_memory.hpp"

bool dermis::abi::serves_host_allocator() noexcept {
  return false;
}
