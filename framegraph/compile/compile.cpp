#include "framegraph/compile/compile.hpp"

#include "framegraph/compile/scratch.hpp"
#include "framegraph/model/frame_settings.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis {
namespace {

// Returns whether each list of the input is empty or has one entry per declaration, and the device
// supports the view.
bool acceptable(const CompileInput& input, Diagnostics& diagnostics) {
  const uint64_t errors = diagnostics.errors();
  const auto report_input = [&](std::string text) {
    diagnostics.add(DiagnosticId::compile_input, {}, std::move(text));
  };
  const auto check_length = [&](const char* what, size_t given, size_t expected) {
    if (given != 0 && given != expected)
      report_input(fmt::format("got {} {}, but the graph has {}", given, what, expected));
  };
  const uint32_t limit = input.device->max_image_dimension;
  if (input.view_width < 1 || input.view_height < 1 || input.view_width > limit ||
      input.view_height > limit)
    report_input(fmt::format("the view is {}x{}; each side must be within 1 .. {}",
                             input.view_width, input.view_height, limit));
  check_length("setting values", input.settings.size(), input.graph->settings.size());
  check_length("bound flags", input.bound.size(), input.graph->resources.size());
  check_length("host formats", input.host_formats.size(), input.graph->resources.size());
  return diagnostics.errors() == errors;
}

void clear(CompiledPlan& out) {
  Plan& plan = out.plan;
  plan.setting_values.clear();
  plan.resources.clear();
  plan.heaps.clear();
  plan.placements.clear();
  plan.passes.clear();
  plan.accesses.clear();
  plan.barriers.clear();
  plan.settings.clear();
  plan.histories.clear();
  plan.history_layouts.clear();
  plan.history_ranges.clear();
  plan.orderings.clear();
  plan.first_final_barrier = plan.final_barrier_count = 0;
  plan.final_wait = no_point;
  plan.transient_bytes = plan.history_bytes = 0;
  out.reasons.clear();
}

// Returns the settings whose values select passes or formats and differ from the defaults, for
// messages: ", with 'technique' = 'separable'".
std::string selection_text(const CompileInput& in, const std::vector<SettingValue>& values) {
  const Graph& graph = *in.graph;
  std::vector<uint8_t> in_conditions(graph.settings.size(), 0);
  for (const Expression& expression : graph.expressions)
    if (expression.op == Expression::Op::setting) in_conditions[expression.setting.value] = 1;
  std::string text;
  for (uint32_t i = 0; i < graph.settings.size(); ++i) {
    const SettingDeclaration& setting = graph.settings[i];
    const SettingValue &value = values[i], &usual = setting.default_value;
    if (value.integer == usual.integer && value.real == usual.real) continue;
    if (in_conditions[i] != 0 || setting.by_budget ||
        selects_formats(graph, *in.pass_types, SettingId{i}))
      text += fmt::format("{} '{}' = {}", text.empty() ? ", with" : ",", setting.name,
                          setting_text(setting, value));
  }
  return text;
}

// Compilation from top to bottom, after the conditions. Each phase returns a value that later
// phases read; it stays valid until the next compilation. Stops after a phase that reported errors.
bool plan_graph(const CompileInput& in, const Sizes& sizes, const Activation& active,
                Report& report, Plan& plan, CompileScratch& scratch) {
  // Divides images into the subresource ranges that ports name.
  const Subresources& subresources =
      split_subresources(in, sizes, active, report, scratch.subresources);
  if (report.failed()) return false;

  // Resolves which version of which resource each port accesses. No pass may read what it writes.
  const Versions& versions =
      resolve_versions(in, sizes, active, subresources, report, scratch.versions);
  if (report.failed()) return false;
  report_races(in, active, versions, report);
  if (report.failed()) return false;

  // Keeps the passes that a bound export needs. Only they need sizes and all required ports.
  const LiveSet& live = cull(in, sizes, active, versions, report, scratch.cull);
  report_size_errors(in, sizes, versions, live, report);
  report_bind_errors(in, sizes, active, subresources, versions, live, report, scratch.bind_errors);
  if (report.failed()) return false;

  // Assigns the passes to queues.
  const QueueAssignment& queues =
      assign_queues(in, sizes, subresources, versions, live, report, scratch.queues);

  // Gathers usages of each resource, and chooses its format and memory needs.
  const Usages& usages = gather_usages(in, sizes, active, versions, live, report, scratch.usages);
  const ResourceMemory& memory =
      resolve_formats(in, sizes, active, versions, usages, report, plan.resources, scratch.formats);
  if (report.failed()) return false;

  // Orders the passes, and lists them with their settings.
  const Schedule& schedule =
      schedule_passes(in, active, versions, live, memory, report, scratch.schedule);
  if (report.failed()) return false;
  plan_passes(in, active, queues, schedule, report, plan, scratch.passes);
  if (report.failed()) return false;

  // Locates each resource in memory; transients and idle histories alias.
  const Histories& histories = analyze_histories(in, active, versions, usages, schedule, report,
                                                 plan.resources, scratch.histories);
  const Placements& placements = place_resources(in, sizes, subresources, queues, memory, schedule,
                                                 histories, report, plan, scratch.placements);

  // Emits accesses, barriers and waits between queues.
  emit_barriers(in, active, subresources, versions, queues, memory, histories, placements, report,
                plan, scratch.barriers);

  plan.graph = in.graph->name;
  plan.view_width = in.view_width;
  plan.view_height = in.view_height;
  plan.pixel_grid = in.pixel_grid;
  plan.device_profile = in.device->name;
  plan.setting_values = active.settings;
  return true;
}

bool run_phases(const CompileInput& in, Report& report, Plan& plan, CompileScratch& scratch);

// Appends the text to the errors from index `first` of diagnostics.list on that do not occur with
// the default settings.
void append_selection(const CompileInput& in, const std::string& selection, size_t first,
                      Diagnostics& diagnostics, CompileScratch& scratch) {
  if (selection.empty() || in.settings.empty()) return;
  CompileInput usual = in;
  usual.settings.clear();
  Diagnostics of_defaults;
  CompiledPlan plan;
  Report report{of_defaults, plan.reasons, false};
  run_phases(usual, report, plan.plan, scratch);
  for (size_t i = first; i < diagnostics.list.size(); ++i) {
    Diagnostic& one = diagnostics.list[i];
    const auto same = [&](const Diagnostic& other) {
      return other.id == one.id && other.text == one.text;
    };
    if (diagnostic_info(one.id).severity == Severity::error &&
        std::none_of(of_defaults.list.begin(), of_defaults.list.end(), same))
      one.text += selection;
  }
}

bool run_phases(const CompileInput& in, Report& report, Plan& plan, CompileScratch& scratch) {
  // Computes the size of each resource, and which slots the host binds.
  const Sizes& sizes = resolve_sizes(in, report, scratch.sizes);
  if (report.failed()) return false;

  // Resolves settings, and which passes are on.
  const Activation& active = evaluate_conditions(in, report, scratch.activation);
  if (report.failed()) return false;

  // Errors that other settings avoid name the settings.
  const size_t reported = report.diagnostics.list.size();
  if (plan_graph(in, sizes, active, report, plan, scratch)) return true;
  append_selection(in, selection_text(in, active.settings), reported, report.diagnostics, scratch);
  return false;
}

} // namespace

void Report::add_reason(const Reason& reason) {
  reasons.push_back(reason);
}

Compiler::Compiler() : scratch_(std::make_unique<CompileScratch>()) {}
Compiler::~Compiler() = default;

bool Compiler::compile(const CompileInput& input, Diagnostics& diagnostics, CompiledPlan& out) {
  clear(out);
  if (!acceptable(input, diagnostics)) return false;
  Report report{diagnostics, out.reasons, input.reasons, diagnostics.errors()};
  if (run_phases(input, report, out.plan, *scratch_)) return true;
  clear(out);
  return false;
}

std::optional<CompiledPlan> compile(const CompileInput& input, Diagnostics& diagnostics) {
  CompiledPlan out;
  if (!Compiler().compile(input, diagnostics, out)) return std::nullopt;
  return out;
}

} // namespace dermis
