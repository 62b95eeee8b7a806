// dermis schema: the JSON Schemas of all file formats.

#include "framegraph/schema/graph_schema.hpp"
#include "framegraph/text/suggest.hpp"
#include "integration/command/inspect/schemas.hpp"
#include "integration/command/output.hpp"
#include "integration/command/verbs.hpp"
#include "passes/subsurface/kinds.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace dermis::tools {
namespace {

std::vector<std::pair<std::string_view, std::string>> all_schemas() {
  std::vector<std::pair<std::string_view, std::string>> all;
  all.emplace_back("graph", graph_schema(subsurface::make_kinds()));
  all.emplace_back("fragment", fragment_schema(subsurface::make_kinds()));
  for (const NamedSchema& one : written_schemas())
    all.emplace_back(one.name, std::string(one.text));
  return all;
}

ExitCode write_all(const Session& session, const std::string& path) {
  OutputFolder folder;
  if (const std::string problem = folder.open(path); !problem.empty())
    return fail(session, ExitCode::environment, problem);
  for (const auto& [name, text] : all_schemas()) {
    const std::string file = folder.path_of(fmt::format("{}.schema.json", name));
    if (const std::string problem = deliver_text(file, text); !problem.empty())
      return fail(session, ExitCode::environment, problem);
    say(session, fmt::format("{}\n", file));
  }
  return ExitCode::ok;
}

} // namespace

std::string schema_names() {
  std::string names = "graph, fragment";
  for (const NamedSchema& one : written_schemas())
    names += fmt::format(", {}", one.name);
  return names;
}

ExitCode schema(const Session& session, const SchemaOptions& options) {
  if (options.name.empty()) {
    if (options.out != "-") return write_all(session, options.out);
    return fail(session, ExitCode::usage,
                fmt::format("name one of {}, or a folder for all of them with --out", schema_names()));
  }
  std::vector<std::string_view> names;
  const auto all = all_schemas();
  for (const auto& [name, text] : all) {
    names.push_back(name);
    if (name != options.name) continue;
    const std::string problem = deliver_text(options.out, text);
    return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
  }
  const std::string suggestion = did_you_mean(options.name, names);
  return fail(session, ExitCode::usage,
              fmt::format("there is no schema '{}'; {}", options.name,
                          suggestion.empty() ? "schemas: " + schema_names() : suggestion));
}

} // namespace dermis::tools
