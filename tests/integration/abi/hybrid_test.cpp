// Tests samples per tile: the device allocates them like the rule on the CPU, and follows the
// host's importance.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "passes/choice/sample_allocation.hpp"
#include "passes/choice/time_margin.hpp"
#include "passes/separable/separable_kernel.hpp"
#include "tests/integration/abi/dermis_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

namespace dermis::abi_test {
namespace {

constexpr uint32_t side = 64, tiles_across = side / 8;

// A unit of samples costs 1 us, all other work nothing.
constexpr const char* unit_times = R"({ "dermis_calibration": 2, "device": "invented", "costs": [
  { "work": "subsurface.tile_refine lod_bias=-1.5 below=0.93 sample_weight=0.05", "base_us": 0, "group_us": 1, "spread": 0 },
  { "work": "subsurface.classify texturing=post", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.classify_uniform_light", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_tiles", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_setup texturing=post storage=half", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_down level=1 storage=half", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_up level=1 variant=smooth storage=half", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_down level=2 storage=half", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_up level=2 variant=smooth storage=half", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_coarse_down level=5 storage=half", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_coarse_up level=4 variant=smooth storage=half", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "clear", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_gather variant=smooth storage=half", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.tile_error_estimate below=0.93", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sample_demand", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.allocate_samples", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.probe texturing=post tiles=8 interval=4", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.export_scattered texturing=post", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.combine texturing=post result=color", "base_us": 0, "group_us": 0, "spread": 0 } ] })";

// The test sets the tile errors, and tiles with samples show the test's picture.
constexpr const char* painted = R"({ "dermis_overlay": 2, "edits": [
  { "set": "/imports/painted", "to": { "format": "rgba16f", "size": "view" } },
  { "set": "/passes/estimate_tile_error/read/scattered", "to": "painted" },
  { "remove": "/passes/estimate_tile_error/read/light" },
  { "set": "/passes/estimate_tile_error/set/below", "to": 1 },
  { "set": "/passes/combine/read/scattered", "to": "painted" },
  { "set": "/passes/combine/read/tiles", "to": "sampled_tiles" },
  { "set": "/passes/combine/read/arguments", "to": "sampled_arguments" } ] })";

struct Hybrid : DermisTest {
  dermis_graph graph = nullptr;

  demo::ReportedFrame run_frame() { return DermisTest::run_frame(graph); }

  void set_units(uint32_t units) {
    const dermis_source calibration = source_of(times, "invented");
    dermis_budget budget = budget_of((static_cast<float>(units) + 0.5f) / 1000 *
                                         std::exp(static_cast<float>(choice::calibrated_margin)),
                                     DERMIS_BUDGET_DETERMINISTIC);
    budget.calibration = &calibration;
    ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
  }

  const char* file = "configs/graphs/papers/hybrid.json";
  std::string times = unit_times;
  std::vector<std::string> overlays;

  // A stepped surface, for which the pyramid has low confidence.
  virtual void make_hybrid() {
    GraphOptions options = shipped_options(file);
    options.overlays = overlays;
    graph = make_bound_graph(options);
    paint();
    fill("importance", [](uint32_t, uint32_t) { return 1.0f; });
  }
  virtual void paint() {
    fill("depth",
         [](uint32_t x, uint32_t y) { return 0.5f + 0.002f * float((x / 3 * 7 + y / 5 * 3) % 4); });
    fill("lighting", [](uint32_t x, uint32_t y) { return float((x * 37 + y * 61) % 97) / 64.0f; });
  }

  // Returns the picture of a second frame, which knows the sample demand. Each is the second frame
  // of a new graph, because samples continue from frame to frame. Right of `matters` pixels, errors
  // count 0.01.
  std::vector<float> picture(uint32_t units, uint32_t matters = side) {
    last_frame = 0;
    make_hybrid();
    fill("importance", [&](uint32_t x, uint32_t) { return x < matters ? 1.0f : 0.01f; });
    set_units(units);
    for (int i = 0; i < 2; ++i) {
      paint();
      reported = run_frame();
    }
    return texels("lighting");
  }
  demo::ReportedFrame reported;
};

TEST_F(Hybrid, DeviceAllocatesSamplesLikeTheCpu) {
  GraphOptions options = shipped_options("configs/graphs/papers/hybrid.json");
  options.overlays = {painted};
  // Exporting the light keeps the samples alive.
  options.unbound = {"albedo", "scatter_scale", "importance"};
  graph = make_bound_graph(options);
  paint();
  // In units of 1/1024; a half float holds 1 - unmet / 1024 exactly.
  const auto unmet = [](uint32_t x, uint32_t y) {
    const uint32_t tile = y / 8 * tiles_across + x / 8;
    return tile % 5 == 0 ? 0u : tile * 2654435761u % 509;
  };
  std::vector<uint32_t> tile_errors(tiles_across * tiles_across, 0);
  std::vector<float> values;
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) {
      tile_errors[y / 8 * tiles_across + x / 8] += unmet(x, y);
      values.insert(values.end(), {1, 1, 1, 1.0f - float(unmet(x, y)) / 1024});
    }
  upload("painted", values);
  const uint32_t demand = choice::allocate_samples(tile_errors, {}, UINT32_MAX).demand;
  std::vector<uint32_t> before;
  for (const uint32_t units : {demand, demand / 2, demand / 3, 7u, 1u, 0u}) {
    fill("lighting", [](uint32_t x, uint32_t) { return x % 2 == 0 ? 0.25f : 0.5f; }); // Not flat.
    set_units(units);
    const demo::ReportedFrame choice = run_frame();
    const choice::SampleAllocation expected = choice::allocate_samples(tile_errors, before, units);
    EXPECT_EQ(choice.sample_demand, demand);
    EXPECT_EQ(choice.sample_units, expected.units);
    const auto light = texels("lighting");
    std::array<uint32_t, 4> counts{};
    for (uint32_t tile = 0; tile < tile_errors.size(); ++tile) {
      ++counts[expected.steps[tile]];
      const size_t pixel = size_t{tile / tiles_across * 8} * side + tile % tiles_across * 8;
      EXPECT_EQ(light[4 * pixel] == 1.0f, expected.steps[tile] > 0)
          << "tile " << tile << ", " << units << " units";
    }
    for (size_t k = 0; k < 3; ++k)
      EXPECT_EQ(choice.sampled_tiles[k], counts[k + 1]) << units;
    before = expected.steps;
  }
}

TEST_F(Hybrid, NoUnits_ShowThePyramid) {
  const auto none = picture(0);
  const auto all = picture(100000);
  EXPECT_NE(none, all);
  GraphOptions options = shipped_options("configs/graphs/sap.json");
  options.unbound = {"albedo", "scatter_scale", "scattered_light", "thickness", "back_lighting"};
  graph = make_bound_graph(options);
  paint();
  dermis_frame one = bound_frame(graph);
  ASSERT_OK(record(graph, one));
  EXPECT_EQ(texels("lighting"), none);
}

// Returns the root mean square of the difference over columns first .. last - 1.
double rms(const std::vector<float>& a, const std::vector<float>& b, uint32_t first,
           uint32_t last) {
  double sum = 0;
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = first; x < last; ++x)
      for (uint32_t c = 0; c < 3; ++c) {
        const size_t i = 4 * (size_t{y} * side + x) + c;
        sum += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
      }
  return std::sqrt(sum / (3.0 * side * (last - first)));
}

double rms_of_row(std::span<const float> a, std::span<const float> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i)
    sum += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
  return std::sqrt(sum / double(a.size()));
}

TEST_F(Hybrid, HalfBudget_ImportantTilesKeepTheirSamples) {
  const auto none = picture(0);
  const auto all = picture(100000);
  const demo::ReportedFrame choice = reported;
  ASSERT_GT(choice.sample_demand, 0u);
  // The remaining tiles request less than half of all samples.
  constexpr uint32_t matters = 3 * side / 8;
  const auto half = picture(choice.sample_demand / 2, matters);
  // All important tiles have the samples of the full budget, so their picture is equal. The column
  // of tiles whose samples fade towards tiles without samples is excluded.
  EXPECT_EQ(rms(half, all, 0, matters - 8), 0);
  EXPECT_GT(rms(half, all, matters + 8, side), 0.2 * rms(none, all, matters + 8, side));
}

TEST_F(Hybrid, TilesUnchangedByScattering_GetNoSamples) {
  const auto sampled = [&] {
    last_frame = 0;
    make_hybrid();
    fill("lighting", [](uint32_t x, uint32_t y) {
      if (x < 48) return x % 16 == 0 && y % 16 == 0 ? 0.505f : 0.5f; // Not flat, but almost.
      return float((x * 37 + y * 61) % 97) / 64.0f;
    });
    set_units(100000);
    const demo::ReportedFrame choice = run_frame();
    return choice.sampled_tiles[0] + choice.sampled_tiles[1] + choice.sampled_tiles[2];
  };
  const uint32_t some = sampled();
  overlays = {
      R"({ "dermis_overlay": 2, "edits": [ { "remove": "/passes/estimate_tile_error/read/light" } ] })"};
  const uint32_t all = sampled();
  EXPECT_EQ(all, 64u); // The pyramid's confidence is equal on the left and on the right.
  EXPECT_GE(some, 16u);
  EXPECT_LE(some, 48u); // Includes the tiles next to the border.
}

// Returns the energy of the rows' differences at frequency k of 64.
double energy(const std::vector<float>& a, const std::vector<float>& b, uint32_t k) {
  constexpr double two_pi = 6.283185307179586;
  double sum = 0;
  for (uint32_t y = 0; y < side; ++y) {
    double re = 0, im = 0;
    for (uint32_t x = 0; x < side; ++x) {
      const size_t i = 4 * (size_t{y} * side + x) + 1;
      const double difference = double(a[i]) - b[i];
      re += difference * std::cos(two_pi * k * x / side);
      im += difference * std::sin(two_pi * k * x / side);
    }
    sum += re * re + im * im;
  }
  return sum;
}

// Compares a picture with a third of the samples with pictures with no samples and with all
// samples.
void expect_no_seams(const std::vector<float>& none, const std::vector<float>& all,
                     const std::vector<float>& half) {
  for (const auto* pure : {&none, &all})
    for (const uint32_t harmonic : {8u, 16u, 24u}) {
      std::vector<double> neighbours;
      for (int k = -3; k <= 3; ++k)
        if (k != 0) neighbours.push_back(energy(half, *pure, harmonic + static_cast<uint32_t>(k)));
      std::sort(neighbours.begin(), neighbours.end());
      EXPECT_LE(energy(half, *pure, harmonic), 2 * 0.5 * (neighbours[2] + neighbours[3]))
          << harmonic;
    }
}

// Returns light without a period, which varies more in some places than in others.
float uneven_light(uint32_t x, uint32_t y) {
  uint32_t h = (x * 0x9e3779b9u) ^ (y * 0x85ebca6bu);
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  const float unit = float(h >> 16 & 255) / 256; // Exact in a half float.
  return 0.5f + (unit - 0.5f) * std::abs(std::sin(0.09f * float(x) + 0.07f * float(y)));
}
struct UnevenHybrid : Hybrid {
  void paint() override {
    Hybrid::paint();
    fill("lighting", uneven_light);
  }
};

TEST_F(UnevenHybrid, TilesLeaveNoSeams) {
  const auto none = picture(0), all = picture(100000);
  const demo::ReportedFrame choice = reported;
  expect_no_seams(none, all, picture(choice.sample_demand / 3));
}

TEST_F(Hybrid, PartialBudget_BuysSamplesAndReportsTheError) {
  file = "configs/graphs/skin.json";
  overlays = {R"({ "dermis_overlay": 2, "edits": [
      { "set": "/settings/probe/default", "to": "off" } ] })"}; // Errors are those of the table.
  times.insert(times.rfind("] }"), R"(, { "work": "subsurface.guided", "base_us": 1e9,
      "group_us": 0, "spread": 0 } )");                         // AFIS exceeds each budget.
  const auto run = [&](uint32_t units) {
    picture(units);
    return reported;
  };
  const demo::ReportedFrame all = run(100000);
  EXPECT_THAT(all.configuration, HasSubstr("technique=hybrid"));
  ASSERT_GT(all.sample_demand, 100u);
  const demo::ReportedFrame some = run(all.sample_demand / 2);
  EXPECT_THAT(some.configuration, HasSubstr("technique=hybrid"));
  EXPECT_EQ(some.sample_units, all.sample_demand / 2);
  const demo::ReportedFrame few = run(all.sample_demand / 8);
  EXPECT_GT(few.predicted_rmse, some.predicted_rmse);
  EXPECT_GT(some.predicted_rmse, all.predicted_rmse);
}

// The papers' pair: filtered importance sampling where light varies, separable elsewhere.
struct Pair : Hybrid {
  std::string history = "off", taps = "25";
  bool has_scale = false;

  Pair() {
    file = "configs/graphs/papers/hybrid_afis_separable.json";
    times = R"({ "dermis_calibration": 2, "device": "invented", "costs": [
      { "work": "subsurface.allocate_samples", "base_us": 0, "group_us": 0, "spread": 0 },
      { "work": "subsurface.guided", "base_us": 0, "group_us": 1, "spread": 0 },
      { "work": "subsurface.afis_tiles samples=64", "base_us": 0, "group_us": 1, "spread": 0 } ] })";
    for (const char* kind :
         {"classify", "tile_list", "setup", "separable_setup", "separable_tiles", "separable",
          "tile_variance", "sample_demand", "pyramid_setup", "pyramid_down", "blend_tiles",
          "accumulate", "export_scattered", "combine"})
      times.insert(times.rfind("] }"), std::string(", { \"work\": \"subsurface.") + kind +
                                           "\", \"base_us\": 0, \"group_us\": 0, \"spread\": 0 } ");
  }

  void make_hybrid() override {
    GraphOptions options = shipped_options(file);
    options.overlays = overlays;
    if (has_scale) std::erase(options.unbound, "scatter_scale");
    graph = make_graph(options);
    ASSERT_OK(dermis_graph_set_setting(graph, "history", ('"' + history + '"').c_str(), nullptr));
    ASSERT_OK(dermis_graph_set_setting(graph, "taps", ('"' + taps + '"').c_str(), nullptr));
    make_images(graph);
    paint();
    fill("importance", [](uint32_t, uint32_t) { return 1.0f; });
    if (has_scale) fill("scatter_scale", [](uint32_t, uint32_t) { return 1.0f; });
  }

  // Returns the first frame with samples only in the tiles that `matters`.
  using Tiles = std::function<bool(uint32_t x, uint32_t y)>;
  std::vector<float> first_picture(const Tiles& matters) {
    last_frame = 0;
    make_hybrid();
    fill("importance", [&](uint32_t x, uint32_t y) { return matters(x / 8, y / 8) ? 1.0f : 0.0f; });
    reported = run_frame();
    return texels("lighting");
  }

  // Returns whether a tile is in a list of the graph, by tile.
  std::vector<bool> listed(const std::string& list, const Tiles& matters) {
    overlays = {R"({ "dermis_overlay": 2, "edits": [
      { "set": "/imports/painted", "to": { "format": "rgba16f", "size": "view" } },
      { "set": "/passes/combine/read/scattered", "to": "painted" },
      { "set": "/passes/combine/read/tiles", "to": ")" +
                list + R"(_tiles" },
      { "set": "/passes/combine/read/arguments", "to": ")" +
                list + R"(_arguments" } ] })"};
    last_frame = 0;
    make_hybrid();
    fill("importance", [&](uint32_t x, uint32_t y) { return matters(x / 8, y / 8) ? 1.0f : 0.0f; });
    constexpr float shown = 3; // more than any light
    fill("painted", [](uint32_t, uint32_t) { return shown; });
    run_frame();
    overlays.clear();
    const auto light = texels("lighting");
    std::vector<bool> tiles;
    for (uint32_t tile = 0; tile < tiles_across * tiles_across; ++tile)
      tiles.push_back(
          light[4 * (size_t{tile / tiles_across * 8} * side + tile % tiles_across * 8)] == shown);
    return tiles;
  }
};

struct UnevenPair : Pair {
  void paint() override {
    Pair::paint();
    fill("lighting", uneven_light);
  }
};

TEST_F(Pair, NoUnits_ShowSeparable) {
  const auto none = picture(0);
  EXPECT_EQ(reported.sample_units, 0u);
  const auto all = picture(100000);
  EXPECT_NE(none, all);
  EXPECT_EQ(reported.sample_units, reported.sample_demand);
  GraphOptions options = shipped_options("configs/graphs/separable.json");
  options.unbound = {"albedo", "scatter_scale", "scattered_light"};
  graph = make_graph(options);
  ASSERT_OK(dermis_graph_set_setting(graph, "taps", "\"25\"", nullptr));
  make_images(graph);
  paint();
  DermisTest::run_frame(graph);
  EXPECT_EQ(texels("lighting"), none);
}

TEST_F(Pair, RuleOfATileSeesTheReachOfD) {
  has_scale = true;
  const auto sampled = [&](float scale, float slope) { // d = 2.1 px at scale 1
    make_hybrid();
    fill("depth", [&](uint32_t x, uint32_t) { return 0.5f + slope * float(pitch_m) * float(x); });
    fill("lighting", [](uint32_t x, uint32_t y) {
      return x < 32 ? 0.5f : float((x * 37 + y * 61) % 97) / 64.0f;
    });
    fill("scatter_scale", [&](uint32_t, uint32_t) { return scale; });
    const demo::ReportedFrame choice = run_frame();
    EXPECT_EQ(choice.sample_demand, 4 * choice.sampled_tiles[2]);
    return choice.sampled_tiles[2];
  };
  EXPECT_EQ(sampled(0.25f, 1), 32u); // The tiles whose own light varies.
  EXPECT_EQ(sampled(1, 1), 40u);     // And the column of tiles next to them.
  EXPECT_EQ(sampled(4, 1), 64u);     // Light reaches all tiles.
  // Separable has less error than samples if d is small and the surface faces the viewer.
  EXPECT_EQ(sampled(0.25f, 0), 0u);
  EXPECT_EQ(sampled(1, 0), 40u);
}

// Half of the tiles, or all but two.
const std::pair<const char*, Pair::Tiles> sampled_patterns[] = {
    {"half", [](uint32_t, uint32_t y) { return y >= 4; }},
    {"but two", [](uint32_t x, uint32_t y) { return !(x == 1 && y == 1) && !(x == 6 && y == 0); }},
    {"all", [](uint32_t, uint32_t) { return true; }},
    {"none", [](uint32_t, uint32_t) { return false; }},
};

TEST_F(Pair, SeparableRunsOnlyInReachOfTilesWithoutSamples) {
  taps = "11"; // With d = 2.1 px, the kernel reads at most 15 pixels to a side.
  const auto reach = static_cast<int>((subsurface::separable_reach_px(2.1, 11) + 7) / 8);
  ASSERT_EQ(reach, 2);
  const int last = tiles_across - 1;
  for (const auto& [name, matters] : sampled_patterns) {
    std::vector<bool> sampled, vertical, horizontal;
    const auto none_near = [&, &matters = matters](int x, int y) {
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, last); ++j)
        for (int i = std::max(x - 1, 0); i <= std::min(x + 1, last); ++i)
          if (!matters(uint32_t(i), uint32_t(j))) return false;
      return true;
    };
    for (int y = 0; y <= last; ++y)
      for (int x = 0; x <= last; ++x) {
        sampled.push_back(matters(uint32_t(x), uint32_t(y)));
        vertical.push_back(!none_near(x, y));
        bool read = false;
        for (int j = std::max(y - reach, 0); j <= std::min(y + reach, last); ++j)
          read = read || !none_near(x, j);
        horizontal.push_back(read);
      }
    EXPECT_EQ(listed("sampled", matters), sampled) << name;
    EXPECT_EQ(listed("vertical", matters), vertical) << name;
    EXPECT_EQ(listed("horizontal", matters), horizontal) << name;
  }
}

TEST_F(Pair, TilesWithSamples_HaveLightOfOnlySamples) {
  for (const char* how : {"off", "velocity"}) {
    history = how;
    const auto none = first_picture([](uint32_t, uint32_t) { return false; });
    const auto all = first_picture([](uint32_t, uint32_t) { return true; });
    const auto half = first_picture([](uint32_t, uint32_t y) { return y >= 4; });
    ASSERT_EQ(reported.sampled_tiles[2], 32u);
    // The first frame shows 3x3 means of remainders, which depend on light within 3 pixels.
    const uint32_t only_samples = history == "off" ? 40 : 44;
    for (uint32_t y = 0; y < side; ++y) {
      const auto row = [&](const std::vector<float>& picture) {
        return std::span(picture).subspan(size_t{4} * side * y, size_t{4} * side);
      };
      const double from_none = rms_of_row(row(half), row(none));
      const double from_all = rms_of_row(row(half), row(all));
      const double between = rms_of_row(row(all), row(none));
      EXPECT_TRUE(y >= 32 || from_none == 0) << how << ", row " << y;
      EXPECT_TRUE(y < only_samples || from_all == 0) << how << ", row " << y;
      // The first row next to tiles without samples has 1 % of the samples' light.
      EXPECT_TRUE(y != 32 || from_none < 0.03 * between) << how << ": " << from_none / between;
      EXPECT_TRUE(y != 39 || from_all < 0.05 * between) << how << ": " << from_all / between;
    }
  }
}

TEST_F(UnevenPair, TilesLeaveNoSeams) {
  const auto none = picture(0), all = picture(100000);
  const demo::ReportedFrame choice = reported;
  const auto some = picture(choice.sample_demand / 6); // enough for two thirds of the tiles
  ASSERT_GT(reported.sampled_tiles[0], 12u);
  ASSERT_LT(reported.sampled_tiles[0] + reported.sampled_tiles[1] + reported.sampled_tiles[2], 60u);
  expect_no_seams(none, all, some);
}

} // namespace
} // namespace dermis::abi_test
