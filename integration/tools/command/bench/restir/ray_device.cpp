// Checks whether this machine can trace rays.

#include "integration/examples/demo_engine/vulkan_host.hpp"
#include "integration/tools/command/bench/restir/ray_frames.hpp"

#include <fmt/format.h>

namespace dermis::tools {

std::string why_no_rays() {
  const auto host = demo::create_vulkan_host({});
  if (!host) return host.error().text;
  if ((*host)->ray_query) return "";
  return fmt::format(
      "'{}' has no ray queries (VK_KHR_ray_query, VK_KHR_acceleration_structure); without "
      "such a device, run tests/scripts/fetch_driver.sh, which fetches a software driver, and "
      "set VK_DRIVER_FILES to the manifest that it prints",
      (*host)->properties.deviceName);
}

} // namespace dermis::tools
