#include "framegraph/compile/compile.hpp"

#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

namespace dermis {
namespace {

// One entry for each thing asked about, or none at all; and a view that the device can hold.
bool acceptable(const CompileInput& input, Diagnostics& diagnostics) {
  const uint32_t errors = diagnostics.count(Severity::error);
  const auto refuse = [&](std::string text) {
    diagnostics.add(DiagnosticId::compile_input, {}, std::move(text));
  };
  const auto check_length = [&](const char* what, size_t given, size_t wanted) {
    if (given != 0 && given != wanted)
      refuse(fmt::format("{} {} given, the graph has {}", given, what, wanted));
  };
  const uint32_t limit = input.device->max_image_dimension;
  if (input.view_width < 1 || input.view_height < 1 || input.view_width > limit || input.view_height > limit)
    refuse(fmt::format("the view is {}x{}; each side must be within 1 .. {}", input.view_width,
                       input.view_height, limit));
  check_length("setting values", input.settings.size(), input.graph->settings.size());
  check_length("bound flags", input.bound.size(), input.graph->resources.size());
  check_length("host formats", input.host_formats.size(), input.graph->resources.size());
  return diagnostics.count(Severity::error) == errors;
}

} // namespace

namespace {

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
  plan.history_parts.clear();
  plan.orderings.clear();
  plan.first_final_barrier = plan.final_barrier_count = 0;
  plan.final_wait = no_point;
  plan.transient_bytes = plan.history_bytes = 0;
  out.reasons.clear();
}

} // namespace

void CompileContext::add_reason(const Reason& reason) {
  out->reasons.push_back(reason);
}

Compiler::Compiler() : context_(std::make_unique<CompileContext>()) {}
Compiler::~Compiler() = default;

bool Compiler::compile(const CompileInput& input, Diagnostics& diagnostics, CompiledPlan& out) {
  clear(out);
  if (!acceptable(input, diagnostics)) return false;
  CompileContext& context = *context_;
  context.input = &input;
  context.graph = input.graph;
  context.pass_types = input.pass_types;
  context.device = input.device;
  context.diagnostics = &diagnostics;
  context.out = &out;
  const uint32_t errors_before = diagnostics.count(Severity::error);
  for (auto* phase : {
           resolve_sizes,      // how large is each resource, and which slots does the host bind?
           choose,             // what are the settings, and which passes are on?
           split_subresources, // into which parts do ports divide images?
           resolve_versions,   // which version of which resource does each port see?
           report_races,       // does a pass read what it writes?
           cull,               // which passes does something bound need?
           choose_queues,      // which of them run beside the others?
           gather_usage,       // how do they use each resource?
           resolve_formats,    // which format does each resource get, and how much memory?
           order,              // in which order do they run?
           lifetimes,          // from which pass to which is each resource alive?
           pack,               // where in memory does each one lie?
           synchronize,        // what must wait for what?
       }) {
    phase(context);
    if (diagnostics.count(Severity::error) == errors_before) continue;
    clear(out);
    return false;
  }
  out.plan.graph = input.graph->name;
  out.plan.view_width = input.view_width;
  out.plan.view_height = input.view_height;
  out.plan.device_profile = input.device->name;
  return true;
}

std::optional<CompiledPlan> compile(const CompileInput& input, Diagnostics& diagnostics) {
  CompiledPlan out;
  if (!Compiler().compile(input, diagnostics, out)) return std::nullopt;
  return out;
}

} // namespace dermis
