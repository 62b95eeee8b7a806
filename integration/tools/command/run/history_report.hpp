#pragma once
// What a graph's histories hold after a frame: age, and why one holds nothing.

#include "framegraph/text/json_writer.hpp"
#include "integration/examples/demo_engine/engine.hpp"

#include <span>
#include <string>

namespace dermis::tools {

// A table, a history each; "" where there are none.
std::string describe_histories(std::span<const demo::FrameHistory> histories);
// [{"name": .., "valid": .., "age": .., "why": ..}, ..]
void write_histories(JsonWriter& writer, std::span<const demo::FrameHistory> histories);

} // namespace dermis::tools
