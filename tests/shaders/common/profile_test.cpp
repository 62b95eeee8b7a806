// Compares the profiles that kernels evaluate on a device with the fp64 shapes of the references.
#include "passes/common/environment.hpp"
#include "passes/common/profiles/profile.hpp"
#include "tests/shaders/common/kernel_fixture.hpp"

#include "test_profile.spv.h"

#include <cmath>
#include <numbers>

namespace dermis::subsurface {
namespace {

// `rows` is the number per profile.
constexpr uint32_t width = 208, rows = 3;
constexpr const char* files[] = {"skin", "skin_dipole", "skin_artist"}; // In configs/profiles.
constexpr uint32_t height = rows * uint32_t(std::size(files));

// Returns the radius that test_profile.comp uses.
double radius_in_d(uint32_t x) {
  return std::exp2(x / 16.0 - 8);
}
double requested_survival(uint32_t x) {
  return std::exp2(-(x / 16.0));
}

class ProfileKernel : public dermis::testing::KernelTest {
protected:
  void SetUp() override {
    KernelTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    for (uint32_t i = 0; i < std::size(files); ++i) {
      Diagnostics diagnostics;
      const auto document = read_document(
          DERMIS_SOURCE_DIR "/configs/profiles/" + std::string(files[i]) + ".json", diagnostics);
      ASSERT_TRUE(document) << files[i];
      const auto profile = read_profile(*document, diagnostics);
      ASSERT_TRUE(profile) << files[i];
      profiles.push_back({i + 1, *profile});
    }
    const std::vector<ProfileEntry> entries = make_profile_table(profiles, false);
    const std::vector<RadialRow> radial = make_radial_table(profiles);
    values = answers_of({"test_profile", test_profile_spirv}, width, height,
                        {std::as_bytes(std::span(entries)), std::as_bytes(std::span(radial))});
  }

  double at(size_t profile, uint32_t row, uint32_t x, size_t channel) const {
    return double(values[4 * ((profile * rows + row) * width + x) + channel]);
  }

  std::vector<NumberedProfile> profiles;
  std::vector<float> values;
};

TEST_F(ProfileKernel, DensityAndCdfMatchTheShapes) {
  ASSERT_FALSE(values.empty());
  for (size_t i = 0; i < profiles.size(); ++i) {
    const Profile& profile = profiles[i].profile;
    const double d = profile.d_mm[static_cast<size_t>(profile.widest)];
    for (uint32_t x = 0; x < width; ++x)
      for (size_t c = 0; c < 3; ++c) {
        const double r = radius_in_d(x) * d, R = at(i, 0, x, c) / (2 * std::numbers::pi);
        const double reference = shape_R(profile.shape_mm[c], r),
                     maximum = shape_R(profile.shape_mm[c], d / 256);
        // Tables are linear in log R over 1/24 octave; far out the error is relative to the largest
        // value.
        EXPECT_NEAR(R, reference, 4e-3 * reference + 1e-9 * maximum)
            << files[i] << " R at " << r << " mm, channel " << c;
        EXPECT_NEAR(2 * std::numbers::pi * r * R, shape_pdf(profile.shape_mm[c], r),
                    4e-3 * shape_pdf(profile.shape_mm[c], r) + 1e-8 / d)
            << files[i] << " pdf at " << r << " mm, channel " << c;
        EXPECT_NEAR(1 - at(i, 1, x, c), shape_cdf(profile.shape_mm[c], r), 2e-4)
            << files[i] << " cdf at " << r << " mm, channel " << c;
      }
  }
}

TEST_F(ProfileKernel, InversesInvertTheCdf) {
  ASSERT_FALSE(values.empty());
  for (size_t i = 0; i < profiles.size(); ++i) {
    const Profile& profile = profiles[i].profile;
    const ChannelShape& shape = profile.shape_mm[static_cast<size_t>(profile.widest)];
    const bool burley =
        // Burley: a polynomial within 0.52 %, and exact weights. Tables: within a thousandth of d.
        i == 0;
    for (uint32_t x = 1; x < width; ++x) {
      const double r = at(i, 2, x, 0),
                   reference = shape_inverse_survival(shape, requested_survival(x));
      EXPECT_NEAR(r, reference, (burley ? 5.2e-3 * reference : 0) + 1e-3 * shape.d)
          << files[i] << " " << requested_survival(x);
      // The density is the sampler's own density, within a few percent of the profile.
      EXPECT_NEAR(at(i, 2, x, 1) / shape_pdf(shape, r), 1, 0.05)
          << files[i] << " " << requested_survival(x);
    }
  }
}

} // namespace
} // namespace dermis::subsurface
