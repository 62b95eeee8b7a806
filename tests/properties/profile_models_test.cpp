// Every technique reproduces any profile model, compared with the reference on a plane.
#include "tests/properties/plane.hpp"

#include "passes/common/profiles/profile.hpp"
#include "passes/common/reference/reference.hpp"

#include <cmath>

namespace {

using namespace properties;
namespace sss = dermis::subsurface;

struct Case {
  const char* name;
  const char* graph;
  Settings settings;
  const char* profile; // In configs/profiles.
  double rmse;         // Maximum over the channels, for light in 0..1.
};

void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

sss::Profile read(const std::string& path) {
  dermis::Diagnostics diagnostics;
  const auto document = dermis::read_document(path, diagnostics);
  return document ? sss::read_profile(*document, diagnostics).value_or(sss::Profile{})
                  : sss::Profile{};
}

// Discs of many sizes over a step: all frequencies in a small picture.
float discs(double x, double y) {
  float value = x < 80 ? 0.1f : 0.7f;
  const double at[4][3] = {{40, 30, 14}, {75, 70, 9}, {120, 35, 22}, {110, 80, 4}};
  for (const auto& disc : at)
    if (std::hypot(x - disc[0], y - disc[1]) < disc[2]) value = 1.0f - value;
  return value;
}

class EveryModel : public DeviceTest, public ::testing::WithParamInterface<Case> {};

TEST_P(EveryModel, IsReproducedWithinTheTechniquesError) {
  const Case& one = GetParam();
  const sss::Profile profile =
      read(std::string(DERMIS_SOURCE_DIR "/configs/profiles/") + one.profile + ".json");
  ASSERT_GT(profile.d_mm[0], 0);
  Plane plane{.width = 160, .height = 96};
  plane.light = discs;
  plane.pixel_pitch_m = profile.d_mm[static_cast<size_t>(profile.widest)] * 1e-3 / 3; // d = 3 px
  plane.profile_file =
      R"({"dermis_profile": 1, "name": "p", "source": "t", )" + profile_members(profile) + "}";
  const Picture picture = run(one.graph, plane, one.settings);

  const size_t pixels = size_t{plane.width} * plane.height;
  std::vector<float> light;
  for (size_t i = 0; i < pixels; ++i)
    light.insert(light.end(), 3, discs(double(i % plane.width), double(i / plane.width)));
  const std::vector<float> depth(pixels, 1.0f);
  const std::vector<uint8_t> id(pixels, 1);
  std::vector<sss::PerChannel> d_m(2);
  std::vector<sss::ProfileShape> shapes(2);
  for (size_t c = 0; c < 3; ++c) {
    shapes[1][c] = sss::scaled(profile.shape_mm[c], 1e-3);
    d_m[1][c] = shapes[1][c].d;
  }
  const sss::ReferenceInput input{
      .width = plane.width,
      .height = plane.height,
      .rays = sss::orthographic_rays(plane.width, plane.height, plane.pixel_pitch_m),
      .light = light,
      .depth = depth,
      .profile = id,
      .scatter_scale = {},
      .d_m = d_m,
      .shapes = shapes};
  const auto reference = sss::reference_everywhere(input);
  ASSERT_EQ(picture.rgb.size(), reference.size());
  double moved = 0;
  for (size_t c = 0; c < 3; ++c) {
    double squares = 0;
    for (size_t i = c; i < reference.size(); i += 3) {
      squares += (picture.rgb[i] - reference[i]) * (picture.rgb[i] - reference[i]) / double(pixels);
      moved += (light[i] - reference[i]) * (light[i] - reference[i]) / double(pixels);
    }
    const double rmse = std::sqrt(squares);
    RecordProperty(c == 0 ? "rmse_red" : c == 1 ? "rmse_green" : "rmse_blue", std::to_string(rmse));
    EXPECT_LE(rmse, one.rmse) << "channel " << c;
  }
  EXPECT_GT(std::sqrt(moved), 0.05); // Scattering has to change the picture enough.
}

const Settings many = {{"samples", "256"}};
INSTANTIATE_TEST_SUITE_P(
    Properties, EveryModel,
    ::testing::Values(Case{"burley_dipole", "burley", many, "skin_dipole", 0.01},
                      Case{"burley_artist", "burley", many, "skin_artist", 0.01},
                      Case{"fixed_dipole", "fixed", many, "skin_dipole", 0.01},
                      Case{"fixed_artist", "fixed", many, "skin_artist", 0.01},
                      Case{"sap_dipole", "sap", {}, "skin_dipole", 0.003},
                      Case{"sap_marble_dipole", "sap", {}, "marble_dipole", 0.003},
                      Case{"sap_artist", "sap", {}, "skin_artist", 0.003},
                      Case{"pyramid_skin", "pyramid", {}, "skin", 0.002},
                      Case{"pyramid_dipole", "pyramid", {}, "skin_dipole", 0.002},
                      Case{"pyramid_artist", "pyramid", {}, "skin_artist", 0.002},
                      Case{"separable_dipole", "separable", {}, "skin_dipole", 0.01},
                      Case{"separable_artist", "separable", {}, "skin_artist", 0.01},
                      Case{"jimenez_artist", "separable_jimenez", {}, "skin_artist", 0.022}),
    [](const auto& one) { return std::string(one.param.name); });

} // namespace
