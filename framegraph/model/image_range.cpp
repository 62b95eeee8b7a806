#include "framegraph/model/image_range.hpp"

#include "framegraph/text/limits.hpp"

#include <charconv>
#include <fmt/format.h>

namespace dermis {
namespace {

struct Numbers {
  uint32_t first = 0, count = 0; // count 0: to the last
};

// Parses "2", "1..3" or "1..", with each number below `limit`.
std::optional<Numbers> parse_numbers(std::string_view text, uint32_t limit) {
  const auto number = [&](std::string_view digits) -> std::optional<uint32_t> {
    uint32_t value = 0;
    const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool whole = result.ec == std::errc() && result.ptr == digits.data() + digits.size();
    return whole && value < limit ? std::optional(value) : std::nullopt;
  };
  const size_t dots = text.find("..");
  const auto first = number(text.substr(0, dots));
  if (!first) return std::nullopt;
  if (dots == std::string_view::npos) return Numbers{*first, 1};
  if (dots + 2 == text.size()) return Numbers{*first, 0};
  const auto last = number(text.substr(dots + 2));
  if (!last || *last < *first) return std::nullopt;
  return Numbers{*first, *last - *first + 1};
}

std::string numbers_text(uint32_t first, uint32_t count) {
  if (count == 0) return fmt::format("{}..", first);
  return count == 1 ? fmt::format("{}", first) : fmt::format("{}..{}", first, first + count - 1);
}

} // namespace

std::optional<ImageRange> parse_image_range(std::string_view text) {
  ImageRange range;
  if (text.starts_with('#')) {
    const size_t end = std::min(text.find('['), text.size());
    const auto mips = parse_numbers(text.substr(1, end - 1), limits::image_mips);
    if (!mips) return std::nullopt;
    range.first_mip = static_cast<uint8_t>(mips->first);
    range.mips = static_cast<uint8_t>(mips->count);
    text.remove_prefix(end);
  }
  if (text.empty()) return range;
  if (!text.starts_with('[') || !text.ends_with(']')) return std::nullopt;
  const auto layers = parse_numbers(text.substr(1, text.size() - 2), limits::image_layers);
  if (!layers) return std::nullopt;
  range.first_layer = static_cast<uint16_t>(layers->first);
  range.layers = static_cast<uint16_t>(layers->count);
  return range;
}

std::string image_range_text(const ImageRange& range) {
  std::string text;
  if (range.first_mip != 0 || range.mips != 0)
    text += fmt::format("#{}", numbers_text(range.first_mip, range.mips));
  if (range.first_layer != 0 || range.layers != 0)
    text += fmt::format("[{}]", numbers_text(range.first_layer, range.layers));
  return text;
}

} // namespace dermis
