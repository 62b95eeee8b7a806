// dermis explain: prints the plan with a reason for each decision, or the meaning of a message's
// code.

#include "framegraph/explain/plan_json.hpp"
#include "framegraph/explain/plan_text.hpp"
#include "framegraph/text/json_writer.hpp"
#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/inspect/diagnostics_page.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/run/budget_input.hpp"
#include "integration/tools/command/run/choice_report.hpp"
#include "integration/tools/command/run/choice_table.hpp"
#include "integration/tools/command/run/host_passes.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

// Normalises "d0103" and "103" to "D0103"; returns "" if the text is not a code.
std::string code_in(std::string_view text) {
  constexpr size_t digits = 4; // also in the format below
  if (text.starts_with('D') || text.starts_with('d')) text.remove_prefix(1);
  if (text.empty() || text.size() > digits ||
      text.find_first_not_of("0123456789") != std::string_view::npos)
    return "";
  return fmt::format("D{:0>4}", text);
}

const DiagnosticInfo* find_code(std::string_view code) {
  const auto all = all_diagnostic_infos();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const DiagnosticInfo& one) { return one.code == code; });
  return found == all.end() ? nullptr : &*found;
}

std::string_view severity_word(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

std::string describe_code(const DiagnosticInfo& info, bool json) {
  if (json) {
    JsonWriter answer;
    answer.open_object().member("id", info.code).member("name", info.name);
    answer.member("severity", severity_word(info.severity)).member("hint", info.hint);
    answer.member("text", diagnostic_paragraph(info.code)).close();
    return std::move(answer).finish();
  }
  return fmt::format("{} {} ({})\n{}\n\n{}\n", info.code, info.name, severity_word(info.severity),
                     diagnostic_paragraph(info.code), info.hint);
}

ExitCode deliver(const Session& session, const std::string& path, std::string_view text) {
  const bool for_people = path == "-" && !session.json;
  const std::string problem = deliver_text(path, for_people ? for_terminal(text) : text);
  return problem.empty() ? ExitCode::ok : fail(session, ExitCode::environment, problem);
}

// Renders some frames of a scene, so that times and counts are known, and explains the newest.
ExitCode explain_frame(const Session& session, const ExplainOptions& options,
                       const LoadedGraph& loaded) {
  constexpr uint32_t frames = 6;
  demo::RenderOptions engine;
  engine.scene = options.scene;
  engine.roots = options.inputs.roots;
  engine.graph = options.graph;
  engine.graph_text = loaded.text;
  engine.width = options.size.width;
  engine.height = options.size.height;
  engine.pixel_aspect = options.pixel_aspect;
  engine.frames = frames;
  engine.settings = settings_as_json(loaded.graph, options.settings);
  engine.unbound = options.unbound;
  auto budget = read_budget(options.budget);
  if (!budget) return fail(session, budget.error());
  engine.budget = budget.take();
  engine.overlays = loaded.overlays;
  engine.include = for_engine(open_included(options.graph, options.inputs.roots));
  HostPasses host_passes(loaded.host_pass_types);
  engine.hooks = host_passes.hooks();
  ChoiceReport report;
  PixelGrid grid = 0;
  demo::RenderCallbacks callbacks;
  callbacks.on_start = [&](const demo::RenderInfo& info) -> demo::Result<> {
    grid = pixel_grid(info.pixel_aspect);
    return demo::success();
  };
  callbacks.on_frame = [&](const demo::FrameOutputs& frame) -> demo::Result<> {
    if (frame.choice && frame.frame + 1 == frames)
      report.add(frame.frame, *frame.choice, frame.histories,
                 tile_costs(loaded, options.size, grid, options.settings, *frame.choice),
                 frame.frontier);
    return interrupted() ? demo::Result<>(stopped()) : demo::success();
  };
  const auto summary = demo::render(engine, callbacks);
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!summary) return fail(session, summary.error());
  if (!session.json) return deliver(session, options.out, report.text());
  JsonWriter answer;
  report.write(answer);
  return deliver(session, options.out, std::move(answer).finish());
}

// Returns for each setting of the graph whether --set gives its value.
std::vector<bool> pinned_by(const Graph& graph, const std::vector<NamedValue>& settings) {
  std::vector<bool> pinned;
  for (const SettingDeclaration& setting : graph.settings)
    pinned.push_back(std::any_of(settings.begin(), settings.end(),
                                 [&](const NamedValue& one) { return one.first == setting.name; }));
  return pinned;
}

void add_all(const Diagnostics& from, Diagnostics& diagnostics) {
  for (const Diagnostic& one : from.list)
    diagnostics.add(one.id, one.where, one.text);
}

ExitCode list_choices(const Session& session, const ExplainOptions& options,
                      const ChoiceTables& tables, Diagnostics& diagnostics) {
  add_all(tables.missing, diagnostics);
  print_beside_document(session, diagnostics);
  if (!session.json) return deliver(session, options.out, describe_tables(tables));
  JsonWriter answer;
  write_tables(answer, tables);
  return deliver(session, options.out, std::move(answer).finish());
}

// Names the table that is wrong, which is not part of the graph.
ExitCode fail_choice(const Session& session, const ExplainOptions& options,
                     const Diagnostics& diagnostics) {
  const auto of_table = [&](const Diagnostic& one) {
    if (!one.where.file.valid()) return false;
    const std::string& name = diagnostics.files[one.where.file.value].name;
    return name == options.budget.errors || name == options.budget.calibration;
  };
  const auto wrong = std::find_if(diagnostics.list.begin(), diagnostics.list.end(), of_table);
  if (wrong == diagnostics.list.end()) return fail_graph(session, options.graph, diagnostics);
  return fail(session, ExitCode::problems,
              fmt::format("{}: the choice cannot use this file",
                          diagnostics.files[wrong->where.file.value].name),
              &diagnostics);
}

} // namespace

ExitCode explain(const Session& session, const ExplainOptions& options) {
  if (const std::string code = code_in(options.graph); !code.empty()) {
    const DiagnosticInfo* info = find_code(code);
    return info != nullptr
               ? deliver(session, options.out, describe_code(*info, session.json))
               : fail(session, ExitCode::usage,
                      fmt::format("there is no message {}; docs/diagnostics.md lists all", code));
  }

  Diagnostics diagnostics;
  const std::optional<LoadedGraph> loaded = load_graph(options.graph, options.inputs, diagnostics);
  if (!loaded) return fail_graph(session, options.graph, diagnostics);
  CompileChoices choices = read_choices(loaded->graph, options.settings, options.unbound);
  choices.two_queues = options.two_queues;
  if (options.pixel_aspect > 0) choices.pixel_grid = pixel_grid(options.pixel_aspect);
  if (!choices.problem.empty()) return fail(session, ExitCode::usage, choices.problem);
  if (std::string unused = unused_budget(options.budget, *loaded, options.graph); !unused.empty())
    return fail(session, ExitCode::usage, unused);
  if (options.frame) return explain_frame(session, options, *loaded);
  const auto budget = read_budget(options.budget);
  if (!budget) return fail(session, budget.error());
  const auto tables =
      choice_tables(*loaded, options.size, choices, pinned_by(loaded->graph, options.settings),
                    *budget, diagnostics);
  if (!tables) return fail_choice(session, options, diagnostics);
  if (options.choices) return list_choices(session, options, *tables, diagnostics);
  const std::optional<CompiledPlan> compiled =
      compile_generic(*loaded, options.size, choices, diagnostics);
  if (!compiled) return fail_graph(session, options.graph, diagnostics);
  add_all(tables->missing, diagnostics);
  print_beside_document(session, diagnostics);
  return deliver(session, options.out,
                 session.json ? plan_json(loaded->graph, loaded->pass_types, *compiled,
                                          {loaded->changes, diagnostics.files})
                              : plan_text(loaded->graph, loaded->pass_types, *compiled,
                                          {loaded->changes, diagnostics.files}));
}

} // namespace dermis::tools
