#pragma once
// Lists the expected time and error of each configuration in a frame.

#include "framegraph/text/json_writer.hpp"
#include "integration/examples/demo_engine/engine.hpp"

#include <span>
#include <string>

namespace dermis::tools {

// Returns a table; "" for graphs with one configuration. Rows that another one dominates, in time
// and error, are marked.
std::string describe_frontier(std::span<const demo::FrameOutcome> outcomes);
void write_frontier(JsonWriter& writer, std::span<const demo::FrameOutcome> outcomes);

} // namespace dermis::tools
