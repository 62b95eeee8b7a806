#include "passes/common/kinds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace {

using namespace dermis;

class Kinds : public ::testing::Test {
protected:
  KindRegistry kinds = subsurface::make_kinds();
};

TEST_F(Kinds, EveryKindHasANameAShaderAndADescriptionOfEachPartOfItsSignature) {
  ASSERT_GT(kinds.size(), 0u);
  for (uint32_t i = 0; i < kinds.size(); ++i) {
    const PassKind& kind = kinds[KindId{i}];
    const bool clears = kind.name == "clear"; // whatever image it is: no kernel
    EXPECT_TRUE(clears || kind.name.starts_with("subsurface.") || kind.name.starts_with("restir."))
        << kind.name;
    EXPECT_EQ(kind.shader.empty(), clears) << kind.name;
    EXPECT_FALSE(kind.doc.empty()) << kind.name;
    for (const Port& port : kind.ports)
      EXPECT_FALSE(port.doc.empty()) << kind.name << "." << port.name;
    for (const KindSetting& setting : kind.settings)
      EXPECT_FALSE(setting.doc.empty()) << kind.name << "." << setting.name;
  }
}

TEST_F(Kinds, NoKindNamesAPortOrASettingTwice) {
  for (uint32_t i = 0; i < kinds.size(); ++i) {
    const PassKind& kind = kinds[KindId{i}];
    std::set<std::string_view> names;
    for (const Port& port : kind.ports)
      EXPECT_TRUE(names.insert(port.name).second) << kind.name << "." << port.name;
    names.clear();
    for (const KindSetting& setting : kind.settings)
      EXPECT_TRUE(names.insert(setting.name).second) << kind.name << "." << setting.name;
  }
}

TEST_F(Kinds, SignaturesFitThePortMaskAndThe128BytesOfPushConstantsThatVulkanGuarantees) {
  for (uint32_t i = 0; i < kinds.size(); ++i) {
    const PassKind& kind = kinds[KindId{i}];
    EXPECT_LE(kind.ports.size(), 32u) << kind.name;
    EXPECT_LE(4 + 4 * kind.settings.size(), 128u) << kind.name;
  }
}

TEST_F(Kinds, DefaultsLieInsideTheirRangesAndOptions) {
  for (uint32_t i = 0; i < kinds.size(); ++i)
    for (const KindSetting& setting : kinds[KindId{i}].settings) {
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

TEST_F(Kinds, KindsThatRunOverTilesReadTheListAndItsArguments) {
  for (uint32_t i = 0; i < kinds.size(); ++i) {
    const PassKind& kind = kinds[KindId{i}];
    if (kind.dispatch == DispatchShape::over_tiles) {
      const bool levels = find_port(kind, "level_tiles") >= 0;
      EXPECT_GE(find_port(kind, levels ? "level_tiles" : "tiles"), 0) << kind.name;
      EXPECT_GE(find_port(kind, levels ? "level_arguments" : "arguments"), 0) << kind.name;
      EXPECT_TRUE(kind.arguments_entry.empty() || find_setting(kind, kind.arguments_entry) >= 0) << kind.name;
    }
  }
}

// A kernel that wrote past the end of a buffer would write into what lies behind it.
TEST_F(Kinds, EveryBufferOfEveryKindHasASizeThatIsChecked) {
  for (uint32_t i = 0; i < kinds.size(); ++i) {
    const PassKind& kind = kinds[KindId{i}];
    for (const Port& port : kind.ports) {
      if (usage_info(port.usage).image || port.usage == Usage::acceleration_structure) continue;
      const auto need = std::find_if(kind.needs.begin(), kind.needs.end(),
                                     [&](const PortNeed& one) { return one.port == port.name; });
      ASSERT_NE(need, kind.needs.end()) << kind.name << "." << port.name;
      EXPECT_GT(uint64_t{need->square} * need->bytes + need->more, 0u) << kind.name << "." << port.name;
    }
  }
}

} // namespace
