#pragma once
// Selects the source of host memory: the host's allocator inside calls that have one, else the C
// library. The shared library's operator new uses it (operators.cpp); a static library uses the
// program's operator new.

#include "integration/include/dermis/dermis.h"

namespace dermis::abi {

struct HostAllocator {                   // copied from dermis_allocator
  dermis_allocate_fn allocate = nullptr; // null: the C library
  dermis_free_fn free = nullptr;
  void* user = nullptr;
};

// Returns whether the library's allocations go through current_allocator(). Free-threaded.
bool serves_host_allocator() noexcept;

// Returns the allocator of the thread's current call.
const HostAllocator& current_allocator() noexcept;

// Makes an allocator the current one of this thread until the end of the scope. Each allocation
// stores its allocator, so memory may be freed in any scope.
class MemoryScope {
public:
  explicit MemoryScope(const HostAllocator& allocator) noexcept;
  ~MemoryScope();
  MemoryScope(const MemoryScope&) = delete;
  MemoryScope& operator=(const MemoryScope&) = delete;

private:
  HostAllocator before_;
};

} // namespace dermis::abi
