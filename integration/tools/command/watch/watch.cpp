// dermis watch: renders again whenever an input file changes, and reports changes of the plan and
// of the error.
#include "framegraph/explain/plan_diff.hpp"
#include "integration/abi/shaders/compiler.hpp"
#include "integration/examples/demo_engine/scene/read_scene.hpp"
#include "integration/tools/command/child.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/plan/input.hpp"
#include "integration/tools/command/watch/changes.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <filesystem>
#include <thread>

namespace dermis::tools {
namespace {

constexpr auto poll_interval = std::chrono::milliseconds(200);
constexpr auto settling = std::chrono::milliseconds(50); // editors write a file in several steps

struct Figures { // of one rendering; negative: not measured
  double device_ms = -1, psnr_db = -1, rmse = -1;
};

struct Watch {
  const Session& session;
  const WatchOptions& options;
  std::string program;              // path of this program; a build replaces the file
  std::vector<std::string> files{}; // inputs of a rendering
  Changes changes{};
  std::optional<SavedPlan> plan{};
  std::optional<Figures> figures{};
};

// "a.json, b.json and 2 more"
std::string list_files(const std::vector<std::string>& files) {
  constexpr size_t maximum = 3;
  std::string text;
  for (size_t i = 0; i < std::min(files.size(), maximum); ++i)
    text += (i == 0 ? "" : ", ") + files[i];
  return files.size() > maximum ? fmt::format("{} and {} more", text, files.size() - maximum)
                                : text;
}

// Updates the list of watched files: graph, overlays, included files, scene and profiles, as far as
// they can be read. Returns the plan, or reports errors.
std::optional<SavedPlan> reload_inputs(Watch& watch) {
  const WatchOptions& options = watch.options;
  std::vector<std::string> files = {options.scene, options.graph};
  for (const auto* named : {&options.inputs.overlays, &options.inputs.pass_types})
    files.insert(files.end(), named->begin(), named->end());
  Diagnostics scene_errors; // ignored, since `dermis render` reports them
  if (const auto scene = demo::read_scene(options.scene, scene_errors, options.inputs.roots))
    for (const demo::SceneProfile& profile : scene->profiles)
      files.push_back(profile.file);
  Diagnostics diagnostics;
  std::string problem;
  auto plan = load_plan({options.graph, options.inputs, options.size, options.settings, {}, false},
                        diagnostics, problem);
  for (const SourceFile& file : diagnostics.files)
    if (std::filesystem::exists(file.name)) files.push_back(file.name);
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  watch.files = std::move(files);
  print_diagnostics(watch.session, diagnostics);
  if (!problem.empty()) spdlog::error("{}", problem);
  return plan && plan->from_graph ? std::optional(std::move(plan->saved)) : std::nullopt;
}

std::vector<std::string> shader_files(const Watch& watch) {
  return files_below(watch.options.shaders, {".glsl", ".comp"});
}

// Returns whether `dermis render` compiles the shader files itself (--shaders): there is a shader
// compiler, and no build command that would compile them.
bool compiles_shaders(const Watch& watch) {
  return watch.options.build.empty() && !abi::shader_compiler().empty() &&
         !shader_files(watch).empty();
}

std::vector<std::string> render_line(const Watch& watch) {
  const WatchOptions& o = watch.options;
  std::vector<std::string> line = {watch.program,
                                   "render",
                                   o.scene,
                                   "--graph",
                                   o.graph,
                                   "--out",
                                   o.out,
                                   "--size",
                                   fmt::format("{}x{}", o.size.width, o.size.height),
                                   "--frames",
                                   fmt::format("{}", o.frames),
                                   "--subset",
                                   fmt::format("{}", o.subset),
                                   "--json"};
  const auto add = [&](const char* option, const std::vector<std::string>& values) {
    for (const std::string& value : values)
      line.insert(line.end(), {option, value});
  };
  add("--overlay", o.inputs.overlays);
  if (compiles_shaders(watch)) add("--shaders", {o.shaders});
  add("--root", o.inputs.roots);
  add("--pass-types", o.inputs.pass_types);
  for (const auto& [name, value] : o.settings)
    line.insert(line.end(), {"--set", name + "=" + value});
  return line;
}

double number_at(const Document& document, NodeId object, const char* key) {
  const NodeId at = object.valid() ? document.find(object, key) : NodeId{};
  if (!at.valid()) return -1;
  const NodeKind kind = document[at].kind;
  return kind == NodeKind::integer || kind == NodeKind::real ? document[at].real : -1;
}

// Returns nullopt after reporting the problem if the answer holds an error.
std::optional<Figures> figures_of(const std::string& answer) {
  Diagnostics ignored;
  const auto document = parse_document("answer", answer, ignored);
  if (!document) {
    spdlog::error("the rendering ended without output");
    return std::nullopt;
  }
  const NodeId problem = document->find(document->root(), "error");
  if (problem.valid() && (*document)[problem].kind == NodeKind::string) {
    spdlog::error("{}", document->text(problem));
    return std::nullopt;
  }
  const bool measured = problem.valid() && (*document)[problem].kind == NodeKind::object;
  return Figures{number_at(*document, document->root(), "device_ms"),
                 measured ? number_at(*document, problem, "psnr_db") : -1,
                 measured ? number_at(*document, problem, "rmse") : -1};
}

std::string change(double now, double before, int digits) {
  return before < 0 ? "" : fmt::format(" ({:+.{}f})", now - before, digits);
}

std::string figures_text(const Figures& now, const Figures& before) {
  std::string text;
  if (now.psnr_db >= 0)
    text += fmt::format("PSNR {}{}, RMSE {:.6f}{}, ", format_decibels(now.psnr_db),
                        change(now.psnr_db, before.psnr_db, 2), now.rmse,
                        change(now.rmse, before.rmse, 6));
  return text + fmt::format("{}{}\n", format_milliseconds(now.device_ms),
                            change(now.device_ms, before.device_ms, 2));
}

// Renders once. Returns false on failure; watching then continues, since the next change may
// correct the file.
bool render_once(Watch& watch) {
  const std::optional<SavedPlan> plan = reload_inputs(watch);
  watch.changes.add(watch.files); // later changes trigger the next rendering
  if (!plan) return false;
  if (watch.plan) {
    const PlanDiff diff = diff_plans(*watch.plan, *plan);
    say(watch.session, diff.same ? "plan: unchanged\n" : plan_diff_text(diff, "before", "now"));
  } else {
    say(watch.session, fmt::format("plan: {} passes, {} barriers\n", plan->plan.passes.size(),
                                   plan->plan.barriers.size()));
  }
  watch.plan = plan;
  std::string problem;
  const auto answer = run_child(render_line(watch), problem);
  if (interrupted()) return false;
  if (!answer) {
    spdlog::error("{}", problem);
    return false;
  }
  const auto figures = figures_of(answer->out);
  if (!figures) return false;
  say(watch.session, figures_text(*figures, watch.figures.value_or(Figures{})));
  watch.figures = figures;
  return true;
}

void take_shaders(const Watch& watch, const std::vector<std::string>& shaders) {
  if (compiles_shaders(watch)) {
    say(watch.session, fmt::format("\n{} changed\n", list_files(shaders)));
    return;
  }
  if (watch.options.build.empty()) {
    spdlog::warn(
        "{} changed: this program was built without a shader compiler; use --build LINE to rebuild "
        "it",
        list_files(shaders));
    return;
  }
  say(watch.session, fmt::format("{} changed: {}\n", list_files(shaders), watch.options.build));
  std::string problem;
  const auto answer = run_child({"/bin/sh", "-c", watch.options.build}, problem);
  if (!answer || answer->exit_code != 0) {
    if (answer) print(answer->out);
    spdlog::error("{}", answer
                            ? fmt::format("the build failed with exit code {}", answer->exit_code)
                            : problem);
  }
}

} // namespace

ExitCode watch(const Session& session, const WatchOptions& options) {
  if (options.graph == "-")
    return fail(session, ExitCode::usage,
                "--graph -: standard input does not change; name a graph file to watch");
  std::error_code error;
  Watch state{session, options, std::filesystem::read_symlink("/proc/self/exe", error).string()};
  if (error)
    return fail(session, ExitCode::environment,
                "cannot find this program's own file: " + error.message());
  state.files = {options.scene, options.graph};
  state.files.insert(state.files.end(), options.inputs.overlays.begin(),
                     options.inputs.overlays.end());
  state.changes.add(state.files);
  Changes shaders;
  shaders.add(shader_files(state));
  uint32_t rounds = 0;
  bool rendered = render_once(state);
  while (!interrupted() && (options.rounds == 0 || ++rounds < options.rounds)) {
    std::vector<std::string> changed, of_shaders;
    while (!interrupted() && changed.empty() && of_shaders.empty()) {
      std::this_thread::sleep_for(poll_interval);
      changed = state.changes.look(state.files);
      of_shaders = shaders.look(shader_files(state));
    }
    if (interrupted()) break;
    std::this_thread::sleep_for(settling);
    state.changes.look(state.files);
    if (!of_shaders.empty()) take_shaders(state, of_shaders);
    if (!changed.empty()) say(session, fmt::format("\n{} changed\n", list_files(changed)));
    rendered = render_once(state);
  }
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  return rendered ? ExitCode::ok : ExitCode::problems; // result of the last round
}

} // namespace dermis::tools
