#pragma once
// Surveys Vulkan on this machine: loader, layer, devices, and the features of each device that the
// library needs or can use.

#include "integration/examples/demo_engine/result.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace demo {

// One feature that is looked up on a device.
struct SurveyItem {
  std::string name;
  bool present = false;
  bool required = false; // the library does not run on the device without this feature
  std::string why;       // purpose; for an optional feature that is missing, the consequence
};

struct SurveyedDevice {
  std::string name, type;    // "discrete GPU", "CPU"
  std::string driver;        // name and version as the driver states them
  uint32_t api_version = 0;  // as VK_MAKE_API_VERSION packs it
  uint64_t memory_bytes = 0; // size of its largest device-local heap
  std::vector<SurveyItem> items;
  bool fits = false;   // has all required features
  bool chosen = false; // the device that `dermis render` uses
};

struct DeviceSurvey {
  uint32_t loader_version = 0;
  bool validation_layer = false;
  std::vector<SurveyedDevice> devices; // in the order of the driver
};

// Creates an instance, inspects its devices, and destroys it. Errors: environment if there is no
// loader or no driver.
Result<DeviceSurvey> survey_devices();

} // namespace demo
