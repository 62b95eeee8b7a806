#include "framegraph/text/counting_iterator.hpp"

namespace dermis {

void TextCursor::end(EarlyEnd why, TextPosition where) {
  early_end_ = why;
  early_end_position_ = where;
}

void TextCursor::begin_token() {
  previous_token_ = token_;
  token_ = position_;
  token_bytes_ = 0;
}

void TextCursor::begin_between(char c) {
  state_ = State::between;
  switch (c) {
  case ' ':
  case '\t':
  case '\n':
  case '\r':
    return;
  case '/':
    state_ = State::slash;
    return;
  case ',':
  case ':':
    begin_token();
    return;
  case '}':
  case ']':
    begin_token();
    if (depth_ > 0) --depth_;
    return;
  default:
    break;
  }
  begin_token();
  value_ = position_;
  if (c == '{' || c == '[') {
    if (++depth_ > limits::nesting) end(EarlyEnd::deep_nesting, position_);
  } else {
    state_ = c == '"' ? State::string : State::scalar;
  }
}

void TextCursor::advance() {
  const char c = current();
  // The parser takes a NUL as the end of the input and would silently ignore the rest.
  if (c == '\0') {
    end(EarlyEnd::nul_byte, position_);
    return;
  }
  switch (state_) {
  case State::between:
    begin_between(c);
    break;
  case State::scalar:
    if (std::string_view(" \t\n\r,:{}[]\"/").find(c) != std::string_view::npos) {
      begin_between(c);
    } else if (++token_bytes_ >= limits::number_bytes) {
      end(EarlyEnd::long_number, token_);
    }
    break;
  case State::string:
    if (c == '"') {
      state_ = State::between;
      break;
    }
    if (c == '\\') state_ = State::escape;
    if (++token_bytes_ > limits::string_bytes) end(EarlyEnd::long_string, token_);
    break;
  case State::escape:
    state_ = State::string;
    if (++token_bytes_ > limits::string_bytes) end(EarlyEnd::long_string, token_);
    break;
  case State::slash:
    state_ = c == '/' ? State::comment : State::between;
    if (c == '*') end(EarlyEnd::block_comment, position_);
    break;
  case State::comment:
    if (c == '\n' || c == '\r') state_ = State::between;
    break;
  }
  ++position_.offset;
  ++position_.column;
  if (c == '\n') {
    ++position_.line;
    position_.column = 1;
  }
}

} // namespace dermis
