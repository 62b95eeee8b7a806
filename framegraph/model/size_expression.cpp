#include "framegraph/model/size_expression.hpp"

#include "framegraph/text/limits.hpp"
#include "framegraph/text/reader.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <numeric>

namespace dermis {

namespace {

std::string_view trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

// Parses a decimal integer in 1 .. limits::size_factor.
std::optional<int64_t> factor_of(std::string_view text) {
  text = trimmed(text);
  int64_t value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || result.ptr != text.data() + text.size()) return std::nullopt;
  if (value < 1 || value > limits::size_factor) return std::nullopt;
  return value;
}

std::optional<SizeExpression> parse_text(const Document& document, NodeId node,
                                         std::string_view what, ResourceId owner,
                                         const std::function<ResourceId(std::string_view)>& find,
                                         Diagnostics& diagnostics) {
  const std::string_view text = document.text(node);
  const auto reject = [&](size_t at, std::string reason) {
    diagnostics.add(DiagnosticId::bad_size, where_in_string(document, node, at, diagnostics),
                    fmt::format("{}: {}", what, reason));
    return std::nullopt;
  };
  const size_t slash = text.find('/');
  const size_t star = std::min(text.substr(0, slash).find('*'), text.size());
  const size_t base_end = std::min({star, slash, text.size()});
  const std::string range = fmt::format("expected an integer in 1 .. {}", limits::size_factor);
  std::optional<int64_t> numerator = 1, denominator = 1;
  if (star < text.size())
    numerator = factor_of(text.substr(star + 1, std::min(slash, text.size()) - star - 1));
  if (!numerator) return reject(star + 1, range + " after '*'");
  if (slash != std::string_view::npos) denominator = factor_of(text.substr(slash + 1));
  if (!denominator) return reject(slash + 1, range + " after '/'");
  const std::string_view base = trimmed(text.substr(0, base_end));
  if (base.empty()) return reject(0, "expected 'view' or the name of a resource");
  SizeExpression out;
  const int64_t divisor = std::gcd(*numerator, *denominator);
  out.x = out.y = {*numerator / divisor, *denominator / divisor};
  if (base == "view") return out;
  if (base == "square_view") {
    out.base = SizeExpression::Base::square_view;
    return out;
  }
  out.base = SizeExpression::Base::resource;
  out.resource = find(base);
  if (!out.resource.valid()) return std::nullopt;
  if (out.resource == owner)
    return reject(0, "the size of a resource cannot refer to the resource itself");
  return out;
}

} // namespace

std::optional<SizeExpression> parse_size(const Document& document, NodeId node,
                                         std::string_view what, ResourceId owner, bool single,
                                         const std::function<ResourceId(std::string_view)>& find,
                                         Diagnostics& diagnostics) {
  if (document[node].kind == NodeKind::string)
    return parse_text(document, node, what, owner, find, diagnostics);
  SizeExpression out;
  out.base = SizeExpression::Base::fixed;
  if (single && document[node].kind == NodeKind::integer) {
    const auto count = read_integer(document, node, what, 1, limits::buffer_elements, diagnostics);
    if (!count) return std::nullopt;
    out.x = {*count, 1};
    out.y = {1, 1};
    return out;
  }
  if (document[node].kind != NodeKind::array || document[node].child_count != 2) {
    const bool list = document[node].kind == NodeKind::array;
    diagnostics.add(
        DiagnosticId::wrong_type, document.where(node),
        fmt::format("{} must be a size: a string or [width, height]; found {}{}", what,
                    kind_name(document[node].kind),
                    list ? fmt::format(" of {} values", document[node].child_count) : ""));
    return std::nullopt;
  }
  const NodeId first = document[node].first_child;
  const auto width = read_integer(document, first, fmt::format("the width in {}", what), 1,
                                  limits::image_side, diagnostics);
  const auto height =
      read_integer(document, document[first].next, fmt::format("the height in {}", what), 1,
                   limits::image_side, diagnostics);
  if (!width || !height) return std::nullopt;
  out.x = {*width, 1};
  out.y = {*height, 1};
  return out;
}

} // namespace dermis
