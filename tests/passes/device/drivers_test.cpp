// Runs random graphs of the real pass types on two drivers; the light for the host is equal except
// for rounding.
#include "tests/passes/device/fuzz_seeds.hpp"
#include "tests/passes/device/kept_pictures.hpp"
#include "tests/passes/device/player.hpp"

#include "framegraph/text/diagnostic.hpp"
#include "framegraph/vulkan/create_infos.hpp"
#include "integration/examples/demo_engine/pixel_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace dermis::testing {
namespace {

constexpr float half_max = 65504.0f;
constexpr double max_parts = 3; // Parts per random graph.

float brightest(const std::vector<float>& light) {
  float maximum = 0;
  for (size_t i = 0; i < light.size(); ++i)
    if (i % 4 != 3 && light[i] > maximum) maximum = std::min(light[i], half_max);
  return maximum;
}

class BetweenDrivers : public DevicePlayer {
protected:
  // Returns the light of all frames, rgb, slot by slot, in units of the brightest light that
  // histories may contain.
  std::vector<float> light_of(const RealGraph& graph, const Show& show, const Played& played) {
    std::vector<float> out;
    float unit = 0;
    for (size_t f = 0; f < played.size(); ++f) {
      const float shown = brightest(show.frames[f].pictures.at("lighting"));
      unit = show.frames[f].cut ? shown : std::max(unit, shown);
      for (const auto& [slot, texels] : played[f]) {
        if (slot != "lighting" && !slot.ends_with("scattered_light")) continue;
        const uint32_t resource = resource_of(graph.graph, slot);
        const auto* format = demo::find_pixel_format(vulkan::vk_format(show.formats[resource]));
        const std::vector<float> values = demo::decode_texels(*format, texels);
        for (size_t i = 0; i < values.size(); ++i)
          // A view may be dark.
          if (i % 4 != 3) out.push_back(values[i] / (unit > 0 ? unit : 1.0f));
      }
    }
    return out;
  }

  static uint32_t resource_of(const Graph& graph, const std::string& name) {
    uint32_t found = 0;
    while (graph.resources[found].name != name)
      ++found;
    return found;
  }

  std::vector<float> light_of_seed(uint64_t seed, std::string& name) {
    const auto graph = random_real_graph(seed, pass_types);
    if (!graph) return {};
    name = graph->name;
    const Show show = random_show(seed, graph->graph);
    Diagnostics diagnostics;
    const auto compiled = compile(compile_input(*graph, show), diagnostics);
    EXPECT_TRUE(compiled) << format_as_json(diagnostics);
    return compiled ? light_of(*graph, show, play(*graph, show, compiled->plan, false))
                    : std::vector<float>{};
  }
};

// Returns the brightest result, at least 1: albedo above 1 makes results brighter than all light.
double brightest_result(const std::vector<float>& light) {
  double most = 1;
  for (const float value : light)
    if (std::isfinite(value)) most = std::max(most, double(value));
  return most;
}

// Bounds in units of the brightest light or result. Rounding to half floats is at most 2^-11 of
// it; each part of a graph stores, filters and takes exponentials up to four times in sequence, as
// in Golden. Few pixels sample a neighbouring texel: at most one of 100 in any graph, and one of
// 1000 overall.
TEST_F(BetweenDrivers, RandomGraphs_MatchPicturesOfAnotherDriver) {
  const KeptPictures kept = kept_pictures();
  if (kept.folder.empty())
    GTEST_SKIP() << "DERMIS_PICTURES names no folder with light of another driver "
                    "(tests/scripts/run_on_drivers.sh)";
  const FuzzSeeds seeds = fuzz_seeds(24);
  constexpr double rounding = 1.0 / 2048;
  std::vector<double> all;
  for (uint64_t seed = seeds.begin; seed < seeds.end; ++seed) {
    std::string name;
    const std::vector<float> here = light_of_seed(seed, name);
    SCOPED_TRACE(fmt::format("seed {}: {}", seed, name));
    const std::string path = fmt::format("{}/random_{}.floats", kept.folder, seed);
    if (kept.keep) {
      keep_floats(path, here);
      continue;
    }
    const std::vector<float> there = kept_floats(path);
    ASSERT_EQ(here.size(), there.size()) << path;
    std::vector<double> off = differences(here, there);
    const double unit = brightest_result(there);
    for (double& one : off)
      one /= unit;
    std::printf("seed\t%llu\t%s\t%s\n", static_cast<unsigned long long>(seed), name.c_str(),
                reported_percentiles(off).c_str());
    std::fflush(stdout); // Slow drivers may be stopped, so the log is flushed.
    const auto parts = static_cast<double>(1 + std::count(name.begin(), name.end(), '+'));
    EXPECT_LE(percentile(off, 0.5), 4 * rounding);
    EXPECT_LE(percentile(off, 0.99), 4 * rounding * parts);
    all.insert(all.end(), off.begin(), off.end());
  }
  if (kept.keep) return;
  std::sort(all.begin(), all.end());
  std::printf("pictures\t%s\t%llu random graphs\t%s\n", driver().c_str(),
              static_cast<unsigned long long>(seeds.end - seeds.begin),
              reported_percentiles(all).c_str());
  EXPECT_LE(percentile(all, 0.999), 4 * rounding * max_parts);
}

} // namespace
} // namespace dermis::testing
