#pragma once
// The JSON Schema (draft-07) of the graph file, for editors and programs that write graphs. Limits, formats,
// pass types, ports and settings come from the declarations that read_graph checks with; a test demands the
// same verdict of both on damaged files. What only the parser can judge (names, references, expressions,
// sizes within strings, cycles) is not in it, nor is any "pattern": matchers recurse on hostile strings.

#include "framegraph/model/pass_type.hpp"

#include <string>

namespace dermis {

// Of graphs that use `pass_types` and no others. Same pass types, same bytes. Any thread.
std::string graph_schema(const PassTypeRegistry& pass_types);
// Of the fragments that such graphs include.
std::string fragment_schema(const PassTypeRegistry& pass_types);

} // namespace dermis
