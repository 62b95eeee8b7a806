#pragma once
// The JSON Schemas that the command carries.

#include <span>
#include <string>
#include <string_view>

namespace dermis::tools {

struct NamedSchema {
  std::string_view name, text;
};

// Those that are written by hand in configs/schema/; those of graphs and fragments follow from the pass
// kinds.
std::span<const NamedSchema> written_schemas();

// "graph, profile, ...": for help.
std::string schema_names();

} // namespace dermis::tools
