// Properties of the surface-aware pyramid on heads: always on the sculpted bust, and on a scanned
// head if DERMIS_HEAD names its folder or ../shared/data/head exists. Pictures have 640x360 pixels;
// DERMIS_TESTS_FULL adds 1280x720 to the error test, and to other tests of the view from the side.
// Without DERMIS_TESTS_FULL the scan only has the error test.
#include "tests/framegraph/test_scale.hpp"
#include "tests/properties/head_frames.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace {

using namespace dermis;
using namespace dermis::tools;
using subsurface::SapVariant;

struct FrameSize {
  uint32_t width, height;
};
std::vector<FrameSize> sizes() {
  if (dermis::testing::seeds_to_try(0, 1) == 0) return {{640, 360}};
  return {{640, 360}, {1280, 720}};
}

// Upper bounds. Errors are in thousandths; the numbers in `stated` are the project's acceptance
// numbers for the scan.
struct Bounds {
  double smooth[2], base[2];    // RMSE at 640x360 and 1280x720.
  double edge, edge_p99, inner; // Smooth variant, 640x360.
  // Ratios of the smooth variant to the plain pyramid and to 25 taps.
  double to_plain, to_separable;
  double sure;                   // Fraction of the whole picture's error in sure pixels.
  double unsure_min, unsure_max; // Fraction of pixels that are not sure.
};
// Stated for the scan: close, profile, whole.
constexpr Bounds stated[] = {{{8.1, 9.6}, {8.5, 10.3}, 17, 95, 7.0, 0.58, 0.92, 0.60, 0.55, 0.75},
                             {{8.3, 7.9}, {8.3, 8.0}, 23, 100, 3.5, 0.55, 0.85, 0.25, 0.25, 0.35},
                             {{7.9, 6.6}, {7.3, 5.6}, 10, 40, 6.5, 0.85, 0.95, 0.85, 0.05, 0.18}};
// Regression bounds of the present implementation; they do not state a required accuracy. The bust
// has no stated numbers: bounds are measured and increased by 15 % (99 % of edges: 20 %). The error
// of sure pixels is bounded by the number stated for the scan. From the side, where the bust shows
// a knot of folds (docs/limits.md), the bound is 0.175 of 32,768 pixels on two drivers (0.155 to
// 0.195 of fewer pixels) and 15 % more. Edges of the close framing: 5.1 and 18.1 since
// level 1 has two surfaces and mass counts area (4.0 and 10.1 before).
constexpr Bounds of_the_bust[] = {
    {{2.9, 3.05}, {3.3, 3.5}, 5.9, 21.8, 2.85, 0.5, 0.53, 0.60, 0.3, 0.5},
    {{5.3, 5.4}, {5.7, 5.9}, 15.4, 48.5, 3.15, 0.27, 0.79, 0.25, 0.15, 0.3},
    {{1.85, 1.88}, {1.85, 1.92}, 3.1, 14, 1.1, 0.21, 0.93, 0.5, 0.1, 0.25}};

// Regression bounds, too: ratios of two layers to one layer on the CPU implementation. The first
// bounds the whole picture's error where layers gain nothing; the other bounds errors at edges
// (measured 1.01 and 0.77, the scan from the side; 5 % more).
constexpr double worst_of_two_layers = 1.06, edge_of_two_layers = 0.81;
// Stated for sap_residual in static scenes: close, profile, whole.
constexpr double max_samples[] = {3, 1.6, 0.6};
constexpr double to_seed = 1.05; // Stated: relative to 32 samples of afis as published.

class OnAHead : public properties::HeadTest, public ::testing::WithParamInterface<size_t> {
protected:
  // `compared` 0 uses the number of pixels for which the framing's errors vary by at most 5 %.
  // Whole heads have few pixels of large error and a fast kernel, so all pixels are compared.
  void show(const FrameSize& size, uint32_t compared = 0) {
    const bool whole = GetParam() % 3 == 2;
    if (compared == 0) compared = whole ? size.width * size.height : 3072;
    HeadTest::show(properties::head_framings()[GetParam()], size.width, size.height, compared);
  }
  // Whether the test is skipped here. The quick run only uses the bust from the side, which has
  // most folds and edges.
  bool is_left_out() const {
    return !is_bust_profile() && dermis::testing::seeds_to_try(0, 1) == 0;
  }
  bool is_bust_profile() const {
    return properties::head_framings()[GetParam()].name == std::string_view("bust_profile");
  }
  // The view from the side, which has most folds and edges, is also tested at the larger size.
  std::vector<FrameSize> sizes_of_framing() const {
    return GetParam() % 3 == 1 ? sizes() : std::vector{sizes().front()};
  }
  bool is_scan() const { return properties::head_framings()[GetParam()].scan; }
  const Bounds& bounds() const {
    return is_scan() ? stated[GetParam()] : of_the_bust[GetParam() - 3];
  }
};

INSTANTIATE_TEST_SUITE_P(Framings, OnAHead,
                         ::testing::Range(size_t{0}, properties::head_framings().size()),
                         [](const auto& one) {
                           return std::string(properties::head_framings()[one.param].name);
                         });

TEST_P(OnAHead, ErrorIsBoundedAndMatchesTheCpu) {
  for (size_t i = 0; i < sizes().size(); ++i) {
    show(sizes()[i]);
    if (IsSkipped() || HasFatalFailure()) return;
    const std::vector<float> device = scatter("sap");
    const properties::HeadErrors smooth = errors_of(device),
                                 base = errors_of(scatter("sap", {{"variant", "base"}}));
    EXPECT_LE(smooth.rmse * 1e3, bounds().smooth[i]);
    EXPECT_LE(base.rmse * 1e3, bounds().base[i]);
    RecordProperty("smooth_" + std::to_string(sizes()[i].width), std::to_string(smooth.rmse * 1e3));
    double squares = 0;
    const std::vector<float> cpu = cpu_kernel(frame_, SapVariant::smooth).light;
    for (const uint32_t pixel : reference_.pixels)
      squares += std::pow(luminance_at(device, pixel) - luminance_at(cpu, pixel), 2);
    EXPECT_LE(std::sqrt(squares / double(reference_.pixels.size())),
              3e-3); // fp16 storage, and ties between seeds.
    if (i > 0) continue;
    RecordProperty("edge", std::to_string(smooth.edge * 1e3));
    RecordProperty("edge_p99", std::to_string(smooth.edge_p99 * 1e3));
    RecordProperty("inner", std::to_string(smooth.inner * 1e3));
    EXPECT_LE(smooth.edge * 1e3, bounds().edge);
    EXPECT_LE(smooth.edge_p99 * 1e3, bounds().edge_p99);
    EXPECT_LE(smooth.inner * 1e3, bounds().inner);
    const double plain = smooth.rmse / errors_of(scatter("pyramid")).rmse;
    const double separable = smooth.rmse / errors_of(scatter("separable", {{"taps", "25"}})).rmse;
    const double seed = smooth.rmse / errors_of(scatter("afis_seed", {{"samples", "32"}})).rmse;
    RecordProperty("to_plain", std::to_string(plain));
    RecordProperty("to_separable", std::to_string(separable));
    EXPECT_LE(plain, bounds().to_plain);
    EXPECT_LE(separable, bounds().to_separable);
    EXPECT_LE(seed, to_seed);
  }
}

TEST_P(OnAHead, TwoLayers_ReduceEdgeErrorsAndMatchTheCpu) {
  if (is_left_out()) GTEST_SKIP() << "of this framing, with DERMIS_TESTS_FULL";
  const std::vector<FrameSize> sizes = sizes_of_framing();
  for (size_t i = 0; i < sizes.size(); ++i) {
    show(sizes[i]);
    if (IsSkipped() || HasFatalFailure()) return;
    const std::vector<float> device = scatter("sap"),
                             cpu = cpu_kernel(frame_, SapVariant::smooth).light;
    const properties::HeadErrors two = errors_of(device),
                                 one = errors_of(cpu_kernel(frame_, SapVariant::smooth,
                                                            dermis::subsurface::sap_level_count)
                                                     .light);
    double squares = 0;
    for (const uint32_t pixel : reference_.pixels)
      squares += std::pow(luminance_at(device, pixel) - luminance_at(cpu, pixel), 2);
    // Equal to the result with one layer.
    EXPECT_LE(std::sqrt(squares / double(reference_.pixels.size())), 3e-3);
    RecordProperty("rmse_" + std::to_string(sizes[i].width), std::to_string(two.rmse * 1e3));
    RecordProperty("edge_" + std::to_string(sizes[i].width), std::to_string(two.edge * 1e3));
    RecordProperty("one_" + std::to_string(sizes[i].width), std::to_string(one.rmse * 1e3));
    RecordProperty("edge_to_one_" + std::to_string(sizes[i].width),
                   std::to_string(two.edge / one.edge));
    EXPECT_LE(two.rmse, one.rmse * worst_of_two_layers);
    if (GetParam() % 3 != 1) continue; // Heads show surfaces behind each other from the side.
    EXPECT_LE(two.edge, one.edge * edge_of_two_layers);
    if (i > 0) continue;
    const double separable = two.rmse / errors_of(scatter("separable", {{"taps", "25"}})).rmse;
    RecordProperty("to_separable", std::to_string(separable));
    EXPECT_LE(separable, stated[1].to_separable);
  }
}

TEST_P(OnAHead, FlatLightIsExact_OtherLightStaysInRange) {
  if (is_left_out()) GTEST_SKIP() << "of this framing, with DERMIS_TESTS_FULL";
  show(sizes().front(), 1); // The test needs no reference.
  if (IsSkipped() || HasFatalFailure()) return;
  float minimum = 1e9f, maximum = 0;
  for (size_t i = 0; i < frame_.profile.size(); ++i)
    for (size_t c = 0; c < 3 && frame_.profile[i] != 0; ++c) {
      minimum = std::min(minimum, frame_.lighting.values[3 * i + c]);
      maximum = std::max(maximum, frame_.lighting.values[3 * i + c]);
    }
  const std::vector<float> light = scatter("sap");
  std::fill(frame_.lighting.values.begin(), frame_.lighting.values.end(), 1.0f);
  const std::vector<float> flat = scatter("sap");
  for (size_t i = 0; i < frame_.profile.size(); ++i)
    for (size_t c = 0; c < 3 && frame_.profile[i] != 0; ++c) {
      // Light is stored in half floats, so it may exceed the brightest light by 2^-11 of its value.
      ASSERT_TRUE(light[3 * i + c] >= minimum * 0.999f && light[3 * i + c] <= maximum * 1.0005f)
          << i;
      // A mean of ones is 1 within fp32 rounding, and the nearest half float is 1.
      ASSERT_EQ(flat[3 * i + c], 1.0f) << i;
    }
}

TEST_P(OnAHead, ConfidenceFindsExactPixels) {
  if (is_left_out()) GTEST_SKIP() << "of this framing, with DERMIS_TESTS_FULL";
  for (const FrameSize& size : sizes_of_framing()) {
    show(size);
    if (IsSkipped() || HasFatalFailure()) return;
    const subsurface::SapResult<float> result = cpu_kernel(frame_, SapVariant::smooth);
    const properties::HeadErrors errors = errors_of(result.light, &result.confidence);
    RecordProperty("sure_to_all", std::to_string(errors.sure / errors.rmse));
    RecordProperty("unsure_pixels", std::to_string(errors.unsure_pixels));
    EXPECT_LE(errors.sure, bounds().sure * errors.rmse);
    EXPECT_GE(errors.unsure_pixels, bounds().unsure_min);
    // Fractions are stated at 640x360. At twice the size, folds of a pixel become visible: 0.277 of
    // the whole scan.
    EXPECT_LE(errors.unsure_pixels, bounds().unsure_max * (size.width > 640 ? 1.6 : 1.0));
  }
}

TEST_P(OnAHead, StaticScene_SamplesRefineIt) {
  if (is_left_out()) GTEST_SKIP() << "of this framing, with DERMIS_TESTS_FULL";
  show(sizes().front());
  if (IsSkipped() || HasFatalFailure()) return;
  double samples = 0;
  const double sap = errors_of(scatter("sap")).rmse;
  // A multiple of 16.
  const double refined = errors_of(scatter("sap_residual", {}, 48, &samples)).rmse;
  const double gain_db = 20 * std::log10(sap / refined);
  RecordProperty("gain_db", std::to_string(gain_db));
  RecordProperty("samples", std::to_string(samples));
  // Regression bounds: measured at least 4.8 dB, and 1.1 and 1.9 dB of whole heads, where d is
  // below a pixel and ratios of neighbours differ as noise does.
  EXPECT_GE(gain_db, GetParam() % 3 == 2 ? 1.1 : 2.5);
  if (is_scan()) {
    EXPECT_LE(samples, max_samples[GetParam()]);
  }
}

TEST_P(OnAHead, WholePixelMotion_HardlyChangesThePicture) {
  if (is_left_out()) GTEST_SKIP() << "of this framing, with DERMIS_TESTS_FULL";
  show(sizes().front(), 1); // The test needs no reference.
  if (IsSkipped() || HasFatalFailure()) return;
  // The pyramid's grid moves against the surface: the picture is repeated without its first rows
  // and columns.
  constexpr uint32_t shifts[][2] = {{0, 0}, {1, 0}, {2, 1}, {3, 5}, {4, 2}, {5, 7}, {6, 3}, {7, 6}};
  constexpr uint32_t maximum = 8, margin = 48; // Pixels; the pixels at the border change, too.
  for (const auto& [variant, bound] :
       {std::pair{SapVariant::smooth, 2.4e-3}, {SapVariant::base, 4.5e-3}}) {
    std::vector<double> sum(frame_.profile.size()), squares(frame_.profile.size());
    for (const auto& [x0, y0] : shifts) {
      CapturedFrame part = frame_;
      part.description.render = {x0, y0, frame_.description.width - maximum,
                                 frame_.description.height - maximum};
      // Adjusts the rays to the rectangle's corner.
      part.rays.offset_x += part.rays.scale_x * x0;
      part.rays.offset_y += part.rays.scale_y * y0;
      const std::vector<float> light = cpu_kernel(part, variant).light;
      const uint32_t width = part.description.render.width, height = part.description.render.height;
      for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
          const double value = luminance_at(light, size_t{y} * width + x);
          const size_t i = size_t{y + y0} * frame_.description.width + x + x0;
          sum[i] += value;
          squares[i] += value * value;
        }
    }
    double variance = 0, count = 0;
    for (uint32_t y = margin; y + margin < frame_.description.height; ++y)
      for (uint32_t x = margin; x + margin < frame_.description.width; ++x) {
        const size_t i = size_t{y} * frame_.description.width + x;
        if (frame_.profile[i] == 0) continue;
        const double mean = sum[i] / 8;
        variance += std::max(0.0, squares[i] / 8 - mean * mean);
        ++count;
      }
    RecordProperty(variant == SapVariant::smooth ? "smooth" : "base",
                   std::to_string(std::sqrt(variance / count)));
    EXPECT_LE(std::sqrt(variance / count), bound);
  }
}

} // namespace
