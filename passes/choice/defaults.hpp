#pragma once
// Default tables embedded in the library: configs/choice/.

#include <cstdint>
#include <string_view>

namespace dermis::choice {

std::string_view default_errors_text(); // for read_error_model()

// Classes of devices, whose passes have different ratios of costs.
enum class DeviceClass : uint8_t { cpu, small_gpu, large_gpu };
// For read_calibration(). The costs of `cpu` were measured; those of GPUs are modelled
// (tests/gpu/write_calibrations.py).
std::string_view default_calibration_text(DeviceClass device);

} // namespace dermis::choice
