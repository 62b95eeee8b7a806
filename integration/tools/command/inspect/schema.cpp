// dermis schema: writes the JSON Schemas of all file formats.

#include "framegraph/schema/graph_schema.hpp"
#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/suggest.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/inspect/reference_pages/pages.hpp"
#include "integration/tools/command/inspect/schemas.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/shipped.hpp"
#include "integration/tools/command/verbs.hpp"
#include "passes/common/pass_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

namespace dermis::tools {
namespace {

using Schemas = std::vector<std::pair<std::string_view, std::string>>; // names and texts

Schemas all_schemas(const PassTypeRegistry& pass_types) {
  Schemas all;
  all.emplace_back("graph", graph_schema(pass_types));
  all.emplace_back("fragment", fragment_schema(pass_types));
  for (const NamedSchema& one : written_schemas())
    all.emplace_back(one.name, std::string(one.text));
  return all;
}

ExitCode write_all(const Session& session, const Schemas& schemas, const std::string& path) {
  OutputFolder folder;
  if (const std::string problem = folder.open(path); !problem.empty())
    return fail(session, ExitCode::environment, problem);
  std::vector<std::string> files;
  for (const auto& [name, text] : schemas) {
    const std::string file = folder.path_of(fmt::format("{}.schema.json", name));
    if (const std::string problem = deliver_text(file, text); !problem.empty())
      return fail(session, ExitCode::environment, problem);
    say(session, fmt::format("{}\n", file));
    files.push_back(file);
  }
  if (session.json) {
    JsonWriter answer;
    answer.open_object().member("ok", true).key("files").open_array();
    for (const std::string& file : files)
      answer.value(file);
    print(std::move(answer.close().close()).finish());
  }
  return ExitCode::ok;
}

// Returns all graphs below a folder, sorted by file name, or nullopt with errors in `diagnostics`.
std::optional<std::vector<NamedGraph>> graphs_in(const std::string& folder,
                                                 Diagnostics& diagnostics) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, ignored))
    if (entry.path().extension() == ".json" && entry.path().stem().extension() != ".expect")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return a.filename() < b.filename(); });
  std::vector<NamedGraph> graphs;
  for (const std::filesystem::path& file : files) {
    std::optional<LoadedGraph> loaded = load_graph(file.string(), {}, diagnostics);
    if (!loaded) return std::nullopt;
    graphs.push_back({file.stem().string(), std::move(loaded->graph)});
  }
  return graphs;
}

} // namespace

std::vector<std::string> schema_names() {
  std::vector<std::string> names = {"graph", "fragment"};
  for (const NamedSchema& one : written_schemas())
    names.emplace_back(one.name);
  return names;
}

ExitCode schema(const Session& session, const SchemaOptions& options) {
  Diagnostics diagnostics;
  const auto loaded = load_pass_types(options.pass_types, diagnostics);
  if (!loaded)
    return fail(session, ExitCode::problems, "the pass types cannot be used", &diagnostics);
  const Schemas all = all_schemas(loaded->pass_types);
  if (options.name.empty()) {
    if (options.out != "-") return write_all(session, all, options.out);
    return fail(session, ExitCode::usage,
                fmt::format("name one of {}, or a folder for all of them with --out",
                            format_list(schema_names())));
  }
  std::vector<std::string_view> names;
  for (const auto& [name, text] : all) {
    names.push_back(name);
    if (name != options.name) continue;
    const std::string problem = deliver_text(options.out, text);
    return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
  }
  const std::string suggestion = did_you_mean(options.name, names);
  return fail(
      session, ExitCode::usage,
      fmt::format("there is no schema '{}'; {}", options.name,
                  suggestion.empty() ? "schemas: " + format_list(schema_names()) : suggestion));
}

ExitCode docs(const Session& session, const DocsOptions& options) {
  OutputFolder folder;
  if (const std::string problem = folder.open(options.out); !problem.empty())
    return fail(session, ExitCode::environment, problem);
  Diagnostics diagnostics;
  const auto graphs = graphs_in(shipped(options.graphs), diagnostics);
  if (!graphs) return fail_graph(session, options.graphs, diagnostics);
  if (graphs->empty())
    return fail(session, ExitCode::problems, fmt::format("{} holds no graphs", options.graphs));
  const std::pair<std::string, std::string> pages[] = {
      {"format_reference.md", format_page(all_schemas(subsurface::make_pass_types()))},
      {"pass_types.md", pass_types_page(subsurface::make_pass_types())},
      {"slots.md", slots_page(*graphs)}};
  for (const auto& [name, text] : pages) {
    const std::string file = folder.path_of(name);
    if (const std::string problem = deliver_text(file, text); !problem.empty())
      return fail(session, ExitCode::environment, problem);
    say(session, fmt::format("{}\n", file));
  }
  if (session.json) {
    JsonWriter answer;
    answer.open_object().member("ok", true).key("pages").open_array();
    for (const auto& [name, text] : pages)
      answer.value(folder.path_of(name));
    answer.close().close();
    print(std::move(answer).finish());
  }
  return ExitCode::ok;
}

} // namespace dermis::tools
