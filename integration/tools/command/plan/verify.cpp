// dermis plan verify: runs the verifier on saved plans, without their graphs.

#include "framegraph/verify/verify.hpp"
#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/plan/input.hpp"

#include <fmt/format.h>

namespace dermis::tools {
namespace {

// Appends the names of "pass 3" and "resource 7", which are indices into the plan.
std::string with_names(const SavedPlan& saved, const std::string& violation) {
  std::string text = violation;
  const auto append_name = [&](std::string_view word, const std::vector<std::string>& names) {
    const size_t at = violation.find(word);
    if (at == std::string::npos) return;
    size_t index = 0, digits = 0;
    for (size_t i = at + word.size();
         i < violation.size() && violation[i] >= '0' && violation[i] <= '9' && digits < 9;
         ++i, ++digits)
      index = index * 10 + static_cast<size_t>(violation[i] - '0');
    if (digits > 0 && index < names.size())
      text += fmt::format("; {}{} is '{}'", word, index, names[index]);
  };
  append_name("pass ", saved.names.passes);
  append_name("resource ", saved.names.resources);
  return text;
}

} // namespace

ExitCode plan_verify(const Session& session, const PlanVerifyOptions& options) {
  Diagnostics diagnostics;
  bool all_proven = true;
  for (const std::string& file : options.files) {
    const auto bytes = read_plan_bytes(file, diagnostics);
    const auto saved = bytes ? read_plan(file, *bytes, diagnostics) : std::nullopt;
    if (!saved) continue;
    const SourceLocation where{{static_cast<uint32_t>(diagnostics.files.size()) - 1}, 0, 0, ""};
    const Verdict verdict = verify(saved->plan);
    all_proven &= verdict.proven();
    for (const std::string& violation : verdict.violations)
      diagnostics.add(DiagnosticId::plan_rejected, where, with_names(*saved, violation));
    if (!verdict.not_verified.empty())
      diagnostics.add(DiagnosticId::plan_not_verified, where,
                      fmt::format("the plan is not verified: {}", verdict.not_verified));
    if (verdict.proven())
      say(session, fmt::format("{}: {} passes, {} barriers: no hazard\n", file,
                               saved->plan.passes.size(), saved->plan.barriers.size()));
  }
  if (session.json) {
    print(format_as_json(diagnostics));
  } else {
    print_diagnostics(session, diagnostics);
  }
  return all_proven && !diagnostics.has_errors() ? ExitCode::ok : ExitCode::problems;
}

} // namespace dermis::tools
