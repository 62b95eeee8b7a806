#pragma once
// The JSON Schemas that the command carries.

#include "integration/tools/command/session.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

struct NamedSchema {
  std::string_view name, text;
};

// Those that are written by hand in configs/schema/; those of graphs and fragments follow from the pass
// kinds.
std::span<const NamedSchema> written_schemas();

struct DocsOptions {
  std::string out = "docs";              // folder
  std::string graphs = "configs/graphs"; // folder of the graphs whose slots are listed
  bool check = false;                    // write nothing, fail where a page is not as it would be written
};
// Writes the pages of documentation that follow from schemas and signatures, and the table of slots into
// integration.md where the folder has that page.
ExitCode docs(const Session& session, const DocsOptions& options);

// "graph", "fragment", ...
std::vector<std::string> schema_names();

} // namespace dermis::tools
