// Defines operator new and delete of the shared library. No other library sees them: the shared
// library has its own C++ run time, hidden like everything except dermis_*, so all of its
// containers allocate here.
#include "integration/abi/memory/host_memory.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>
#if defined(_WIN32)
#include <malloc.h>
#endif

namespace dermis::abi {
namespace {

// Precedes each allocation and stores how to free it, in any scope and at any time.
struct Header {
  dermis_free_fn free;
  void* user;
  size_t size, alignment; // as requested from the allocator
};
constexpr size_t min_alignment = alignof(std::max_align_t);

constexpr size_t header_space(size_t alignment) {
  return (sizeof(Header) + alignment - 1) / alignment * alignment;
}

#if defined(_WIN32) // Windows has no aligned_alloc
void* from_c_library(size_t alignment, size_t size) {
  return _aligned_malloc(size, alignment);
}
void to_c_library(void* memory) {
  _aligned_free(memory);
}
#else
void* from_c_library(size_t alignment, size_t size) {
  return std::aligned_alloc(alignment, size);
}
void to_c_library(void* memory) {
  std::free(memory);
}
#endif

void* allocate_bytes(size_t size, size_t requested_alignment) noexcept {
  const size_t alignment = std::max(requested_alignment, min_alignment),
               front = header_space(alignment);
  // aligned_alloc requires a multiple of the alignment
  const size_t total = (front + size + alignment - 1) / alignment * alignment;
  if (total < size) return nullptr;
  const HostAllocator& host = current_allocator();
  void* memory = host.allocate == nullptr ? from_c_library(alignment, total)
                                          : host.allocate(host.user, total, alignment);
  if (memory == nullptr) return nullptr;
  std::byte* given = static_cast<std::byte*>(memory) + front;
  const Header header{host.allocate == nullptr ? nullptr : host.free, host.user, total, alignment};
  std::memcpy(given - sizeof header, &header, sizeof header);
  return given;
}

void free_bytes(void* given) noexcept {
  if (given == nullptr) return;
  Header header;
  std::memcpy(&header, static_cast<std::byte*>(given) - sizeof header, sizeof header);
  void* memory = static_cast<std::byte*>(given) - header_space(header.alignment);
  if (header.free == nullptr)
    to_c_library(memory);
  else
    header.free(header.user, memory, header.size, header.alignment);
}

void* allocate_or_throw(size_t size, size_t alignment) {
  if (void* given = allocate_bytes(size, alignment)) return given;
  throw std::bad_alloc();
}

} // namespace

bool serves_host_allocator() noexcept {
  return true;
}

} // namespace dermis::abi

using dermis::abi::allocate_bytes;
using dermis::abi::allocate_or_throw;
using dermis::abi::free_bytes;

// The array forms call these.
void* operator new(size_t size) {
  return allocate_or_throw(size, 1);
}
void* operator new(size_t size, std::align_val_t alignment) {
  return allocate_or_throw(size, static_cast<size_t>(alignment));
}
void* operator new(size_t size, const std::nothrow_t&) noexcept {
  return allocate_bytes(size, 1);
}
void* operator new(size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
  return allocate_bytes(size, static_cast<size_t>(alignment));
}
void operator delete(void* memory) noexcept {
  free_bytes(memory);
}
void operator delete(void* memory, size_t) noexcept {
  free_bytes(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  free_bytes(memory);
}
void operator delete(void* memory, size_t, std::align_val_t) noexcept {
  free_bytes(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  free_bytes(memory);
}
void operator delete(void* memory, std::align_val_t, const std::nothrow_t&) noexcept {
  free_bytes(memory);
}
