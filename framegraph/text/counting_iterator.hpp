#pragma once
// Provides the input that the JSON parser reads: counts lines and columns and remembers token
// starts. Ends early if a limit is exceeded, so that limits do not depend on what the parser has
// allocated.

#include "framegraph/text/limits.hpp"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>

namespace dermis {

struct TextPosition {
  size_t offset = 0;
  uint32_t line = 1, column = 1; // in bytes, from 1
};

enum class EarlyEnd : uint8_t {
  none,
  nul_byte,
  block_comment,
  long_string,
  long_number,
  deep_nesting
};

// Scans just enough JSON to find token starts. Agrees with the parser while the text is valid; its
// output is not used after the first error.
class TextCursor {
public:
  explicit TextCursor(std::string_view text) : text_(text) {}

  bool at_end() const { return early_end_ != EarlyEnd::none || position_.offset >= text_.size(); }
  char current() const { return text_[position_.offset]; }
  void advance();

  EarlyEnd early_end() const { return early_end_; }
  // Returns where a limit was exceeded; for strings and numbers their start.
  TextPosition early_end_position() const { return early_end_position_; }
  // Returns the first character of the last key, string, number, word, '{' or '['.
  TextPosition value_position() const { return value_; }
  // Returns the first character of the last token that began before `offset`. Keeps two tokens,
  // because the parser reads one character beyond a number.
  TextPosition token_position_before(size_t offset) const {
    return token_.offset < offset ? token_ : previous_token_;
  }

private:
  enum class State : uint8_t { between, string, escape, scalar, slash, comment };

  void begin_token();
  void begin_between(char c);
  void end(EarlyEnd why, TextPosition where);

  std::string_view text_;
  TextPosition position_, value_, token_, previous_token_, early_end_position_;
  size_t token_bytes_ = 0;
  uint32_t depth_ = 0;
  State state_ = State::between;
  EarlyEnd early_end_ = EarlyEnd::none;
};

// Input iterator over a cursor that must outlive it. A default-constructed iterator is the end.
class CountingIterator {
public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = char;

  CountingIterator() = default;
  explicit CountingIterator(TextCursor& cursor) : cursor_(&cursor) {}

  char operator*() const { return cursor_->current(); }
  CountingIterator& operator++() {
    cursor_->advance();
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator old = *this;
    ++*this;
    return old;
  }
  bool operator==(const CountingIterator& other) const { return at_end() == other.at_end(); }

private:
  bool at_end() const { return cursor_ == nullptr || cursor_->at_end(); }

  TextCursor* cursor_ = nullptr;
};

} // namespace dermis
