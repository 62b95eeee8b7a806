#include "integration/tools/references/image_reads.hpp"

#include "passes/common/environment.hpp"
#include "passes/common/pass_types.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace dermis::subsurface {
namespace {

const PassTypeRegistry& pass_types() {
  static const PassTypeRegistry registry = make_pass_types();
  return registry;
}

// Returns the reads with all ports bound and all settings except one at their defaults.
ImageReads reads_of(std::string_view kind_name, std::string_view setting = "", int64_t value = 0,
                    PerChannel d_px = {4, 2, 1}) {
  static const std::vector<float> tables = make_shared_sap_tables({true, true});
  const PassType& type = pass_types()[pass_types().find(kind_name)];
  std::vector<SettingValue> settings;
  for (const PassTypeSetting& one : type.settings) {
    settings.push_back(one.default_value);
    if (one.name == setting) settings.back().integer = value;
  }
  const auto reads =
      image_reads(type, {settings, std::vector<bool>(type.ports.size(), true), d_px, tables});
  EXPECT_TRUE(reads.has_value()) << kind_name;
  return reads.value_or(ImageReads{});
}

TEST(ImageReads, EveryTypeThatSamplesAnImageIsCounted) {
  const std::vector<std::string_view> known = pass_types_with_known_reads();
  for (uint32_t i = 0; i < pass_types().size(); ++i) {
    const PassType& type = pass_types()[PassTypeId{i}];
    const bool samples = std::any_of(type.ports.begin(), type.ports.end(), [](const Port& port) {
      return port.usage == Usage::sampled_image;
    });
    EXPECT_TRUE(!samples || std::count(known.begin(), known.end(), type.name) == 1)
        << "count the reads of " << type.name << " in integration/tools/references/image_reads.cpp";
  }
  for (const std::string_view name : known)
    EXPECT_TRUE(pass_types().find(name).valid()) << name;
}

TEST(ImageReads, NoSampledImage_NoReads) {
  for (const std::string_view name : pass_types_with_known_reads()) {
    const PassType& type = pass_types()[pass_types().find(name)];
    const bool samples = std::any_of(type.ports.begin(), type.ports.end(), [](const Port& port) {
      return port.usage == Usage::sampled_image;
    });
    EXPECT_EQ(reads_of(name).per_invocation > 0, samples) << name;
  }
}

TEST(ImageReads, SampledTechniques_ReadFourPerSample) {
  const ImageReads few = reads_of("subsurface.burley", "samples", 8),
                   many = reads_of("subsurface.burley", "samples", 64);
  EXPECT_EQ(many.per_invocation - few.per_invocation, 56 * 4);
  EXPECT_EQ(few.samples, 8);
}

TEST(ImageReads, FilteredSamples_ReadOneMoreFromLevels) {
  const double none = reads_of("subsurface.afis", "mips", 2).per_invocation;
  EXPECT_EQ(reads_of("subsurface.afis", "mips", 0).per_invocation - none, 16);
  EXPECT_EQ(reads_of("subsurface.afis", "mips", 1).per_invocation - none, 16);
}

TEST(ImageReads, FirstTent_EndsAtZeroWeight) {
  // If the profile is 0.001 of a pixel wide, only the pixel itself counts.
  EXPECT_LT(reads_of("subsurface.sap_gather", "", 0, {1e-3, 1e-3, 1e-3}).per_invocation,
            reads_of("subsurface.sap_gather", "", 0, {1, 1, 1}).per_invocation);
}

TEST(ImageReads, PlainPyramid_ReadsFourPerLevel) {
  const double wide = reads_of("subsurface.pyramid_gather", "", 0, {8, 8, 8}).per_invocation;
  const double narrow =
      reads_of("subsurface.pyramid_gather", "", 0, {0.1, 0.1, 0.1}).per_invocation;
  EXPECT_LT(narrow, wide);
  EXPECT_LE(wide, 4 + 9 * 4);
}

TEST(ImageReads, UncountedType_IsNotGuessed) {
  PassType type = pass_types()[PassTypeId{0}];
  type.name = "subsurface.unheard_of";
  EXPECT_FALSE(image_reads(type, {}).has_value());
}

} // namespace
} // namespace dermis::subsurface
