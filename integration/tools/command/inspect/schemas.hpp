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
  std::string out = "build/docs";        // folder
  std::string graphs = "configs/graphs"; // folder of the graphs whose slots are listed
};
// Writes the pages generated from declarations: the file formats, the pass types, and the slots of
// all graphs.
ExitCode docs(const Session& session, const DocsOptions& options);

// "graph", "fragment", ...
std::vector<std::string> schema_names();

} // namespace dermis::tools
