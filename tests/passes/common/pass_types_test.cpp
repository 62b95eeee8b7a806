#include "passes/common/pass_types.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace {

using namespace dermis;

class PassTypes : public ::testing::Test {
protected:
  PassTypeRegistry pass_types = subsurface::make_pass_types();
};

TEST_F(PassTypes, EveryTypeIsNamedAndDescribed) {
  ASSERT_GT(pass_types.size(), 0u);
  for (uint32_t i = 0; i < pass_types.size(); ++i) {
    const PassType& type = pass_types[PassTypeId{i}];
    const bool clears = type.name == "clear"; // The clear works on any image and has no kernel.
    EXPECT_TRUE(clears || type.name.starts_with("subsurface.") || type.name.starts_with("restir."))
        << type.name;
    EXPECT_EQ(type.shader.empty(), clears) << type.name;
    EXPECT_FALSE(type.doc.empty()) << type.name;
    for (const Port& port : type.ports)
      EXPECT_FALSE(port.doc.empty()) << type.name << "." << port.name;
    for (const PassTypeSetting& setting : type.settings)
      EXPECT_FALSE(setting.doc.empty()) << type.name << "." << setting.name;
  }
}

TEST_F(PassTypes, PortAndSettingNamesAreUnique) {
  for (uint32_t i = 0; i < pass_types.size(); ++i) {
    const PassType& type = pass_types[PassTypeId{i}];
    std::set<std::string_view> names;
    for (const Port& port : type.ports)
      EXPECT_TRUE(names.insert(port.name).second) << type.name << "." << port.name;
    names.clear();
    for (const PassTypeSetting& setting : type.settings)
      EXPECT_TRUE(names.insert(setting.name).second) << type.name << "." << setting.name;
  }
}

TEST_F(PassTypes, SignaturesFitPortMaskAnd128BytesOfPushConstants) {
  for (uint32_t i = 0; i < pass_types.size(); ++i) {
    const PassType& type = pass_types[PassTypeId{i}];
    EXPECT_LE(type.ports.size(), 32u) << type.name;
    EXPECT_LE(4 + 4 * type.settings.size(), 128u) << type.name;
  }
}

TEST_F(PassTypes, DefaultsAreWithinRangesAndOptions) {
  for (uint32_t i = 0; i < pass_types.size(); ++i)
    for (const PassTypeSetting& setting : pass_types[PassTypeId{i}].settings) {
      const SettingValue& value = setting.default_value;
      EXPECT_EQ(value.type, setting.type) << setting.name;
      if (setting.type == SettingType::integer) {
        EXPECT_GE(static_cast<double>(value.integer), setting.minimum) << setting.name;
        EXPECT_LE(static_cast<double>(value.integer), setting.maximum) << setting.name;
      }
      if (setting.type == SettingType::enumeration) {
        EXPECT_LT(static_cast<size_t>(value.integer), setting.options.size()) << setting.name;
      }
    }
}

TEST_F(PassTypes, TileDispatches_ReadTheListAndItsArguments) {
  for (uint32_t i = 0; i < pass_types.size(); ++i) {
    const PassType& type = pass_types[PassTypeId{i}];
    if (type.dispatch.domain == DispatchRule::Domain::indirect) {
      const bool levels = find_port(type, "level_tiles") >= 0;
      EXPECT_GE(find_port(type, levels ? "level_tiles" : "tiles"), 0) << type.name;
      EXPECT_GE(find_port(type, levels ? "level_arguments" : "arguments"), 0) << type.name;
      EXPECT_TRUE(type.arguments_entry.empty() || find_setting(type, type.arguments_entry) >= 0)
          << type.name;
    }
  }
}

// A kernel that writes past the end of a buffer would overwrite the memory after it.
TEST_F(PassTypes, EveryBufferSizeIsChecked) {
  for (uint32_t i = 0; i < pass_types.size(); ++i) {
    const PassType& type = pass_types[PassTypeId{i}];
    for (const Port& port : type.ports) {
      if (usage_info(port.usage).image || port.usage == Usage::acceleration_structure) continue;
      const auto need = std::find_if(type.needs.begin(), type.needs.end(),
                                     [&](const PortNeed& one) { return one.port == port.name; });
      ASSERT_NE(need, type.needs.end()) << type.name << "." << port.name;
      EXPECT_GT(uint64_t{need->square} * need->bytes + need->more, 0u)
          << type.name << "." << port.name;
    }
  }
}

} // namespace
