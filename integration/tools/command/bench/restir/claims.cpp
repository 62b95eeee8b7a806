#include "integration/tools/command/bench/restir/claims.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

constexpr double much = 0.5; // maximum fraction of the error that remains
// statistical error of a mean square error of this many pixels and frames
constexpr double chance = 1.1;

// Returns the row with equal number of paths and this reuse and shift, or null if it was not
// measured.
const RestirRow* find_row(std::span<const RestirRow> rows, const RestirRow& like,
                          std::string_view reuse, std::string_view shift) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const RestirRow& row) {
    return row.samples == like.samples && row.variant.reuse == reuse && row.variant.shift == shift;
  });
  return found == rows.end() ? nullptr : &*found;
}

std::optional<double> limit_of(std::span<const RestirRow> rows, const RestirRow& row) {
  const RestirVariant& variant = row.variant;
  if (variant.shift == "sequential") {
    const RestirRow* reconnected = find_row(rows, row, variant.reuse, "reconnection");
    const RestirRow* replayed = find_row(rows, row, variant.reuse, "delayed");
    if (reconnected == nullptr || replayed == nullptr) return std::nullopt;
    return chance * std::max(reconnected->error.all.mse, replayed->error.all.mse);
  }
  const RestirRow* none = find_row(rows, row, "none", "");
  if (none == nullptr || variant.reuse == "none") return std::nullopt;
  if (variant.reuse == "spatial") return chance * none->error.all.mse;
  const RestirRow* spatial = find_row(rows, row, "spatial", variant.shift);
  const bool both = variant.reuse == "spatiotemporal" && spatial != nullptr;
  return much *
         (both ? std::min(none->error.all.mse, spatial->error.all.mse) : none->error.all.mse);
}

} // namespace

std::string expectation_text() {
  return "for equal numbers of frames: spatial reuse has at most the error of no reuse, plus 10 % "
         "for "
         "chance; reuse with history at most half of that, and half of the error of only spatial "
         "reuse; a "
         "sequential shift at most the larger error of its parts";
}

void expect_of_reuse(std::span<RestirRow> rows) {
  for (RestirRow& row : rows)
    if (row.samples > 0) row.max_mse = limit_of(rows, row);
}

} // namespace dermis::tools
