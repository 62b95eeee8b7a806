// dermis report-bug: writes a folder or archive with all files needed to reproduce a problem, and
// the command line that does.
#include "framegraph/explain/plan_json.hpp"
#include "framegraph/serialize/plan_file.hpp"
#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/limits.hpp"
#include "integration/tools/command/capture/capture_scene.hpp"
#include "integration/tools/command/child.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/inspect/survey.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/run/captured.hpp"
#include "integration/tools/files/bytes.hpp"
#include "integration/tools/files/capture.hpp"

#include <dermis/dermis.h>
#include <fmt/format.h>

#include <filesystem>
#include <map>

namespace dermis::tools {
namespace {

namespace fs = std::filesystem;

// A folder under construction. `finish` renames it or packs it into an archive; the destructor
// removes the rest.
struct BugReport {
  fs::path target, part;
  std::string archived{}; // the folder's name in the archive; "" for no archive
  std::string problem{};

  ~BugReport() {
    std::error_code ignored;
    fs::remove_all(part, ignored);
  }
  fs::path folder() const { return part / archived; }
  bool add(const fs::path& name, std::string_view text) {
    std::error_code error;
    fs::create_directories((folder() / name).parent_path(), error);
    return problem.empty() && write_text(folder() / name, text, problem);
  }
  bool finish() {
    std::error_code error;
    fs::path made = part;
    if (!archived.empty()) {
      made = part / "archive";
      const auto tar =
          run_child({"tar", "--create", "--gzip", "--file", made.string(), "--directory",
                     part.string(), "--owner=0", "--group=0", "--sort=name", "--", archived},
                    problem);
      if (tar && tar->exit_code != 0) problem = fmt::format("'tar' ended with {}", tar->exit_code);
      if (!problem.empty()) return false;
    }
    fs::rename(made, target, error);
    if (error) problem = fmt::format("cannot make '{}': {}", target.string(), error.message());
    return !error;
  }
};

// Returns the name of the folder in the archive, or "" if `target` is a folder.
std::string folder_in(const fs::path& target) {
  const std::string name = target.filename().string();
  for (const std::string_view ending : {".tar.gz", ".tgz"})
    if (name.size() > ending.size() && name.ends_with(ending))
      return name.substr(0, name.size() - ending.size());
  return "";
}

// Quotes a word for a shell.
std::string word(const std::string& text) {
  if (text.find_first_not_of(
          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=,") ==
      std::string::npos)
    return text;
  std::string quoted = "'";
  for (const char c : text)
    quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

struct GraphFiles {
  std::string graph;                             // file name in the parcel
  std::vector<std::string> overlays, pass_types; // file names in the parcel, in order
  std::map<std::string, std::string> included;   // text by name
};

// Adds graph, overlays, pass types and included files. File names are chosen so that references
// resolve.
bool add_graph(BugReport& bug_report, const ReportBugOptions& options,
               const Diagnostics& diagnostics, GraphFiles& files) {
  // in a folder of its own: its name may be that of another file of the report
  files.graph = "graph/" +
                (options.graph == "-" ? "graph.json" : fs::path(options.graph).filename().string());
  bool good = bug_report.add(files.graph, diagnostics.files.front().text);
  const auto add_all = [&](const char* folder, const std::vector<std::string>& paths,
                           std::vector<std::string>& names) {
    for (size_t i = 0; i < paths.size() && good; ++i) {
      const auto bytes = read_bytes(paths[i], limits::file_bytes, bug_report.problem);
      names.push_back(fmt::format("{}/{}_{}", folder, i, fs::path(paths[i]).filename().string()));
      good = bytes && bug_report.add(names.back(),
                                     {reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    }
  };
  add_all("overlays", options.inputs.overlays, files.overlays);
  add_all("pass_types", options.inputs.pass_types, files.pass_types);
  for (const auto& [name, text] : files.included)
    good = good && bug_report.add("graph/" + name, text);
  return good;
}

std::string settings_json(const LoadedGraph& loaded, const CompileChoices& choices,
                          const SavedPlan& saved) {
  JsonWriter out;
  out.open_object();
  for (size_t i = 0; i < loaded.graph.settings.size() && i < choices.settings.size(); ++i)
    out.key(saved.names.settings[i].name).json(saved.names.settings[i].text);
  out.close();
  return std::move(out).finish();
}

std::string device_json() {
  const auto survey = demo::survey_devices();
  if (survey) return survey_as_json(*survey);
  JsonWriter out;
  out.open_object().member("ok", false).member("error", survey.error().text).close();
  return std::move(out).finish();
}

demo::Result<CapturedFrame> read_last_frame(const Session& session,
                                            const ReportBugOptions& options) {
  Diagnostics diagnostics;
  const std::vector<fs::path> frames =
      find_frames(options.frames, diagnostics, options.inputs.roots);
  auto frame = frames.empty() ? std::nullopt
                              : read_frame(frames.back(), profiles_folder(""), diagnostics,
                                           options.inputs.roots);
  if (frame) return std::move(*frame);
  print_diagnostics(session, diagnostics);
  demo::Error error{demo::ErrorKind::input,
                    fmt::format("the capture '{}' cannot be used", options.frames)};
  error.diagnostics = format_as_json(diagnostics);
  return error;
}

// Adds the frame, or a frame of the scene if there is none.
demo::Result<> add_frame(const Session& session, const ReportBugOptions& options,
                         const std::optional<CapturedFrame>& frame, BugReport& bug_report) {
  const std::string folder = (bug_report.folder() / "capture").string();
  if (!frame) {
    Session quiet = session;
    quiet.quiet = true; // no progress for one frame
    CaptureOptions one;
    one.scene = options.scene;
    one.out = folder;
    one.size = options.size;
    one.frames = 1;
    one.first = options.count - 1;
    one.roots = options.inputs.roots;
    return capture_scene(quiet, one);
  }
  CaptureWriter writer;
  std::string problem;
  if (writer.begin(folder, problem) && writer.add(*frame, problem) && writer.finish(problem))
    return demo::success();
  return demo::Error{demo::ErrorKind::environment, problem};
}

std::string replay_line(const ReportBugOptions& options, const GraphFiles& files) {
  std::string line =
      fmt::format("dermis apply --graph {} --frames capture --out replay", word(files.graph));
  for (const std::string& overlay : files.overlays)
    line += " --overlay " + word(overlay);
  for (const std::string& pass_types : files.pass_types)
    line += " --pass-types " + word(pass_types);
  for (const auto& [name, value] : options.settings)
    line += " --set " + word(name + "=" + value);
  return line;
}

std::string about(const Session& session, const std::string& replay) {
  return fmt::format(
      "Made by dermis {}.{}.{}: {}\n\nTo reproduce the problem, run in this folder:\n\n  "
      "{}\n\nsettings.json  values that the plan was compiled with\nplan.json      the plan "
      "with its reasons (dermis explain --json), for the generic device\ngraph.plan     the "
      "plan for dermis plan verify and dermis plan diff\ndevice.json    properties of the "
      "machine (dermis doctor --json)\ncapture/       inputs of one frame\n",
      DERMIS_VERSION_MAJOR, DERMIS_VERSION_MINOR, DERMIS_VERSION_PATCH, session.command, replay);
}

} // namespace

ExitCode report_bug(const Session& session, const ReportBugOptions& options) {
  std::error_code error;
  const fs::path target = fs::absolute(options.out, error).lexically_normal();
  const fs::path named = target.has_filename() ? target : target.parent_path();
  const std::string archived = folder_in(named);
  for (const std::string_view ending :
       {".zip", ".tar", ".gz", ".bz2", ".xz", ".zst", ".7z", ".rar"})
    if (archived.empty() && named.extension() == ending)
      return fail(
          session, ExitCode::usage,
          fmt::format("'{}': archives are written as .tar.gz or .tgz; any other name is that of a "
                      "folder",
                      options.out));
  if (fs::exists(named, error) && (!archived.empty() || !fs::is_empty(named, error)))
    return fail(session, ExitCode::environment,
                fmt::format("'{}' exists{}: choose another name", options.out,
                            archived.empty() ? " and is not empty" : ""));

  Diagnostics diagnostics;
  GraphFiles files;
  std::optional<Document> document = read_graph_file(options.graph, diagnostics);
  auto overlays = read_overlays(options.inputs.overlays, diagnostics);
  const OpenFile recorded =
      [&, open = open_included(options.graph, options.inputs.roots)](std::string_view name) {
        FileText file = open(name);
        if (file.problem.empty()) files.included[std::string(name)] = file.text;
        return file;
      };
  const auto loaded = document && overlays
                          ? load_graph(std::move(*document), std::move(*overlays), recorded,
                                       diagnostics, options.inputs.pass_types)
                          : std::nullopt;
  if (!loaded) return fail_graph(session, options.graph, diagnostics);
  const CompileChoices choices = read_choices(loaded->graph, options.settings);
  if (!choices.problem.empty()) return fail(session, ExitCode::usage, choices.problem);
  std::optional<CapturedFrame> frame;
  Size size = options.size;
  if (!options.frames.empty()) {
    auto last = read_last_frame(session, options);
    if (!last) return fail(session, last.error());
    frame = std::move(*last);
    size = {frame->description.width, frame->description.height};
  }
  const auto compiled = compile_generic(*loaded, size, choices, diagnostics);
  if (!compiled) return fail_graph(session, options.graph, diagnostics);
  const DeviceProfile generic = generic_profile();
  const SavedPlan saved =
      saved_plan(compile_input(*loaded, generic, size, choices), compiled->plan);

  BugReport bug_report{named, temporary_path(named), archived};
  bool good = add_graph(bug_report, options, diagnostics, files) &&
              bug_report.add("settings.json", settings_json(*loaded, choices, saved)) &&
              bug_report.add("plan.json", plan_json(loaded->graph, loaded->pass_types, *compiled,
                                                    {loaded->changes, diagnostics.files})) &&
              bug_report.add("graph.plan", write_plan(saved)) &&
              bug_report.add("device.json", device_json()) &&
              bug_report.add("README.txt", about(session, replay_line(options, files)));
  if (!good) return fail(session, ExitCode::environment, bug_report.problem);
  const auto captured = add_frame(session, options, frame, bug_report);
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!captured) return fail(session, captured.error());
  if (archived.empty()) fs::remove(named, error); // the target may be an empty folder
  if (!bug_report.finish()) return fail(session, ExitCode::environment, bug_report.problem);
  say(session,
      fmt::format("{}: attach this file to your report; its README.txt has the command that "
                  "reproduces the problem:\n  {}\n",
                  options.out, replay_line(options, files)));
  if (session.json) {
    JsonWriter answer;
    answer.open_object()
        .member("ok", true)
        .member("out", options.out)
        .member("replay", replay_line(options, files))
        .close();
    print(std::move(answer).finish());
  }
  return ExitCode::ok;
}

} // namespace dermis::tools
