#pragma once
// The parts of the graph's schema that do not depend on the pass types. Inside of graph_schema.hpp.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dermis {

inline constexpr std::string_view schema_dialect = "http://json-schema.org/draft-07/schema#";

// Key and JSON text, in the order in which they are written.
using SchemaMembers = std::vector<std::pair<std::string_view, std::string>>;

SchemaMembers graph_root_members();
SchemaMembers fragment_root_members();
// `pass_type_names`: the names of all pass types as the inside of a JSON array.
SchemaMembers graph_definitions(std::string_view pass_type_names);

} // namespace dermis
