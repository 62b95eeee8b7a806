#pragma once
// Compares with another build of the program: the scenes as a capture that `dermis apply` of that
// build renders, and the pictures that it wrote.

#include "integration/tools/command/bench/reference.hpp"
#include "integration/tools/command/bench/subject.hpp"

#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// Writes one frame per subject. All frames list all `profiles`, so that `apply` makes one graph.
// Errors: environment (the folder cannot be written).
demo::Result<> write_captures(const std::string& folder, std::span<const Subject> subjects,
                              std::span<const CaptureProfile> profiles);

// Reads the scattered light that `apply --out FOLDER` wrote for frame `number`, 3 values per pixel.
// Errors: input (missing, or of another size).
demo::Result<std::vector<float>> read_picture(const std::string& folder, size_t number,
                                              uint32_t width, uint32_t height);

struct PairedRatio {
  double ratio = 1, low = 1,
         high = 1; // 95 % interval; equal to the ratio if all pixels were measured
};

// Returns the RMSE of `light` divided by that of `other`, with the bootstrap's percentile interval
// over pixels (Efron 1979): each resample uses the same pixels of both. Nullopt if `other` has no
// error.
std::optional<PairedRatio> paired_ratio(std::span<const float> light, std::span<const float> other,
                                        const Reference& reference);

} // namespace dermis::tools
