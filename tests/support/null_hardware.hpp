#pragma once
// Mesa's driver for AMD GPUs without a GPU: it creates a device that compiles pipelines, and
// nothing else.

#include <filesystem>
#include <string>
#include <vector>

namespace dermis::testing {

// Returns the manifest of the system's driver for AMD GPUs, or "" if it is not installed.
inline std::string radeon_driver() {
  std::error_code none;
  for (const auto& file : std::filesystem::directory_iterator("/usr/share/vulkan/icd.d", none))
    if (file.path().extension() == ".json" &&
        file.path().filename().string().starts_with("radeon_icd"))
      return file.path().string();
  return "";
}

// Returns variables for a program that sees only an absent GPU of that family ("navi21").
inline std::vector<std::string> null_hardware(const std::string& family) {
  const std::string driver = radeon_driver();
  return {"VK_DRIVER_FILES=" + driver, "VK_ICD_FILENAMES=" + driver, "RADV_FORCE_FAMILY=" + family};
}

} // namespace dermis::testing
