#pragma once
// The JSON Schema (draft-07) of the graph file, for editors and programs that write graphs. Limits, formats,
// kinds, ports and settings come from the declarations that read_graph checks with; a test demands the same
// verdict of both on damaged files. What only the parser can judge (names, references, expressions, sizes
// within strings, cycles) is not in it, nor is any "pattern": matchers recurse on hostile strings.

#include "framegraph/model/pass_kind.hpp"

#include <string>

namespace dermis {

// Of graphs that use `kinds` and no others. Same kinds, same bytes. Any thread.
std::string graph_schema(const KindRegistry& kinds);
// Of the fragments that such graphs include.
std::string fragment_schema(const KindRegistry& kinds);

} // namespace dermis
