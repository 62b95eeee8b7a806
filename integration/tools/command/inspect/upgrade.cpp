// dermis upgrade: converts files to the newest version of their format, in place.

#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/reader.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/inspect/upgrade_text.hpp"
#include "integration/tools/command/output.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

struct Upgraded {
  std::string path;
  std::string_view kind = "unreadable";
  int64_t version = 0;   // version after the call; 0: unknown
  std::string text = {}; // in that version
  bool changed = false;
};

constexpr std::string_view old_pass_type_key = "dermis_kinds"; // pass type files of version 1

int64_t version_of(const Document& document, std::string_view key) {
  const NodeId node = document.find(document.root(), key);
  return node.valid() && document[node].kind == NodeKind::integer ? document[node].integer : 0;
}

Upgraded upgrade_file(const std::string& path, Diagnostics& diagnostics) {
  const std::optional<Document> document = read_input(path, diagnostics);
  if (!document) return {path};
  const std::string& text = diagnostics.files[document->file.value].text;
  const std::optional<FileKindId> id = file_kind_of(*document, diagnostics);
  if (!id) return {path};
  const FileKind& kind = file_kinds()[static_cast<size_t>(*id)];
  const bool old =
      version_of(*document, kind.version_key) == 1 || version_of(*document, old_pass_type_key) == 1;
  if (kind.version > 1 && old)
    if (std::optional<std::string> upgraded = upgraded_text(*document, *id, text))
      return {path, kind.name, kind.version, std::move(*upgraded), true};
  const bool known = check_version(*document, kind.version_key, kind.version, diagnostics);
  return {path, kind.name, known ? kind.version : 0, text};
}

// Returns whether the new text is JSON, as which the old one was read.
bool is_readable(const Upgraded& one) {
  Diagnostics ignored;
  return !one.changed || parse_document(one.path, one.text, ignored);
}

std::string answer(const Upgraded& one, bool check) {
  if (!one.changed)
    return fmt::format("{}: {}, version {} is the newest: nothing to {}\n", one.path, one.kind,
                       one.version, check ? "upgrade" : "do");
  return fmt::format("{}: {}, {} version {}\n", one.path, one.kind,
                     check ? "can be upgraded to" : "upgraded to", one.version);
}

} // namespace

ExitCode upgrade(const Session& session, const UpgradeOptions& options) {
  const bool prints =
      !options.check && std::ranges::find(options.files, "-") != options.files.end();
  if (prints && session.json)
    return fail(session, ExitCode::usage,
                "--json and '-' both need standard output; give the graph as a file, or --check");
  Diagnostics diagnostics;
  std::vector<Upgraded> files;
  for (const std::string& path : options.files)
    files.push_back(upgrade_file(path, diagnostics));
  for (const Upgraded& one : files)
    if (!is_readable(one))
      return fail(session, ExitCode::internal,
                  fmt::format("{}: the upgraded text would not be JSON; no file was changed. This "
                              "is a defect of the program, please report it",
                              one.path));
  bool good = true;
  std::string unwritten;
  for (const Upgraded& one : files) {
    good = good && one.version > 0 && !(options.check && one.changed);
    const bool delivers = one.changed || (one.path == "-" && one.version > 0);
    if (options.check || !delivers || !unwritten.empty()) continue;
    if (const std::string problem = deliver_text(one.path, one.text); !problem.empty())
      unwritten = problem;
  }
  print_diagnostics(session, diagnostics);
  if (!unwritten.empty()) return fail(session, ExitCode::environment, unwritten);
  for (const Upgraded& one : files)
    if (one.version > 0 && (one.path != "-" || options.check)) // "-": stdout holds the result
      say(session, answer(one, options.check));
  if (session.json) {
    JsonWriter out;
    out.open_object().member("ok", good).key("files").open_array();
    for (const Upgraded& one : files) {
      out.open_object(true).member("file", one.path).member("kind", one.kind).key("version");
      one.version > 0 ? out.value(one.version) : out.null();
      out.member("changed", one.changed).close();
    }
    out.close().key("diagnostics").json(format_as_json(diagnostics)).close();
    print(std::move(out).finish());
  }
  return good ? ExitCode::ok : ExitCode::problems;
}

} // namespace dermis::tools
