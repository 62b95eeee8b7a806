// dermis schema: the JSON Schemas of all file formats.

#include "framegraph/schema/graph_schema.hpp"
#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/suggest.hpp"
#include "integration/command/inspect/reference_pages/pages.hpp"
#include "integration/command/inspect/schemas.hpp"
#include "integration/command/output.hpp"
#include "integration/command/verbs.hpp"
#include "integration/files/bytes.hpp"
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

std::vector<std::string> schema_names() {
  std::vector<std::string> names = {"graph", "fragment"};
  for (const NamedSchema& one : written_schemas())
    names.emplace_back(one.name);
  return names;
}

ExitCode schema(const Session& session, const SchemaOptions& options) {
  if (options.name.empty()) {
    if (options.out != "-") return write_all(session, options.out);
    return fail(
        session, ExitCode::usage,
        fmt::format("name one of {}, or a folder for all of them with --out", format_list(schema_names())));
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
                          suggestion.empty() ? "schemas: " + format_list(schema_names()) : suggestion));
}

ExitCode docs(const Session& session, const DocsOptions& options) {
  const std::pair<std::string, std::string> pages[] = {
      {"format_reference.md", format_page(all_schemas())},
      {"pass_kinds.md", kinds_page(subsurface::make_kinds())}};
  OutputFolder folder;
  if (const std::string problem = folder.open(options.out); !problem.empty())
    return fail(session, ExitCode::environment, problem);
  for (const auto& [name, text] : pages) {
    const std::string file = folder.path_of(name);
    std::string problem;
    if (options.check) {
      const auto bytes = read_bytes(file, limits::file_bytes, problem);
      if (!bytes || std::string_view(reinterpret_cast<const char*>(bytes->data()), bytes->size()) != text)
        return fail(session, ExitCode::problems,
                    fmt::format("{} is not what the declarations say now; dermis docs --out {} writes it",
                                file, options.out));
      continue;
    }
    problem = deliver_text(file, text);
    if (!problem.empty()) return fail(session, ExitCode::environment, problem);
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
