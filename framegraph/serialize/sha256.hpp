#pragma once
// SHA-256 (FIPS 180-4).

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace dermis {

using Digest = std::array<uint8_t, 32>;

Digest sha256(std::string_view bytes);
std::string digest_text(const Digest& digest); // 64 hex digits

} // namespace dermis
