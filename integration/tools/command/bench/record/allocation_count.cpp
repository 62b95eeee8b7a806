// Separate file: if inlined next to its uses, the replacement looks mismatched to the compiler.
#include "integration/tools/command/bench/record/allocation_count.hpp"

#include <cstdlib>
#include <new>

namespace {
thread_local uint64_t allocations = 0;
}

// The nothrow forms are also replaced, because plain delete frees their memory.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(bytes == 0 ? 1 : bytes);
}

void* operator new(std::size_t bytes) {
  if (void* memory = operator new(bytes, std::nothrow)) return memory;
  throw std::bad_alloc();
}

void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace dermis::tools {

uint64_t allocations_of_this_thread() {
  return allocations;
}

} // namespace dermis::tools
