#pragma once
// Host memory: from the host's allocator inside of calls that know one, else from the C library. The C++ run
// time of the shared library asks here (operators.cpp); a static library leaves operator new to its program.

#include "integration/include/dermis/dermis.h"

namespace dermis::abi {

struct HostAllocator {                   // copied from dermis_allocator
  dermis_allocate_fn allocate = nullptr; // null: the C library
  dermis_release_fn release = nullptr;
  void* user = nullptr;
};

// True: what this library allocates goes through current_allocator(). Free-threaded.
bool serves_host_allocator() noexcept;

// That of the call which this thread is in.
const HostAllocator& current_allocator() noexcept;

// Makes an allocator that of this thread until the end of the scope. Memory knows whom it came from: it may
// be given back in any scope.
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
