// dermis plan diff: compares two plans.

#include "framegraph/explain/plan_diff.hpp"
#include "integration/tools/command/plan/input.hpp"

#include <initializer_list>

namespace dermis::tools {
namespace {

template <class T> void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

bool sides_differ(const PlanDiffOptions& options) {
  return !options.b_settings.empty() || !options.b_unbound.empty() || !options.b_overlays.empty() ||
         options.b_size.width > 0;
}

} // namespace

ExitCode plan_diff(const Session& session, const PlanDiffOptions& options) {
  if (options.files.size() == 1 && !sides_differ(options))
    return fail(
        session, ExitCode::usage,
        "name two plans, or set differences of the second plan with --b-set, --b-size, --b-unbound "
        "or --b-overlay");
  const PlanSource a{options.files.front(), options.inputs, options.size, options.settings,
                     options.unbound};
  PlanSource b = a;
  b.file = options.files.back();
  append(b.inputs.overlays, options.b_overlays);
  append(b.settings, options.b_settings);
  append(b.unbound, options.b_unbound);
  if (options.b_size.width > 0) b.size = options.b_size;

  Diagnostics diagnostics;
  std::vector<NamedPlan> plans;
  for (const PlanSource* source : std::initializer_list<const PlanSource*>{&a, &b}) {
    std::string problem;
    auto plan = load_plan(*source, diagnostics, problem);
    if (!problem.empty()) return fail(session, ExitCode::usage, source->file + ": " + problem);
    if (!plan) return fail_graph(session, source->file, diagnostics);
    plans.push_back(std::move(*plan));
  }
  if (!plans.back().from_graph && sides_differ(options))
    return fail(session, ExitCode::usage,
                options.files.back() + ": is a saved plan; --b-set, --b-size, --b-unbound and "
                                       "--b-overlay need a graph to compile");
  const bool changed =
      !options.settings.empty() || !options.unbound.empty() || !options.inputs.overlays.empty();
  if (!plans.front().from_graph && changed)
    return fail(session, ExitCode::usage,
                options.files.front() +
                    ": is a saved plan; --set, --unbound and --overlay need a graph to compile");
  print_beside_document(session, diagnostics);
  const PlanDiff diff = diff_plans(plans[0].saved, plans[1].saved);
  print(session.json ? plan_diff_json(diff, plans[0].name, plans[1].name)
                     : for_terminal(plan_diff_text(diff, plans[0].name, plans[1].name)));
  return options.exit_code && !diff.same ? ExitCode::problems : ExitCode::ok;
}

} // namespace dermis::tools
