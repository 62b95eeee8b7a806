#pragma once
// The driver with ray queries that tests/scripts/fetch_driver.sh stores in build/drivers.

#include <filesystem>
#include <string>

namespace dermis::testing {

// Returns the path of the manifest, or "" if no driver was fetched.
inline std::string driver_with_ray_queries() {
  std::error_code none;
  for (const auto& file :
       std::filesystem::directory_iterator(std::string(DERMIS_SOURCE_DIR) + "/build/drivers", none))
    if (file.path().extension() == ".json" && file.path().filename().string().starts_with("mesa"))
      return file.path().string();
  return "";
}

} // namespace dermis::testing
