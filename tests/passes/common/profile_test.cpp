#include "passes/common/environment.hpp"
#include "passes/common/kernel_tables.hpp"
#include "passes/common/pass_types.hpp"
#include "passes/common/profiles/profile.hpp"
#include "tests/support/text_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <sstream>

namespace {

using namespace dermis;
using namespace dermis::subsurface;

std::optional<Profile> parsed(const std::string& text, Diagnostics& diagnostics) {
  const auto document = parse_document("test.json", text, diagnostics);
  return document ? read_profile(*document, diagnostics) : std::nullopt;
}

TEST(Profile, ShapeParameterIsDmfpOverAlbedoScaling) {
  Diagnostics diagnostics;
  const auto profile = parsed(R"({"dermis_profile": 1, "name": "p", "dmfp_mm": [3.67, 1.37, 0.68],
                                "albedo": [0.33, 0.8, 1.0], "source": "test"})",
                              diagnostics);
  ASSERT_TRUE(profile) << format_as_json(diagnostics);
  EXPECT_NEAR(profile->d_mm[0], 3.67 / 3.5, 1e-12);      // s(0.33) = 3.5
  EXPECT_NEAR(profile->d_mm[1], 1.37 / 8.3796841, 1e-6); // s(0.8) = 3.5 + 100 * 0.47^4
  EXPECT_NEAR(profile->d_mm[2], 0.68 / 23.651121, 1e-6); // s(1) = 3.5 + 100 * 0.67^4
}

TEST(Profile, WidestChannelHasTheLargestShapeParameter) {
  Diagnostics diagnostics;
  const auto profile = parsed(R"({"dermis_profile": 1, "name": "p", "dmfp_mm": [5, 4, 1],
                                "albedo": [1, 0.33, 0.33], "source": "test"})",
                              diagnostics);
  ASSERT_TRUE(profile);
  EXPECT_EQ(profile->widest, 1); // d = 5/23.65, 4/3.5, 1/3.5
}

TEST(Profile, DistancesBelowAnyMaterial_DoNotScatter) {
  Diagnostics diagnostics;
  const auto profile = parsed(R"({"dermis_profile": 1, "name": "p", "dmfp_mm": [1, 1e-300, 1e-7],
                                "albedo": [0.5, 0.5, 0.5], "source": "test"})",
                              diagnostics);
  ASSERT_TRUE(profile) << format_as_json(diagnostics);
  EXPECT_GT(profile->d_mm[0], 0);
  EXPECT_EQ(profile->d_mm[1], 0);
  EXPECT_EQ(profile->d_mm[2], 0);
}

TEST(Profile, AMeanFreePathOfZeroMeansNoScattering) {
  Diagnostics diagnostics;
  const auto profile = parsed(
      R"({"dermis_profile": 1, "name": "p", "dmfp_mm": [0, 0, 0], "albedo": [1, 1, 1], "source": "t"})",
      diagnostics);
  ASSERT_TRUE(profile);
  for (const double d : profile->d_mm)
    EXPECT_EQ(d, 0.0);
}

TEST(Profile, InvalidValuesAndKeys_AreRejectedWithTheirPlace) {
  Diagnostics diagnostics;
  EXPECT_FALSE(parsed("{\"dermis_profile\": 1, \"name\": \"p\",\n \"dmfp_mm\": [-1, 0, 0],\n "
                      "\"albedo\": [0, 2, 0],\n"
                      " \"sorce\": \"t\"}",
                      diagnostics));
  ASSERT_EQ(diagnostics.count(Severity::error), 3u) << format_as_json(diagnostics);
  EXPECT_EQ(diagnostics.list[0].id, DiagnosticId::out_of_range);
  EXPECT_EQ(diagnostics.list[0].where.line, 2u);
  EXPECT_EQ(diagnostics.list[0].where.pointer, "/dmfp_mm/0");
  EXPECT_EQ(diagnostics.list[1].where.pointer, "/albedo/1");
  EXPECT_EQ(diagnostics.list[2].id, DiagnosticId::unknown_key); // Also reports the missing key.
  EXPECT_NE(diagnostics.list[2].suggestion.find("source"), std::string::npos);
}

TEST(Profile, EveryShippedProfileReadsAndNamesItsSource) {
  int seen = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(DERMIS_SOURCE_DIR "/configs/profiles")) {
    Diagnostics diagnostics;
    const auto document = read_document(entry.path().string(), diagnostics);
    ASSERT_TRUE(document) << entry.path();
    const auto profile = read_profile(*document, diagnostics);
    ASSERT_TRUE(profile) << format_as_json(diagnostics);
    EXPECT_EQ(profile->name, entry.path().stem().string());
    EXPECT_FALSE(profile->source.empty());
    ++seen;
  }
  EXPECT_GE(seen, 5);
}

TEST(Profile, HumanSkinHasTheShapeParametersOfItsMeasurement) {
  Diagnostics diagnostics;
  const auto document = read_document(DERMIS_SOURCE_DIR "/configs/profiles/skin.json", diagnostics);
  const auto profile = read_profile(*document, diagnostics);
  ASSERT_TRUE(profile);
  EXPECT_NEAR(profile->d_mm[0], 1.05, 0.01); // 3.67 mm / 3.515
  EXPECT_NEAR(profile->d_mm[1], 0.39, 0.005);
  EXPECT_NEAR(profile->d_mm[2], 0.19, 0.005);
}

TEST(Environment, UndeclaredProfilesPassLightThrough) {
  NumberedProfile skin{7, {}};
  skin.profile.dmfp_mm = {3.5, 1, 1};
  skin.profile.albedo = {0.33, 0.33, 0.33};
  derive(skin.profile);
  const auto table = make_profile_table(std::span(&skin, 1), false);
  ASSERT_EQ(table.size(), profile_capacity);
  EXPECT_EQ(table[0].d_max_mm, 0.0f);
  EXPECT_FLOAT_EQ(table[7].d_max_mm, 1.0f);
  EXPECT_EQ(table[8].d_max_mm, 0.0f);
}

// Returns whether the shader, with all that it includes, has the text.
bool source_has(const std::string& shader, const std::string& text, std::set<std::string>& seen) {
  if (!seen.insert(shader).second) return false;
  std::istringstream lines(test::read_text(DERMIS_SOURCE_DIR "/shaders/" + shader));
  for (std::string line; std::getline(lines, line);) {
    if (line.find(text) != std::string::npos) return true;
    if (line.starts_with("#include \"") &&
        source_has(line.substr(10, line.rfind('"') - 10), text, seen))
      return true;
  }
  return false;
}

TEST(KernelTables, GraphsHaveTheSeparableTableThatTheirKernelsRead) {
  const PassTypeRegistry pass_types = make_pass_types();
  uint32_t readers = 0;
  for (uint32_t i = 0; i < pass_types.size(); ++i) {
    const PassType& type = pass_types[PassTypeId{i}];
    std::set<std::string> seen;
    if (!source_has(std::string(type.shader) + ".comp", "separable_rows[place", seen)) continue;
    ++readers;
    Graph graph;
    graph.passes.emplace_back().type = PassTypeId{i};
    EXPECT_TRUE(table_use(graph, pass_types).separable) << type.name;
  }
  EXPECT_GE(readers, 3u);
}

NumberedProfile shipped_profile(uint32_t id, const std::string& name) {
  Diagnostics diagnostics;
  const auto document =
      read_document(DERMIS_SOURCE_DIR "/configs/profiles/" + name + ".json", diagnostics);
  return {id, read_profile(*document, diagnostics).value()};
}

// The tables of `before` are changed here, so that a copied table differs from a fitted one.
TEST(KernelTables, UnchangedProfilesAreCopied) {
  TableUse use;
  use.separable = use.pyramid.surface = true;
  const std::vector<NumberedProfile> old{shipped_profile(1, "skin"),
                                         shipped_profile(2, "skin_dipole")};
  KernelTables before = make_kernel_tables(use, old);
  const size_t rows = before.separable.size() / 2;
  const size_t floats = before.pyramid.size() - before.shared_floats; // of one dipole
  for (SeparableRow& row : before.separable)
    row[3] += 100;
  for (float& value : before.pyramid)
    value += 100;
  const std::vector<NumberedProfile> replaced{shipped_profile(9, "skin_artist"), old[1], old[0]};
  const KernelTables fitted = make_kernel_tables(use, replaced);
  const KernelTables reused = make_kernel_tables(use, replaced, &before);
  ASSERT_EQ(reused.separable.size(), fitted.separable.size());
  for (size_t i = 0; i < fitted.separable.size(); ++i)
    ASSERT_EQ(reused.separable[i][3], fitted.separable[i][3] + (i < rows ? 0 : 100)) << i;
  ASSERT_EQ(reused.pyramid.size(), fitted.pyramid.size());
  ASSERT_EQ(fitted.pyramid.size(), fitted.shared_floats + 2 * floats);
  for (size_t i = 0; i < fitted.pyramid.size(); ++i) {
    const bool fresh = i >= fitted.shared_floats && i < fitted.shared_floats + floats;
    ASSERT_EQ(reused.pyramid[i], fitted.pyramid[i] + (fresh ? 0 : 100)) << i;
  }
  use.pyramid.pixel_grid = 1; // other shared tables
  EXPECT_EQ(make_kernel_tables(use, replaced, &before).pyramid,
            make_kernel_tables(use, replaced).pyramid);
}

TEST(Environment, FrameConstantsReconstructViewPositions) {
  // 90 degrees, 4:2 view, reversed infinite depth, units of 10 m.
  FrameInput input;
  input.rect_width = 4;
  input.rect_height = 2;
  input.metres_per_unit = 10;
  input.camera.clip_from_view = {0.5, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0.1, 0, 0, -1, 0};
  FrameConstants constants{};
  ASSERT_TRUE(fill_frame_constants(input, constants));
  EXPECT_EQ(constants.tiles[0], 1);
  EXPECT_EQ(constants.flags, 1u | 4u);
  // View point (1, 0.5, -2) units: ndc = (0.25, -0.25), depth value 0.1 / 2; pixel = (ndc + 1) / 2
  // * size - 1/2.
  const float pixel[2] = {2.0f, 0.25f};
  const float value = 0.05f;
  const float depth = (constants.depth_decode[0] * value + constants.depth_decode[1]) /
                      (constants.depth_decode[2] * value + constants.depth_decode[3]);
  EXPECT_NEAR(depth, 20000.0f, 0.1f); // 2 units = 20 m
  EXPECT_NEAR((constants.ray_scale[0] * pixel[0] + constants.ray_offset[0]) * depth, 10000.0f,
              0.1f);
  EXPECT_NEAR((constants.ray_scale[1] * pixel[1] + constants.ray_offset[1]) * depth, 5000.0f, 0.1f);
}

TEST(Environment, NotAProjection_IsRejected) {
  FrameInput input;
  input.rect_width = input.rect_height = 8;
  FrameConstants constants{};
  EXPECT_FALSE(fill_frame_constants(input, constants));
}

} // namespace
