#pragma once
// Default tables embedded in the library: configs/choice/*.json.

#include <string_view>

namespace dermis::choice {

std::string_view default_errors_text();      // for read_error_model()
std::string_view default_calibration_text(); // for read_calibration()

} // namespace dermis::choice
