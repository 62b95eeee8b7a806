#pragma once
// Prints a survey of kernels and the check of its limits.

#include "integration/tools/command/kernels/limits.hpp"
#include "integration/tools/command/kernels/survey.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

std::string kernels_as_text(const KernelSurvey& survey, const KernelsOptions& options);
std::string limits_as_text(const LimitsCheck& check, const Diagnostics& files);
// Returns one line per finding, with the place of its limit.
std::string findings_as_text(const std::vector<LimitFinding>& findings, const Diagnostics& files);
std::string kernels_as_json(const KernelSurvey& survey, const KernelsOptions& options,
                            const std::optional<LimitsCheck>& check, const Diagnostics& files);

} // namespace dermis::tools
