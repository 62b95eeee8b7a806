#pragma once
// Reports a graph's histories after a frame: age, and the reason why a history is invalid.

#include "framegraph/text/json_writer.hpp"
#include "integration/examples/demo_engine/engine.hpp"

#include <span>
#include <string>

namespace dermis::tools {

// Returns a table with one row per history, or "" if there are none.
std::string describe_histories(std::span<const demo::FrameHistory> histories);
// [{"name": .., "valid": .., "age": .., "why": ..}, ..]
void write_histories(JsonWriter& writer, std::span<const demo::FrameHistory> histories);

} // namespace dermis::tools
