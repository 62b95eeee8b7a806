#pragma once
// A linear allocator: pieces are freed all at once. Nothing is allocated after the first frames.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <vector>

namespace dermis::abi {

class Arena {
public:
  // Returns memory aligned for any type. Null: out of host memory.
  std::byte* take(size_t bytes) noexcept {
    bytes = (bytes + alignment - 1) / alignment * alignment;
    while (chunk_ < chunks_.size() && used_ + bytes > chunks_[chunk_].size) {
      ++chunk_;
      used_ = 0;
    }
    if (chunk_ == chunks_.size() && !grow(std::max(bytes, chunk_bytes))) return nullptr;
    std::byte* out = chunks_[chunk_].memory.get() + used_;
    used_ += bytes;
    return out;
  }
  // Invalidates all memory that was taken.
  void reset() noexcept { chunk_ = used_ = 0; }

  // Returns a copy of `items`; null if `items` is empty or memory runs out.
  template <class T> T* copy(std::span<const T> items) noexcept {
    std::byte* out = items.empty() ? nullptr : take(items.size_bytes());
    if (out != nullptr) std::memcpy(out, items.data(), items.size_bytes());
    return reinterpret_cast<T*>(out);
  }

private:
  static constexpr size_t alignment = __STDCPP_DEFAULT_NEW_ALIGNMENT__,
                          chunk_bytes = size_t{1} << 16;
  struct Chunk {
    std::unique_ptr<std::byte[]> memory;
    size_t size = 0;
  };

  bool grow(size_t bytes) noexcept {
    try {
      chunks_.reserve(chunks_.size() + 1);
      chunks_.push_back({std::make_unique<std::byte[]>(bytes), bytes});
    } catch (const std::bad_alloc&) {
      return false;
    }
    used_ = 0;
    return true;
  }

  std::vector<Chunk> chunks_;
  size_t chunk_ = 0, used_ = 0;
};

} // namespace dermis::abi
