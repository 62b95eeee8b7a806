#pragma once
// Writes the JSON Schema (draft-07) of graph files, for editors and programs that write graphs.
// Limits, formats, pass types, ports and settings come from the declarations that read_graph
// checks; a test compares both verdicts on damaged files. The schema omits what only the parser can
// judge: names, references, expressions, sizes within strings, and cycles. It uses no "pattern",
// because matchers recurse on hostile strings.

#include "framegraph/model/pass_type.hpp"

#include <string>

namespace dermis {

// Returns the schema of graphs that only use `pass_types`. Equal pass types give equal bytes. Any
// thread.
std::string graph_schema(const PassTypeRegistry& pass_types);
// Returns the schema of the fragments that such graphs include.
std::string fragment_schema(const PassTypeRegistry& pass_types);

} // namespace dermis
