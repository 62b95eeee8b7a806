// dermis upgrade: brings files to the newest version of their format. Every format is at its first version,
// so that there is nothing to rewrite; what no version of this library knows is refused.

#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/reader.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/inspect/file_kind.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

struct Judged {
  std::string path;
  std::string_view kind = "unreadable";
  int64_t version = 0; // 0: none that is known
};

Judged judge(const std::string& path, Diagnostics& diagnostics) {
  const std::optional<Document> document = read_input(path, diagnostics);
  if (!document) return {path};
  const FileKind& kind = file_kinds()[static_cast<size_t>(file_kind_of(*document))];
  const bool known = check_version(*document, kind.version_key, kind.version, diagnostics);
  return {path, kind.name, known ? kind.version : 0};
}

} // namespace

ExitCode upgrade(const Session& session, const UpgradeOptions& options) {
  Diagnostics diagnostics;
  std::vector<Judged> files;
  for (const std::string& path : options.files)
    files.push_back(judge(path, diagnostics));
  const bool all_known =
      std::all_of(files.begin(), files.end(), [](const Judged& one) { return one.version > 0; });
  print_diagnostics(session, diagnostics);
  for (const Judged& one : files)
    if (one.version > 0)
      say(session, fmt::format("{}: {}, version {} is the newest: nothing to {}\n", one.path, one.kind,
                               one.version, options.check ? "upgrade" : "do"));
  if (session.json) {
    JsonWriter answer;
    answer.open_object().member("ok", all_known).key("files").open_array();
    for (const Judged& one : files) {
      answer.open_object(true).member("file", one.path).member("kind", one.kind).key("version");
      one.version > 0 ? answer.value(one.version) : answer.null();
      answer.member("changed", false).close();
    }
    answer.close().key("diagnostics").json(format_as_json(diagnostics)).close();
    print(std::move(answer).finish());
  }
  return all_known ? ExitCode::ok : ExitCode::problems;
}

} // namespace dermis::tools
