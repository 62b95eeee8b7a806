// Tests struct_size: the sizes that a caller may state, and what the library reads and writes for
// each size.

#include "integration/abi/sized_struct.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <vector>

namespace {

struct Grown {
  size_t struct_size;
  uint64_t first;
  uint64_t second;
};

} // namespace

namespace dermis::abi {
namespace {

// Allocates exactly `size` bytes on the heap, so that the address sanitizer detects accesses beyond
// them.
std::unique_ptr<std::byte[]> structure(size_t allocated, size_t stated,
                                       std::byte tail = std::byte{0}) {
  auto bytes = std::make_unique<std::byte[]>(std::max(allocated, sizeof(size_t)));
  for (size_t i = sizeof(size_t); i < allocated; ++i)
    bytes[i] = i < sizeof(Grown) ? std::byte{1} : tail;
  std::memcpy(bytes.get(), &stated, sizeof stated);
  return bytes;
}

TEST(SizedStruct, SmallerThanTheStruct_Read_IsRejected) {
  for (size_t size = 0; size < sizeof(Grown); ++size) {
    Grown read{};
    EXPECT_EQ(read_sized(structure(size, size).get(), read), SizedRead::too_small) << size;
  }
}

TEST(SizedStruct, NewerCallersTail_IsAcceptedOnlyIfZero) {
  for (size_t size = sizeof(Grown); size <= sizeof(Grown) + 64; ++size) {
    Grown read{};
    EXPECT_EQ(read_sized(structure(size, size).get(), read), SizedRead::ok) << size;
    EXPECT_EQ(read.second, 0x0101010101010101u);
    if (size > sizeof(Grown)) {
      EXPECT_EQ(read_sized(structure(size, size, std::byte{1}).get(), read),
                SizedRead::unknown_fields)
          << size;
    }
  }
}

TEST(SizedStruct, UninitialisedSize_IsRejectedBeforeReadingTheTail) {
  Grown read{};
  EXPECT_EQ(read_sized(structure(sizeof(Grown), largest_struct_size + 1).get(), read),
            SizedRead::too_large);
  EXPECT_EQ(read_sized(structure(sizeof(Grown), ~size_t{0}).get(), read), SizedRead::too_large);
}

TEST(SizedStruct, LargerThanTheStruct_Write_ZeroesTheRest) {
  auto new_caller = structure(40, 40, std::byte{0xff});
  write_sized(new_caller.get(), 40, Grown{0, 3, 4});
  EXPECT_EQ(stated_size(new_caller.get()), 40u);
  for (size_t i = sizeof(Grown); i < 40; ++i)
    EXPECT_EQ(new_caller[i], std::byte{0});
}

} // namespace
} // namespace dermis::abi
