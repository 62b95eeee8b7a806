#pragma once
// Tokenizes `when` expressions. Internal to expression.hpp.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace dermis {

struct Token {
  enum class Sort : uint8_t { word, integer, real, text, symbol, end, malformed } sort = Sort::end;
  std::string_view text; // for `text`: the contents between the quotes
  int64_t integer = 0;
  double real = 0.0;
  size_t at = 0; // byte offset in the expression
};

class ExpressionLexer {
public:
  explicit ExpressionLexer(std::string_view text) : text_(text) {}
  // Returns Sort::end repeatedly after the last token, and Sort::malformed for invalid input.
  Token next();

private:
  Token number(size_t begin);

  std::string_view text_;
  size_t at_ = 0;
};

// Returns whether `word` is and, or, not, in, true or false. No setting may have such a name.
bool is_reserved_word(std::string_view word);

// An operator of other languages, e.g. "&&" or "+".
struct ForeignOperator {
  std::string_view text;
  std::string_view instead; // the equivalent here; empty: none
};
ForeignOperator foreign_operator(std::string_view expression, size_t at);

// Returns the token for messages: "'<='", "the end".
std::string describe(const Token& token);

} // namespace dermis
