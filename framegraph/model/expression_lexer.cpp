#include "framegraph/model/expression_lexer.hpp"

#include "framegraph/text/utf8.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <iterator>

namespace dermis {

namespace {

constexpr size_t shown_bytes = 40;

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

} // namespace

bool is_reserved_word(std::string_view word) {
  return word == "and" || word == "or" || word == "not" || word == "in" || word == "true" ||
         word == "false";
}

ForeignOperator foreign_operator(std::string_view expression, size_t at) {
  struct Known {
    std::string_view text, instead;
  };
  constexpr Known translations[] = {
      {"=", "=="},    {"===", "=="},  {"!==", "!="}, {"<>", "!="}, {"~=", "!="},   {"=>", ">="},
      {"=<", "<="},   {"&&", "and"},  {"&", "and"},  {"||", "or"}, {"|", "or"},    {"!", "not"},
      {"AND", "and"}, {"And", "and"}, {"OR", "or"},  {"Or", "or"}, {"NOT", "not"}, {"Not", "not"},
      {"IN", "in"},   {"In", "in"},   {"xor", "!="}, {"is", "=="}};
  constexpr std::string_view own[] = {"==", "!=", "<", "<=", ">", ">="}, signs = "=<>!&|+-*/%^~?";
  const auto is_sign = [&](char c) { return signs.find(c) != std::string_view::npos; };
  if (at >= expression.size()) return {};
  const bool word = is_letter(expression[at]);
  if (!word && !is_sign(expression[at])) return {};
  const auto belongs = [&](char c) { return word ? is_letter(c) || is_digit(c) : is_sign(c); };
  size_t begin = at, end = at;
  while (begin > 0 && belongs(expression[begin - 1]))
    --begin;
  while (end < expression.size() && belongs(expression[end]))
    ++end;
  const std::string_view text = expression.substr(begin, end - begin);
  for (const Known& one : translations)
    if (one.text == text) return {text, one.instead};
  const bool known = std::find(std::begin(own), std::end(own), text) != std::end(own);
  return word || known ? ForeignOperator{} : ForeignOperator{text.substr(0, shown_bytes), {}};
}

std::string describe(const Token& token) {
  if (token.sort == Token::Sort::end) return "the end";
  std::string out = "'";
  append_printable(out, token.text, shown_bytes);
  return out + "'";
}

Token ExpressionLexer::number(size_t begin) {
  while (at_ < text_.size() &&
         (is_digit(text_[at_]) || is_letter(text_[at_]) || text_[at_] == '.' ||
          ((text_[at_] == '+' || text_[at_] == '-') && (text_[at_ - 1] | 0x20) == 'e'))) {
    ++at_;
  }
  Token token{Token::Sort::malformed, text_.substr(begin, at_ - begin), 0, 0.0, begin};
  const char* first = token.text.data();
  const char* last = first + token.text.size();
  if (token.text.find_first_of(".eE") == std::string_view::npos) {
    const auto result = std::from_chars(first, last, token.integer);
    if (result.ec == std::errc() && result.ptr == last) token.sort = Token::Sort::integer;
  } else {
    const auto result = std::from_chars(first, last, token.real);
    if (result.ec == std::errc() && result.ptr == last) token.sort = Token::Sort::real;
  }
  return token;
}

Token ExpressionLexer::next() {
  while (at_ < text_.size() &&
         (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r')) {
    ++at_;
  }
  const size_t begin = at_;
  if (at_ == text_.size()) return {Token::Sort::end, {}, 0, 0.0, begin};
  const char c = text_[at_++];
  if (is_letter(c)) {
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_])))
      ++at_;
    return {Token::Sort::word, text_.substr(begin, at_ - begin), 0, 0.0, begin};
  }
  if (is_digit(c) || (c == '-' && at_ < text_.size() && is_digit(text_[at_]))) return number(begin);
  if (c == '\'') {
    const size_t end = text_.find('\'', at_);
    if (end == std::string_view::npos) {
      at_ = text_.size();
      return {Token::Sort::malformed, text_.substr(begin), 0, 0.0, begin};
    }
    const std::string_view text = text_.substr(at_, end - at_);
    at_ = end + 1;
    return {Token::Sort::text, text, 0, 0.0, begin};
  }
  const std::string_view two = text_.substr(begin, 2);
  if (two == "==" || two == "!=" || two == "<=" || two == ">=") {
    ++at_;
    return {Token::Sort::symbol, two, 0, 0.0, begin};
  }
  const std::string_view one = text_.substr(begin, 1);
  const bool known = std::string_view("<>()[],").find(c) != std::string_view::npos;
  return {known ? Token::Sort::symbol : Token::Sort::malformed, one, 0, 0.0, begin};
}

} // namespace dermis
