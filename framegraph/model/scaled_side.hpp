#pragma once

#include "framegraph/model/align_up.hpp"
#include "framegraph/model/graph.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

namespace dermis {

// Returns one side of a size: align_up(round(base * factor), align), at least 1, plus the border on
// both sides. `factor` is size.x or size.y. Returns nullopt if the factor is negative or the result
// exceeds 32 bits.
inline std::optional<uint32_t> scaled_side(uint64_t base, Rational factor,
                                           const SizeExpression& size) {
  if (factor.numerator < 0 || factor.denominator <= 0) return std::nullopt;
  const auto numerator = static_cast<uint64_t>(factor.numerator);
  const auto denominator = static_cast<uint64_t>(factor.denominator);
  const bool wide = ((base | numerator) >> 32) != 0;
  if (wide && numerator != 0 && base > UINT64_MAX / numerator) return std::nullopt;
  const uint64_t product = base * numerator;
  const uint64_t whole = product / denominator;
  const bool up = (size.rounding == Rounding::ceil) & (whole * denominator != product);
  const uint64_t value = std::max<uint64_t>(whole + (up ? 1 : 0), 1);
  if (value > UINT32_MAX) return std::nullopt;
  const uint64_t step = std::max<uint32_t>(size.align, 1);
  const uint64_t side = (step == 1 ? value : align_up(value, step)) + 2 * uint64_t{size.border};
  if (side > UINT32_MAX) return std::nullopt;
  return static_cast<uint32_t>(side);
}

} // namespace dermis
