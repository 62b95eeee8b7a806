#pragma once
// Pages of documentation that follow from declarations, as Markdown.

#include "framegraph/model/pass_kind.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace dermis::tools {

// Tables of the keys of each schema (name, text), in this order.
std::string format_page(std::span<const std::pair<std::string_view, std::string>> schemas);

// Ports and settings of each kind.
std::string kinds_page(const KindRegistry& kinds);

} // namespace dermis::tools
