#pragma once
// Formats a machine's properties relevant to Dermis: the output of `dermis doctor --json`.

#include "integration/examples/demo_engine/device_survey.hpp"

#include <string>

namespace dermis::tools {

std::string survey_as_json(const demo::DeviceSurvey& survey);

} // namespace dermis::tools
