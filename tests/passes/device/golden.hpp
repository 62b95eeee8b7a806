#pragma once
// Hashes of golden frames by driver. golden_frames.txt has lines "driver <tab> graph <tab>
// SHA-256".

#include "tests/passes/device/player.hpp"

#include <string>
#include <vector>

namespace dermis::testing {

// Returns the hash of all texels that the host got, frame by frame, slot by slot.
std::string hash_of(const Played& played);

// Returns the light of all frames as floats, rgb, slot by slot; golden_show uses half and float
// formats.
std::vector<float> light_of(const Played& played);

// Returns the hash for frames of `graph`, or "" if the table has none.
std::string golden_hash(const std::string& driver, const std::string& graph);
// Returns the drivers in the table, one per line.
std::string golden_drivers();
// Writes the hash into the table and keeps the other lines.
void keep_golden_hash(const std::string& driver, const std::string& graph, const std::string& hash);

} // namespace dermis::testing
