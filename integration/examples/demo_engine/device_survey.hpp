#pragma once
// What Vulkan on this machine offers to Dermis: loader, layer, devices, and of each what the library needs or
// can use.

#include "integration/examples/demo_engine/result.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace demo {

// One thing that is looked for in a device.
struct SurveyItem {
  std::string name;
  bool present = false;
  bool required = false; // without it the library does not run on the device
  std::string why;       // what it is for; for what is missing and not required, what happens instead
};

struct SurveyedDevice {
  std::string name, type;    // "discrete GPU", "CPU"
  std::string driver;        // name and version as the driver states them
  uint32_t api_version = 0;  // as VK_MAKE_API_VERSION packs it
  uint64_t memory_bytes = 0; // of its largest device-local heap
  std::vector<SurveyItem> items;
  bool fits = false;   // has all that is required
  bool chosen = false; // the one that `dermis render` takes
};

struct DeviceSurvey {
  uint32_t loader_version = 0;
  bool validation_layer = false;
  std::vector<SurveyedDevice> devices; // in the order of the driver
};

// Makes an instance, looks, and destroys it. Errors: environment when there is no loader or no driver.
Result<DeviceSurvey> survey_devices();

} // namespace demo
