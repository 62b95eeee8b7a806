#pragma once
// Writes and reads the serialised form from one description: a function fields(archive, value)
// names the members of a struct in order, and an archive writes or reads them. Numbers are little
// endian.

#include "framegraph/text/utf8.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace dermis::serial {

// Type of the value that fields() takes: mutable when reading, const when writing.
template <class Archive, class T> using Of = std::conditional_t<Archive::reads, T, const T>;

class Writer {
public:
  static constexpr bool reads = false;

  template <class Number> void number(const char*, Number value) {
    using Bits = std::make_unsigned_t<Number>;
    for (size_t i = 0; i < sizeof(Number); ++i)
      bytes_.push_back(
          static_cast<char>(static_cast<uint64_t>(static_cast<Bits>(value)) >> (8 * i)));
  }
  void flag(const char* what, bool value) { number(what, static_cast<uint8_t>(value)); }
  void real(const char* what, double value) { number(what, std::bit_cast<uint64_t>(value)); }
  template <class Enum> void word(const char* what, Enum value, Enum /*last*/) {
    number(what, static_cast<std::underlying_type_t<Enum>>(value));
  }
  void text(const char* what, std::string_view value, size_t /*most*/) {
    number(what, static_cast<uint32_t>(value.size()));
    bytes_ += value;
  }
  template <class T> void list(const char* what, const std::vector<T>& values, size_t /*most*/) {
    number(what, static_cast<uint32_t>(values.size()));
    for (const T& value : values)
      fields(*this, value);
  }

  std::string finish() && { return std::move(bytes_); }
  size_t size() const { return bytes_.size(); }

private:
  std::string bytes_;
};

// Reads safely: never beyond the end, and never creates more elements than the remaining bytes can
// hold. Keeps the first problem; everything read after it is zero.
class Reader {
public:
  static constexpr bool reads = true;

  // `before`: number of bytes of the file that precede `bytes`, for messages.
  Reader(std::string_view bytes, size_t before) : bytes_(bytes), before_(before) {}

  template <class Number> void number(const char* what, Number& value) {
    value = 0;
    if (!take(what, sizeof(Number))) return;
    uint64_t bits = 0;
    for (size_t i = 0; i < sizeof(Number); ++i)
      bits |= uint64_t{static_cast<uint8_t>(bytes_[at_ - sizeof(Number) + i])} << (8 * i);
    value = static_cast<Number>(bits);
  }
  void flag(const char* what, bool& value) {
    uint8_t byte = 0;
    number(what, byte);
    value = byte == 1;
    if (byte > 1) fail(fmt::format("'{}' is {}, expected 0 or 1", what, byte));
  }
  void real(const char* what, double& value) {
    uint64_t bits = 0;
    number(what, bits);
    value = std::bit_cast<double>(bits);
    if (std::isfinite(value)) return;
    value = 0.0;
    fail(fmt::format("'{}' is not a finite number", what));
  }
  template <class Enum> void word(const char* what, Enum& value, Enum last) {
    std::underlying_type_t<Enum> bits = 0;
    number(what, bits);
    const bool known = bits <= static_cast<std::underlying_type_t<Enum>>(last);
    value = known ? static_cast<Enum>(bits) : Enum{};
    if (!known)
      fail(fmt::format("'{}' is {}, expected 0 .. {}", what, bits,
                       static_cast<std::underlying_type_t<Enum>>(last)));
  }
  void text(const char* what, std::string& value, size_t maximum) {
    value.clear();
    const size_t bytes = count(what, 1, maximum);
    if (bytes == 0 || !take(what, bytes)) return;
    value = bytes_.substr(at_ - bytes, bytes);
    if (find_invalid_utf8(value) != std::string_view::npos)
      fail(fmt::format("'{}' is not UTF-8", what));
  }
  template <class T> void list(const char* what, std::vector<T>& values, size_t maximum) {
    Writer smallest; // with empty strings and lists, the minimum size of a T
    fields(smallest, static_cast<const T&>(T{}));
    values.clear();
    values.resize(count(what, smallest.size(), maximum));
    for (T& value : values) {
      if (!problem_.empty()) return;
      fields(*this, value);
    }
  }
  void expect_end() {
    if (at_ != bytes_.size())
      fail(fmt::format("{} bytes remain after the last field", bytes_.size() - at_));
  }

  const std::string& problem() const { return problem_; } // "byte 12: ..."; "": none

private:
  void fail(std::string_view what) {
    if (problem_.empty()) problem_ = fmt::format("byte {}: {}", before_ + at_, what);
  }
  bool take(const char* what, size_t bytes) {
    if (!problem_.empty()) return false;
    if (bytes_.size() - at_ < bytes) {
      fail(fmt::format("the file ends inside '{}'", what));
      return false;
    }
    at_ += bytes;
    return true;
  }
  size_t count(const char* what, size_t bytes_each, size_t maximum) {
    uint32_t value = 0;
    number(what, value);
    const size_t available = (bytes_.size() - at_) / bytes_each;
    if (value <= maximum && value <= available) return value;
    fail(value > maximum
             ? fmt::format("'{}' has {} entries, at most {} are accepted", what, value, maximum)
             : fmt::format("'{}' has {} entries, but the rest of the file can hold only {}", what,
                           value, available));
    return 0;
  }

  std::string_view bytes_;
  size_t before_ = 0, at_ = 0;
  std::string problem_;
};

} // namespace dermis::serial
