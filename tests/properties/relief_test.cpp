// The relief that classification counts, by which a budget expects errors, on scenes of the seeded
// family.
#include "integration/tools/command/bench/family/family.hpp"
#include "integration/tools/command/bench/technique.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "passes/common/reference/relief.hpp"
#include "tests/properties/plane.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <algorithm>

namespace {

using namespace dermis::tools;

constexpr uint32_t width = 144, height = 81; // Pixels.

struct Relief : properties::DeviceTest {
  // Returns the relief of a scene as the reference and as a frame of skin.json counts it.
  static std::pair<double, double> relief_of(demo::VulkanHost& host, const std::string& name,
                                             const std::string& technique) {
    const auto scene = std::ranges::find(family_scenes(), name, &FamilyScene::name);
    EXPECT_NE(scene, family_scenes().end()) << name;
    if (scene == family_scenes().end()) return {-1, -1};
    const CapturedFrame frame = generate_family_scene(*scene, width, height, grey_profile());
    const TechniqueRequest request{technique,
                                   "",
                                   DERMIS_SOURCE_DIR "/" + dermis::shipped::graph_file("skin"),
                                   {{"technique", "\"" + technique + "\""}}};
    auto run = TechniqueRun::create(host, request, frame.description.profiles, {});
    EXPECT_TRUE(run) << run.error().text;
    if (!run) return {-1, -1};
    EXPECT_TRUE((*run)->scatter(frame));
    const auto choice = (*run)->choice();
    EXPECT_TRUE(choice);
    return {dermis::subsurface::mean_relief(make_reference_frame(frame).input()),
            choice ? double(choice->mean_relief) : -1};
  }
};

TEST_F(Relief, CountIsThatOfTheReference) {
  for (const char* name : {"zigzag_45_d6", "grooves_d4", "hair_d4", "bumps_d4", "strips_d4",
                           "sphere_d4", "pixels_step_2to1", "perspective_sphere_d2"}) {
    const auto [expected, counted] = relief_of(properties::shared_host(), name, "off");
    EXPECT_GE(expected, 0) << name;
    EXPECT_NEAR(counted, expected, 0.02 * expected + 5e-4) << name;
  }
}

TEST_F(Relief, FlatSurfacesHaveNone) {
  for (const char* name : {"plane_d4", "tilt_60_d2"}) {
    const auto [expected, counted] = relief_of(properties::shared_host(), name, "sap");
    EXPECT_NEAR(expected, 0, 1e-6) << name;
    EXPECT_NEAR(counted, 0, 1e-3) << name;
  }
}

} // namespace
