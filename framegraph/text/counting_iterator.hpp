#pragma once
// The input that the JSON parser reads through: counts lines and columns, remembers where each token starts,
// and ends early when a limit is passed, so that no limit depends on what the parser would have allocated by
// then.

#include "framegraph/text/limits.hpp"

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>

namespace dermis {

struct TextPosition {
  size_t offset = 0;
  uint32_t line = 1, column = 1; // bytes
};

enum class EarlyEnd : uint8_t { none, nul_byte, block_comment, long_string, long_number, deep_nesting };

// A scanner of just enough JSON to know where tokens start. In step with the parser as long as the text is
// valid; behind the first error nothing it says is used.
class TextCursor {
public:
  explicit TextCursor(std::string_view text) : text_(text) {}

  bool at_end() const { return early_end_ != EarlyEnd::none || position_.offset >= text_.size(); }
  char current() const { return text_[position_.offset]; }
  void advance();

  EarlyEnd early_end() const { return early_end_; }
  // Where the limit was passed; the start of the string or number for those.
  TextPosition early_end_position() const { return early_end_position_; }
  // First character of the last key, string, number, word, '{' or '[' that began.
  TextPosition value_position() const { return value_; }
  // First character of the last token of any sort that began before `offset`. Looks back over two tokens: the
  // parser reads one character ahead behind numbers.
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

// Input iterator over a cursor that outlives it; the default-constructed one is the end.
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
