#pragma once
// Provides the parts of the graph's schema that do not depend on the pass types. Internal to
// graph_schema.hpp.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dermis {

inline constexpr std::string_view schema_dialect = "http://json-schema.org/draft-07/schema#";

// Key and JSON text, in output order.
using SchemaMembers = std::vector<std::pair<std::string_view, std::string>>;

SchemaMembers graph_root_members();
SchemaMembers fragment_root_members();
// `pass_type_names`: the contents of a JSON array with the names of all pass types.
SchemaMembers graph_definitions(std::string_view pass_type_names);

} // namespace dermis
