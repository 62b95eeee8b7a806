// dermis validate: reads files strictly, compiles graphs with the generic device profile and
// verifies their plans and saved ones, and reads the images of captures.

#include "framegraph/text/document.hpp"
#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/reader.hpp"
#include "framegraph/verify/verify.hpp"
#include "integration/examples/demo_engine/scene/read_scene.hpp"
#include "integration/tools/command/expect/expectation.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/inspect/diagnose.hpp"
#include "integration/tools/command/inspect/file_kind.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/plan/input.hpp"
#include "integration/tools/command/plan/verify.hpp"
#include "integration/tools/command/run/captured.hpp"
#include "integration/tools/command/run/choice_sets.hpp"
#include "integration/tools/files/capture_pictures.hpp"
#include "passes/choice/calibration.hpp"
#include "passes/choice/error_model.hpp"
#include "passes/common/profiles/profile.hpp"

#include <dermis/dermis.h>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace dermis::tools {
namespace {

// Reports what the verifier finds in the plan of one configuration. Returns false if the verifier
// rejects the plan; clears `verified` if the plan is not verified.
bool check_plan_of(const CompiledPlan& compiled, const std::string& configuration,
                   const SourceLocation& where, Diagnostics& diagnostics, bool& verified) {
  const Verdict verdict = verify(compiled.plan);
  for (const std::string& violation : verdict.violations)
    diagnostics.add(DiagnosticId::internal_defect, where,
                    fmt::format("the verifier rejects the plan{}: {}", configuration, violation));
  if (!verdict.not_verified.empty()) {
    verified = false;
    diagnostics.add(
        DiagnosticId::plan_not_verified, where,
        fmt::format("the plan{} is not verified: {}", configuration, verdict.not_verified));
  }
  return verdict.violations.empty();
}

// Compiles all configurations that a budget can choose, which a graph needs to be created, and
// verifies their plans. The first plan, of the defaults, was verified before.
bool check_configurations(const LoadedGraph& loaded, const SourceLocation& where,
                          Diagnostics& diagnostics, bool& verified) {
  const auto& settings = loaded.graph.settings;
  if (std::none_of(settings.begin(), settings.end(), [](const auto& one) { return one.by_budget; }))
    return true;
  Diagnostics found = diagnostics; // of a good graph, repeated notes of configurations are dropped
  const auto configurations = choice_configurations(loaded, default_size, found);
  if (!configurations) {
    diagnostics = std::move(found);
    return false;
  }
  bool good = true;
  std::vector<uint8_t> checked(configurations->compiled.size(), 0);
  checked.front() = 1;
  for (const choice::Configuration& one : configurations->all)
    if (std::exchange(checked[one.plan], 1) == 0)
      good = check_plan_of(configurations->compiled[one.plan], fmt::format(" of '{}'", one.name),
                           where, diagnostics, verified) &&
             good;
  return good;
}

bool check_graph(const Document& document, const std::string& path, const GraphInputs& inputs,
                 Diagnostics& diagnostics, bool& verified) {
  auto overlays = read_overlays(inputs.overlays, diagnostics);
  if (!overlays) return false;
  const std::optional<LoadedGraph> loaded =
      load_graph(document, std::move(*overlays), open_included(path, inputs.roots), diagnostics,
                 inputs.pass_types);
  if (!loaded) return false;
  const CompileChoices choices = read_choices(loaded->graph);
  const std::optional<CompiledPlan> compiled =
      compile_generic(*loaded, default_size, choices, diagnostics);
  if (!compiled) return false;
  const SourceLocation where = document.where(document.root());
  verified = true;
  const bool good = check_plan_of(*compiled, "", where, diagnostics, verified);
  return check_configurations(*loaded, where, diagnostics, verified) && good;
}

bool check_profile(const Document& document, Diagnostics& diagnostics, std::string& about) {
  const std::optional<subsurface::Profile> profile =
      subsurface::read_profile(document, diagnostics);
  if (profile) about = subsurface::describe_profile(*profile);
  return profile.has_value();
}

bool check_scene(const Document& document, const std::vector<std::string>& roots,
                 Diagnostics& diagnostics) {
  const SourceFile file = diagnostics.files[document.file.value];
  const auto scene = demo::parse_scene(file.name, file.text, diagnostics, roots);
  if (!scene) return false;
  bool good = true;
  const NodeId list = document.find(document.root(), "profiles");
  for (size_t i = 0; i < scene->profiles.size(); ++i) {
    const size_t reported = diagnostics.list.size();
    const auto profile = read_document(scene->profiles[i].file, diagnostics);
    good = profile && subsurface::read_profile(*profile, diagnostics) && good;
    for (size_t k = reported; k < diagnostics.list.size(); ++k)
      diagnostics.list[k].related.emplace_back(
          document.where(children(document, list)[i]),
          fmt::format("profile '{}' of the scene", scene->profiles[i].name));
  }
  return good;
}

bool check_expectations(const Document& document, Diagnostics& diagnostics) {
  return read_expectations(document, diagnostics).has_value();
}

struct CheckedFile {
  std::string path;
  std::string_view kind = "unreadable";
  bool good = false;
  std::string about = {}; // one line on the contents of the file
  bool verified = true;   // of a plan; false: the verifier gave up
};

void check_capture(const Document& document, const ValidateOptions& options,
                   Diagnostics& diagnostics, CheckedFile& checked) {
  const std::filesystem::path folder = std::filesystem::path(checked.path).parent_path();
  const uint64_t errors = diagnostics.errors();
  const uint32_t warnings = diagnostics.count(Severity::warning);
  std::optional<CapturedFrame> frame = read_description(
      document, folder, profiles_folder(options.profiles), diagnostics, options.inputs.roots);
  if (frame) read_pictures(folder, document, *frame, diagnostics, options.inputs.roots);
  checked.good = diagnostics.errors() == errors;
  if (!checked.good || !options.diagnose) return;
  checked.about = diagnose_frame(*frame, document.where(document.root()), diagnostics);
  checked.good = diagnostics.count(Severity::warning) == warnings;
}

CheckedFile check_plan(const std::string& path, Diagnostics& diagnostics) {
  const VerifiedPlan plan = verify_plan_file(path, diagnostics);
  CheckedFile checked{path, "plan", plan.good};
  if (plan.read) checked.about = describe(plan);
  checked.verified = plan.verified;
  return checked;
}

CheckedFile check_file(const std::string& path, const ValidateOptions& options,
                       Diagnostics& diagnostics) {
  if (holds_plan(path)) return check_plan(path, diagnostics);
  const std::optional<Document> document = read_input(path, diagnostics);
  if (!document) return {path};
  const std::optional<FileKindId> kind = file_kind_of(*document, diagnostics);
  if (!kind) return {path, "unknown"};
  CheckedFile checked{path, file_kinds()[static_cast<size_t>(*kind)].name};
  switch (*kind) {
  case FileKindId::graph:
    checked.good = check_graph(*document, path, options.inputs, diagnostics, checked.verified);
    break;
  case FileKindId::profile:
    checked.good = check_profile(*document, diagnostics, checked.about);
    break;
  case FileKindId::scene:
    checked.good = check_scene(*document, options.inputs.roots, diagnostics);
    break;
  case FileKindId::expectations:
    checked.good = check_expectations(*document, diagnostics);
    break;
  case FileKindId::capture:
    check_capture(*document, options, diagnostics, checked);
    break;
  case FileKindId::overlay:
    checked.good = check_overlay(*document, diagnostics);
    break;
  case FileKindId::fragment:
    checked.good = load_fragment(*document, open_included(path, options.inputs.roots), diagnostics,
                                 options.inputs.pass_types)
                       .has_value();
    break;
  case FileKindId::errors:
    checked.good = choice::read_error_model(*document, diagnostics).has_value();
    break;
  case FileKindId::calibration:
    checked.good = choice::read_calibration(*document, diagnostics).has_value();
    break;
  case FileKindId::pass_types:
    checked.good = read_host_pass_types(*document, diagnostics).has_value();
    break;
  }
  return checked;
}

// A folder means the frames of the capture in it.
std::vector<CheckedFile> check_path(const std::string& path, const ValidateOptions& options,
                                    Diagnostics& diagnostics) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored))
    return {check_file(path, options, diagnostics)};
  std::vector<CheckedFile> checked;
  for (const std::filesystem::path& frame : find_frames(path, diagnostics, options.inputs.roots))
    checked.push_back(check_file((frame / "frame.json").string(), options, diagnostics));
  if (checked.empty()) checked.push_back({path});
  return checked;
}

} // namespace

ExitCode validate(const Session& session, const ValidateOptions& options) {
  if (session.json && options.sarif == "-")
    return fail(session, ExitCode::usage,
                "--json and --sarif - both write to standard output; name a file");
  Diagnostics diagnostics;
  std::vector<CheckedFile> files;
  for (const std::string& path : options.files)
    for (CheckedFile& one : check_path(path, options, diagnostics))
      files.push_back(std::move(one));
  if (!options.sarif.empty()) {
    const std::string version =
        fmt::format("{}.{}.{}", DERMIS_VERSION_MAJOR, DERMIS_VERSION_MINOR, DERMIS_VERSION_PATCH);
    const std::string problem = deliver_text(options.sarif, format_as_sarif(diagnostics, version));
    if (!problem.empty()) return fail(session, ExitCode::environment, problem, &diagnostics);
  }
  const std::string_view graph_kind = file_kinds()[static_cast<size_t>(FileKindId::graph)].name;
  const bool has_graph = std::any_of(
      files.begin(), files.end(), [&](const CheckedFile& one) { return one.kind == graph_kind; });
  if (!options.inputs.overlays.empty() && !has_graph && !diagnostics.has_errors())
    return fail(session, ExitCode::usage, "--overlay needs a graph among the files");
  const auto capture = file_kinds()[static_cast<size_t>(FileKindId::capture)].name;
  const bool has_capture = std::any_of(files.begin(), files.end(),
                                       [&](const CheckedFile& one) { return one.kind == capture; });
  if (options.diagnose && !has_capture && !diagnostics.has_errors())
    return fail(session, ExitCode::usage, "--diagnose needs captured frames among the files");
  const bool all_good =
      std::all_of(files.begin(), files.end(), [](const CheckedFile& one) { return one.good; });
  print_diagnostics(session, diagnostics);
  for (const CheckedFile& one : files)
    if (one.good && options.sarif != "-")
      say(session, fmt::format("{}: {}, {}\n{}", one.path, one.kind,
                               one.verified ? "no problems" : "plan not verified",
                               one.about.empty() ? "" : fmt::format("  {}\n", one.about)));
  if (session.json) {
    JsonWriter answer;
    answer.open_object().member("ok", all_good).key("files").open_array();
    for (const CheckedFile& one : files) {
      answer.open_object(true)
          .member("file", one.path)
          .member("kind", one.kind)
          .member("ok", one.good);
      if (!one.verified) answer.member("verified", false);
      if (!one.about.empty()) answer.member("about", one.about);
      answer.close();
    }
    answer.close().key("diagnostics").json(format_as_json(diagnostics)).close();
    print(std::move(answer).finish());
  }
  return all_good ? ExitCode::ok : ExitCode::problems;
}

} // namespace dermis::tools
