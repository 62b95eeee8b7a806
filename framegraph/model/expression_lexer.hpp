#pragma once
// The words of a `when` expression. Inside of expression.hpp.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace dermis {

struct Token {
  enum class Sort : uint8_t { word, integer, real, text, symbol, end, malformed } sort = Sort::end;
  std::string_view text; // of a text: what stands between the quotes
  int64_t integer = 0;
  double real = 0.0;
  size_t at = 0; // byte in the expression
};

class ExpressionLexer {
public:
  explicit ExpressionLexer(std::string_view text) : text_(text) {}
  Token next(); // Sort::end for ever behind the last; Sort::malformed for what is no token

private:
  Token number(size_t begin);

  std::string_view text_;
  size_t at_ = 0;
};

// and, or, not, in, true, false: no setting may bear such a name.
bool is_reserved_word(std::string_view word);

// The operator of other languages that covers byte `at`, such as "&&" or "+"; empty where there is none.
struct ForeignOperator {
  std::string_view text;
  std::string_view instead; // what means the same here; empty: nothing does
};
ForeignOperator foreign_operator(std::string_view expression, size_t at);

// "'<='", "the end": for messages.
std::string describe(const Token& token);

} // namespace dermis
