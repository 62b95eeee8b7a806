// dermis plan verify: runs the verifier on saved plans, without their graphs.

#include "integration/tools/command/plan/verify.hpp"

#include "framegraph/text/json_writer.hpp"
#include "framegraph/verify/verify.hpp"
#include "integration/tools/command/plan/input.hpp"

#include <fmt/format.h>

#include <algorithm>

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

VerifiedPlan verify_plan_file(const std::string& file, Diagnostics& diagnostics) {
  VerifiedPlan out{file};
  const auto bytes = read_plan_bytes(file, diagnostics);
  const auto saved = bytes ? read_plan(file, *bytes, diagnostics) : std::nullopt;
  if (!saved) return out;
  const SourceLocation where{{static_cast<uint32_t>(diagnostics.files.size()) - 1}, 0, 0, ""};
  const Verdict verdict = verify(saved->plan);
  for (const std::string& violation : verdict.violations)
    diagnostics.add(DiagnosticId::plan_rejected, where, with_names(*saved, violation));
  if (!verdict.not_verified.empty())
    diagnostics.add(DiagnosticId::plan_not_verified, where,
                    fmt::format("the plan is not verified: {}", verdict.not_verified));
  return {file,
          true,
          verdict.violations.empty(),
          verdict.not_verified.empty(),
          saved->plan.passes.size(),
          saved->plan.barriers.size()};
}

std::string describe(const VerifiedPlan& plan) {
  return fmt::format("{} passes, {} barriers", plan.passes, plan.barriers);
}

ExitCode plan_verify(const Session& session, const PlanVerifyOptions& options) {
  Diagnostics diagnostics;
  std::vector<VerifiedPlan> plans;
  for (const std::string& file : options.files)
    plans.push_back(verify_plan_file(file, diagnostics));
  const auto proven = [](const VerifiedPlan& plan) { return plan.good && plan.verified; };
  const bool all_proven = std::all_of(plans.begin(), plans.end(), proven);
  for (const VerifiedPlan& plan : plans)
    if (proven(plan)) say(session, fmt::format("{}: {}: no hazard\n", plan.file, describe(plan)));
  print_diagnostics(session, diagnostics);
  if (session.json) {
    JsonWriter answer;
    answer.open_object().member("ok", all_proven).key("files").open_array();
    for (const VerifiedPlan& plan : plans) {
      answer.open_object(true).member("file", plan.file).member("ok", proven(plan));
      if (plan.read)
        answer.member("verified", plan.verified)
            .member("passes", plan.passes)
            .member("barriers", plan.barriers);
      answer.close();
    }
    answer.close().key("diagnostics").json(format_as_json(diagnostics)).close();
    print(std::move(answer).finish());
  }
  return all_proven ? ExitCode::ok : ExitCode::problems;
}

} // namespace dermis::tools
