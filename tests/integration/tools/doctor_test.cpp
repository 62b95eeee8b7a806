// Tests `dermis doctor`, which a new user runs first if nothing works.
#include "tests/integration/tools/command_fixture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace dermis::test {
namespace {

class DoctorVerb : public CommandTest {};

TEST_F(DoctorVerb, NamesTheDeviceAndAllRequirements) {
  const Outcome text = run({"doctor"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  for (const char* what : {"Vulkan loader", "shaders at run time", "synchronization2",
                           "maintenance4", "timestamps", "render and apply use this one"})
    EXPECT_THAT(text.out, HasSubstr(what));
  EXPECT_LE(std::count(text.out.begin(), text.out.end(), '\n'), 40)
      << "one screen, also with two devices";
}

TEST_F(DoctorVerb, JsonOutput) {
  const Outcome answer = run({"doctor", "--json"});
  ASSERT_EQ(answer.exit_code, 0) << answer.err;
  const nlohmann::json document = nlohmann::json::parse(answer.out);
  EXPECT_TRUE(document["ok"]);
  size_t used = 0;
  for (const auto& device : document["devices"]) {
    used += device["used"].get<bool>() ? 1 : 0;
    for (const auto& item : device["items"])
      EXPECT_THAT(item["state"].get<std::string>(), ::testing::AnyOf("ok", "missing", "degraded"));
  }
  EXPECT_EQ(used, 1u);
}

TEST_F(DoctorVerb, NoDriver_SaysWhatToInstall) {
  RunOptions without;
  without.environment = {"VK_DRIVER_FILES=/nowhere.json", "VK_ICD_FILENAMES=/nowhere.json"};
  const Outcome text = run({"doctor"}, without);
  EXPECT_THAT(text, FailsWith(3, "mesa-vulkan-drivers"));
  EXPECT_THAT(text.out, HasAll("ok       Dermis", "missing  Vulkan device"));
}

} // namespace
} // namespace dermis::test
