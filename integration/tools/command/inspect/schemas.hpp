#pragma once
// The JSON Schemas embedded in the command.

#include "integration/tools/command/session.hpp"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

struct NamedSchema {
  std::string_view name, text;
};

// Returns the hand-written schemas of configs/schema/. Schemas of graphs and fragments are
// generated from the pass types.
std::span<const NamedSchema> written_schemas();

struct DocsOptions {
  std::string out = "docs";              // folder
  std::string graphs = "configs/graphs"; // folder of the graphs whose slots are listed
  bool check = false;                    // write nothing; fail if a page is out of date
};
// Writes the documentation pages generated from schemas and signatures, and the table of slots into
// integration.md if the folder has that page.
ExitCode docs(const Session& session, const DocsOptions& options);

// "graph", "fragment", ...
std::vector<std::string> schema_names();

} // namespace dermis::tools
