// dermis validate: reads files as strictly as everything else does, compiles graphs with the generic device
// and lets the verifier check their plans.

#include "framegraph/text/document.hpp"
#include "framegraph/text/json_writer.hpp"
#include "framegraph/verify/verify.hpp"
#include "integration/command/expect/expectation.hpp"
#include "integration/command/graph_input.hpp"
#include "integration/demo_engine/scene/read_scene.hpp"
#include "passes/subsurface/profile.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

struct FileKind {
  std::string_view version_key, name;
  bool (*check)(const Document& document, Diagnostics& diagnostics);
};

bool check_graph(const Document& document, Diagnostics& diagnostics) {
  const std::optional<LoadedGraph> loaded = load_graph(document, diagnostics);
  if (!loaded) return false;
  const CompileChoices choices = read_choices(loaded->graph);
  const std::optional<CompiledPlan> compiled = compile_generic(*loaded, default_size, choices, diagnostics);
  if (!compiled) return false;
  const std::vector<std::string> objections = verify(compiled->plan);
  for (const std::string& objection : objections)
    diagnostics.add(DiagnosticId::internal_defect, document.where(document.root()),
                    fmt::format("the verifier refuses the plan: {}", objection));
  return objections.empty();
}

bool check_profile(const Document& document, Diagnostics& diagnostics) {
  return subsurface::read_profile(document, diagnostics).has_value();
}

bool check_scene(const Document& document, Diagnostics& diagnostics) {
  const SourceFile file = diagnostics.files[document.file.value];
  return demo::parse_scene(file.name, file.text, diagnostics).has_value();
}

bool check_expectations(const Document& document, Diagnostics& diagnostics) {
  return read_expectations(document, diagnostics).has_value();
}

constexpr FileKind file_kinds[] = {
    {"dermis", "graph", check_graph},
    {"dermis_profile", "profile", check_profile},
    {"dermis_scene", "scene", check_scene},
    {"dermis_expect", "expectations", check_expectations},
};

// Told apart by the version key that each format has at its root; a file with none is read as a graph, whose
// reader says what is missing.
const FileKind& kind_of(const Document& document) {
  for (const FileKind& kind : file_kinds)
    if (document[document.root()].kind == NodeKind::object &&
        document.find(document.root(), kind.version_key).valid())
      return kind;
  return file_kinds[0];
}

struct CheckedFile {
  std::string path;
  std::string_view kind = "unreadable";
  bool good = false;
};

CheckedFile check_file(const std::string& path, Diagnostics& diagnostics) {
  const std::optional<Document> document = read_input(path, diagnostics);
  if (!document) return {path};
  const FileKind& kind = kind_of(*document);
  return {path, kind.name, kind.check(*document, diagnostics)};
}

} // namespace

ExitCode validate(const Session& session, const ValidateOptions& options) {
  Diagnostics diagnostics;
  std::vector<CheckedFile> files;
  for (const std::string& path : options.files)
    files.push_back(check_file(path, diagnostics));
  const bool all_good =
      std::all_of(files.begin(), files.end(), [](const CheckedFile& one) { return one.good; });
  print_diagnostics(session, diagnostics);
  for (const CheckedFile& one : files)
    if (one.good) say(session, fmt::format("{}: {}, no problems\n", one.path, one.kind));
  if (session.json) {
    JsonWriter answer;
    answer.open_object().member("ok", all_good).key("files").open_array();
    for (const CheckedFile& one : files)
      answer.open_object(true)
          .member("file", one.path)
          .member("kind", one.kind)
          .member("ok", one.good)
          .close();
    answer.close().key("diagnostics").json(format_as_json(diagnostics)).close();
    print(std::move(answer).finish());
  }
  return all_good ? ExitCode::ok : ExitCode::problems;
}

} // namespace dermis::tools
