#include "integration/abi/memory/host_memory.hpp"

namespace dermis::abi {
namespace {

constinit thread_local HostAllocator current;

} // namespace

const HostAllocator& current_allocator() noexcept {
  return current;
}

MemoryScope::MemoryScope(const HostAllocator& allocator) noexcept : before_(current) {
  current = allocator;
}

MemoryScope::~MemoryScope() {
  current = before_;
}

} // namespace dermis::abi
