#include "integration/files/exr_layout.hpp"

namespace dermis::tools::exr_layout {

namespace {
constexpr uint8_t zero_difference = 128;
}

std::vector<uint8_t> prepare(std::span<const uint8_t> bytes) {
  std::vector<uint8_t> result(bytes.size());
  const size_t half = (bytes.size() + 1) / 2;
  for (size_t i = 0; i < bytes.size(); ++i)
    result[i / 2 + (i % 2 ? half : 0)] = bytes[i];
  for (size_t i = result.size(); i-- > 1;)
    result[i] = static_cast<uint8_t>(result[i] - result[i - 1] + zero_difference);
  return result;
}

std::vector<uint8_t> restore(std::vector<uint8_t> prepared) {
  for (size_t i = 1; i < prepared.size(); ++i)
    prepared[i] = static_cast<uint8_t>(prepared[i] + prepared[i - 1] - zero_difference);
  std::vector<uint8_t> result(prepared.size());
  const size_t half = (prepared.size() + 1) / 2;
  for (size_t i = 0; i < result.size(); ++i)
    result[i] = prepared[i / 2 + (i % 2 ? half : 0)];
  return result;
}

} // namespace dermis::tools::exr_layout
