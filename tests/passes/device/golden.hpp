#pragma once
// Hashes of golden frames, kept by driver: golden_frames.txt has lines "driver <tab> graph <tab> SHA-256".

#include "tests/passes/device/player.hpp"

#include <string>
#include <vector>

namespace dermis::testing {

// Of all that the host got, frame by frame, slot by slot.
std::string hash_of(const Played& played);

// Light of all frames as floats, rgb, slot by slot: of golden_show's formats, halves and floats.
std::vector<float> light_of(const Played& played);

// That of frames of `graph`; "" where it is not in the table.
std::string golden_hash(const std::string& driver, const std::string& graph);
// The drivers that are in the table, one a line.
std::string golden_drivers();
// Writes it into the table; the rest stays as it is.
void keep_golden_hash(const std::string& driver, const std::string& graph, const std::string& hash);

} // namespace dermis::testing
