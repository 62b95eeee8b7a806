#include "framegraph/model/expression.hpp"

#include "framegraph/model/expression_lexer.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>
#include <optional>

namespace dermis {

namespace {

using Op = Expression::Op;

// `text` is a quoted option whose setting is not known yet.
enum class Type : uint8_t { boolean, number, option, text };

std::string_view type_name(Type type) {
  switch (type) {
  case Type::boolean:
    return "a boolean";
  case Type::number:
    return "a number";
  case Type::option:
    return "an option";
  case Type::text:
    return "a quoted option";
  }
  return "";
}

struct Operand {
  Type type = Type::boolean;
  ExpressionId id;       // invalid for text
  SettingId setting;     // setting of an option
  std::string_view text; // contents of a text
  size_t at = 0;
};

std::optional<Op> comparison_of(std::string_view symbol) {
  if (symbol == "==") return Op::equal;
  if (symbol == "!=") return Op::not_equal;
  if (symbol == "<") return Op::less;
  if (symbol == "<=") return Op::less_equal;
  if (symbol == ">") return Op::greater;
  if (symbol == ">=") return Op::greater_equal;
  return std::nullopt;
}

// Recursive-descent parser with one token of lookahead. After the first error every function
// returns nullopt.
class Parser {
public:
  Parser(const Document& document, NodeId node, std::string_view what, Graph& graph,
         const std::vector<bool>& broken, Diagnostics& diagnostics)
      : document_(document), node_(node), what_(what), graph_(graph), broken_(broken),
        diagnostics_(diagnostics), lexer_(document.text(node)) {
    step();
  }

  ExpressionId parse() {
    const auto value = disjunction();
    if (!value) return {};
    if (token_.sort != Token::Sort::end) {
      fail(DiagnosticId::bad_expression, token_.at, fmt::format("unexpected {}", describe(token_)));
      return {};
    }
    if (!expect_boolean(*value)) return {};
    return value->id;
  }

private:
  void step() { token_ = lexer_.next(); }
  bool is_word(std::string_view word) const {
    return token_.sort == Token::Sort::word && token_.text == word;
  }
  bool is_symbol(std::string_view symbol) const {
    return token_.sort == Token::Sort::symbol && token_.text == symbol;
  }

  std::nullopt_t fail(DiagnosticId id, size_t at, std::string text, std::string suggestion = {}) {
    const ForeignOperator foreign = foreign_operator(document_.text(node_), at);
    const bool taken_for_setting = id == DiagnosticId::unknown_setting && !foreign.instead.empty();
    if ((id == DiagnosticId::bad_expression && !foreign.text.empty()) || taken_for_setting) {
      id = DiagnosticId::bad_expression;
      text = fmt::format("unknown operator '{}'; expected ==, !=, <, <=, >, >=, in, not, and, or",
                         foreign.text);
      if (!foreign.instead.empty()) suggestion = fmt::format("did you mean '{}'?", foreign.instead);
    }
    diagnostics_
        .add(id, where_in_string(document_, node_, at, diagnostics_),
             fmt::format("{}: {}", what_, text))
        .suggestion = std::move(suggestion);
    return std::nullopt;
  }

  bool expect_boolean(const Operand& operand) {
    if (operand.type == Type::boolean) return true;
    fail(DiagnosticId::expression_type, operand.at,
         fmt::format("{} is used where a boolean is expected", type_name(operand.type)));
    return false;
  }

  Operand append(Expression expression, Type type, size_t at, SettingId setting = {}) {
    graph_.expressions.push_back(std::move(expression));
    return {type, {static_cast<uint32_t>(graph_.expressions.size() - 1)}, setting, {}, at};
  }
  Operand append(Op op, ExpressionId left, ExpressionId right, size_t at) {
    Expression expression;
    expression.op = op;
    expression.left = left;
    expression.right = right;
    return append(std::move(expression), Type::boolean, at);
  }

  std::optional<Operand> disjunction() { return chain("or", Op::logical_or, &Parser::conjunction); }
  std::optional<Operand> conjunction() { return chain("and", Op::logical_and, &Parser::negation); }

  std::optional<Operand> chain(std::string_view word, Op op,
                               std::optional<Operand> (Parser::*part)()) {
    auto left = (this->*part)();
    while (left && is_word(word)) {
      step();
      const auto right = (this->*part)();
      if (!right || !expect_boolean(*left) || !expect_boolean(*right)) return std::nullopt;
      left = append(op, left->id, right->id, left->at);
    }
    return left;
  }

  std::optional<Operand> negation() {
    if (!is_word("not")) return comparison();
    const size_t at = token_.at;
    if (!enter(at)) return std::nullopt;
    step();
    const auto inner = negation();
    --depth_;
    if (!inner || !expect_boolean(*inner)) return std::nullopt;
    return append(Op::logical_not, inner->id, {}, at);
  }

  std::optional<Operand> comparison() {
    auto left = operand();
    if (!left) return std::nullopt;
    if (is_word("in")) return membership(*left, false);
    if (is_word("not")) {
      step();
      if (!is_word("in"))
        return fail(DiagnosticId::bad_expression, token_.at, "expected 'in' after 'not'");
      return membership(*left, true);
    }
    const auto op = token_.sort == Token::Sort::symbol ? comparison_of(token_.text) : std::nullopt;
    if (!op) return left;
    const size_t at = token_.at;
    step();
    auto right = operand();
    if (!right || !agree(*left, *right)) return std::nullopt;
    if (left->type != Type::number && *op != Op::equal && *op != Op::not_equal) {
      return fail(DiagnosticId::expression_type, at,
                  fmt::format("{} cannot be ordered; use == or !=", type_name(left->type)));
    }
    return append(*op, left->id, right->id, left->at);
  }

  std::optional<Operand> membership(const Operand& left, bool negated) {
    step();
    if (left.type == Type::text) {
      return fail(DiagnosticId::expression_type, left.at,
                  "a quoted option cannot be the left side of 'in'; write the setting there");
    }
    if (!is_symbol("["))
      return fail(DiagnosticId::bad_expression, token_.at, "expected '[' after 'in'");
    Expression expression;
    expression.op = Op::in;
    expression.left = left.id;
    do {
      step();
      auto one = literal();
      if (!one) return std::nullopt;
      Operand other = left;
      if (!agree(other, *one)) return std::nullopt;
      expression.list.push_back(graph_.expressions[one->id.value].literal);
      graph_.expressions.pop_back(); // the list stores the value itself
    } while (is_symbol(","));
    if (!is_symbol("]")) {
      return fail(DiagnosticId::bad_expression, token_.at,
                  fmt::format("expected ',' or ']', found {}", describe(token_)));
    }
    step();
    const Operand found = append(std::move(expression), Type::boolean, left.at);
    return negated ? append(Op::logical_not, found.id, {}, left.at) : found;
  }

  // Checks that both sides have one type. Resolves a text to an option of the other side's setting.
  bool agree(Operand& left, Operand& right) {
    if (left.type == Type::option && right.type == Type::text) return resolve(right, left.setting);
    if (left.type == Type::text && right.type == Type::option) return resolve(left, right.setting);
    if (left.type != right.type || left.type == Type::text) {
      fail(DiagnosticId::expression_type, right.at,
           fmt::format("{} is compared with {}", type_name(left.type), type_name(right.type)));
      return false;
    }
    if (left.type == Type::option && graph_.settings[left.setting.value].options !=
                                         graph_.settings[right.setting.value].options) {
      fail(DiagnosticId::expression_type, right.at,
           fmt::format("the settings '{}' and '{}' have different options",
                       graph_.settings[left.setting.value].name,
                       graph_.settings[right.setting.value].name));
      return false;
    }
    return true;
  }

  bool resolve(Operand& text, SettingId setting) {
    const SettingDeclaration& declared = graph_.settings[setting.value];
    for (size_t i = 0; i < declared.options.size(); ++i) {
      if (declared.options[i] != text.text) continue;
      Expression expression;
      expression.literal = {declared.type, static_cast<int64_t>(i), 0.0};
      text = append(std::move(expression), Type::option, text.at, setting);
      return true;
    }
    const std::vector<std::string_view> options(declared.options.begin(), declared.options.end());
    fail(DiagnosticId::expression_type, text.at,
         fmt::format("'{}' is not an option of the setting '{}'; expected {}", text.text,
                     declared.name, list_words(options)),
         did_you_mean(text.text, options));
    return false;
  }

  std::optional<Operand> operand() {
    const Token token = token_;
    if (is_symbol("(")) {
      if (!enter(token.at)) return std::nullopt;
      step();
      auto inner = disjunction();
      --depth_;
      if (!inner) return std::nullopt;
      if (!is_symbol(")")) {
        return fail(DiagnosticId::bad_expression, token_.at,
                    fmt::format("expected ')', found {}", describe(token_)));
      }
      step();
      inner->at = token.at;
      return inner;
    }
    if (token.sort == Token::Sort::word && !is_reserved_word(token.text)) return setting();
    return literal();
  }

  std::optional<Operand> setting() {
    const Token token = token_;
    step();
    std::vector<std::string_view> names;
    for (uint32_t i = 0; i < graph_.settings.size(); ++i) {
      const SettingDeclaration& declared = graph_.settings[i];
      names.push_back(declared.name);
      if (declared.name != token.text) continue;
      if (broken_[i]) return std::nullopt;
      Expression expression;
      expression.op = Op::setting;
      expression.setting = {i};
      const Type type =
          declared.type == SettingType::boolean ? Type::boolean
          : declared.type == SettingType::integer || declared.type == SettingType::real
              ? Type::number
              : Type::option;
      return append(std::move(expression), type, token.at, {i});
    }
    return fail(DiagnosticId::unknown_setting, token.at,
                fmt::format("there is no setting '{}'", token.text),
                did_you_mean(token.text, names));
  }

  std::optional<Operand> literal() {
    const Token token = token_;
    Expression expression;
    switch (token.sort) {
    case Token::Sort::word:
      if (token.text != "true" && token.text != "false") break;
      step();
      expression.literal = {SettingType::boolean, token.text == "true" ? 1 : 0, 0.0};
      return append(std::move(expression), Type::boolean, token.at);
    case Token::Sort::integer:
      step();
      expression.literal = {SettingType::integer, token.integer, 0.0};
      return append(std::move(expression), Type::number, token.at);
    case Token::Sort::real:
      step();
      expression.literal = {SettingType::real, 0, token.real};
      return append(std::move(expression), Type::number, token.at);
    case Token::Sort::text:
      step();
      return Operand{Type::text, {}, {}, token.text, token.at};
    case Token::Sort::symbol:
    case Token::Sort::end:
    case Token::Sort::malformed:
      break;
    }
    return fail(DiagnosticId::bad_expression, token.at,
                fmt::format("expected a setting or a value, found {}", describe(token)));
  }

  bool enter(size_t at) {
    if (++depth_ <= limits::expression_nesting) return true;
    fail(DiagnosticId::limit_exceeded, at,
         fmt::format("nested more than {} deep", limits::expression_nesting));
    return false;
  }

  const Document& document_;
  NodeId node_;
  std::string_view what_;
  Graph& graph_;
  const std::vector<bool>& broken_;
  Diagnostics& diagnostics_;
  ExpressionLexer lexer_;
  Token token_;
  uint32_t depth_ = 0;
};

} // namespace

ExpressionId parse_expression(const Document& document, NodeId node, std::string_view what,
                              Graph& graph, const std::vector<bool>& broken,
                              Diagnostics& diagnostics) {
  if (document.text(node).size() > limits::expression_bytes) {
    diagnostics.add(DiagnosticId::limit_exceeded, document.where(node),
                    fmt::format("{} has {} bytes; at most {} are allowed", what,
                                document.text(node).size(), limits::expression_bytes));
    return {};
  }
  const size_t before = graph.expressions.size();
  const ExpressionId id = Parser(document, node, what, graph, broken, diagnostics).parse();
  if (!id.valid()) graph.expressions.resize(before);
  return id;
}

} // namespace dermis
