// dermis doctor: checks the machine against Dermis's requirements, and lists the device used and
// missing optional features with reasons.

#include "framegraph/text/json_writer.hpp"
#include "integration/abi/shaders/compiler.hpp"
#include "integration/tools/command/inspect/survey.hpp"
#include "integration/tools/command/verbs.hpp"

#include <dermis/dermis.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace dermis::tools {
namespace {

std::string version_text(uint32_t version) {
  return fmt::format("{}.{}.{}", VK_API_VERSION_MAJOR(version), VK_API_VERSION_MINOR(version),
                     VK_API_VERSION_PATCH(version));
}

std::string library_version() {
  const uint32_t version = dermis_version(); // packed like Vulkan versions
  return version_text(version);
}

const char* state_of(const demo::SurveyItem& item) {
  return item.present ? "ok" : item.required ? "missing" : "degraded";
}

void add_device(const demo::SurveyedDevice& device, Table& table) {
  table.rows.emplace_back();
  table.rows.push_back(
      {device.fits ? "ok" : "missing", device.name,
       fmt::format("{}, {}, Vulkan {}, {}{}", device.type, device.driver,
                   version_text(device.api_version), format_bytes(device.memory_bytes),
                   device.chosen ? "; render and apply use this one" : "")});
  for (const demo::SurveyItem& item : device.items)
    table.rows.push_back({state_of(item), "  " + item.name, item.why});
}

std::string screen(const demo::DeviceSurvey& survey) {
  Table table{{{""}, {"what"}, {"for"}}, {}};
  table.rows.push_back({"ok", "Dermis", library_version()});
  table.rows.push_back({"ok", "Vulkan loader", version_text(survey.loader_version)});
  table.rows.push_back(
      {survey.validation_layer ? "ok" : "degraded", "Khronos validation layer",
       survey.validation_layer
           ? "used by every device test"
           : "not installed (Debian: vulkan-validationlayers); required by tests"});
  const std::string compiler = abi::shader_compiler();
  table.rows.push_back(
      {compiler.empty() ? "degraded" : "ok", "shaders at run time",
       compiler.empty()
           ? "built without glslang (Debian: glslang-dev); watch and render cannot compile shaders"
           : compiler + " compiles shaders of render --shaders and watch"});
  for (const demo::SurveyedDevice& device : survey.devices)
    add_device(device, table);
  return format_table(table);
}

bool any_fits(const demo::DeviceSurvey& survey) {
  return std::any_of(survey.devices.begin(), survey.devices.end(),
                     [](const demo::SurveyedDevice& device) { return device.fits; });
}

} // namespace

std::string survey_as_json(const demo::DeviceSurvey& survey) {
  JsonWriter json;
  json.open_object().member("ok", any_fits(survey)).member("dermis", library_version());
  json.member("loader", version_text(survey.loader_version))
      .member("validation_layer", survey.validation_layer)
      .member("shader_compiler", abi::shader_compiler()); // "" if there is none
  json.key("devices").open_array();
  for (const demo::SurveyedDevice& device : survey.devices) {
    json.open_object()
        .member("name", device.name)
        .member("type", device.type)
        .member("driver", device.driver);
    json.member("vulkan", version_text(device.api_version))
        .member("memory_bytes", device.memory_bytes);
    json.member("fits", device.fits).member("used", device.chosen).key("items").open_array();
    for (const demo::SurveyItem& item : device.items)
      json.open_object(true)
          .member("name", item.name)
          .member("state", state_of(item))
          .member("why", item.why)
          .close();
    json.close().close();
  }
  json.close().close();
  return std::move(json).finish();
}

// Returns the report for a machine without a loader or driver.
std::string screen_without_devices() {
  const char* why = "validate, explain, plan, test, graph and compare work without a device";
  return format_table({{{""}, {"what"}, {"for"}},
                       {{"ok", "Dermis", library_version()}, {"missing", "Vulkan device", why}}});
}

ExitCode doctor(const Session& session, const DoctorOptions&) {
  const demo::Result<demo::DeviceSurvey> survey = demo::survey_devices();
  if (!survey) {
    say(session, screen_without_devices());
    return fail(session, survey.error());
  }
  const bool fits = any_fits(*survey);
  if (session.json) print(survey_as_json(*survey));
  say(session, screen(*survey));
  if (fits) return ExitCode::ok;
  return session.json ? ExitCode::environment
                      : fail(session, ExitCode::environment,
                             "no device meets all requirements; install a newer driver (Debian: "
                             "mesa-vulkan-drivers has a software driver)");
}

} // namespace dermis::tools
