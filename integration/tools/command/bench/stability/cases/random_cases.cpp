// Random combination of all damage: any value in any image at random positions. Each frame differs
// and follows the previous frame.
#include "integration/tools/command/bench/stability/cases.hpp"

#include "framegraph/model/splitmix.hpp"

#include <array>

namespace dermis::tools {
namespace {

constexpr std::array any_value{not_a_number, infinity, -infinity, 0.0f,      -0.0f,    -1.0f,
                               1e-45f,       1e-40f,   1e-30f,    0x1p-126f, 6e-8f,    1e-5f,
                               0.5f,         1.0f,     1e3f,      65504.0f,  65520.0f, 0x1p31f,
                               1e30f,        -1e30f,   3e38f,     -3e38f};
constexpr std::array<uint8_t, 8> ids{0, 1, 2, 3, 4, 5, 6, 200}; // the last id has no profile
constexpr std::array dim_light{0.0f, 1e-3f, 0.5f, 1.0f};        // light values
constexpr std::array damaged_fractions{256u, 8u, 1u};           // one of that many pixels

void spoil(Image& image, uint32_t fraction, SplitMix64& dice) {
  for (float& value : image.values)
    if (dice.below(fraction) == 0) value = any_value[dice.below(any_value.size())];
}

enum class Lighting : uint8_t { any, even, at_most_1 };

CapturedFrame spoiled(uint32_t t, Lighting light) {
  SplitMix64 dice{t};
  const uint32_t fraction = damaged_fractions[t % damaged_fractions.size()];
  CapturedFrame frame = sound_frame();
  frame.velocity = Image::sized(stability_side, stability_side, 3);
  frame.scatter_scale = Image::sized(stability_side, stability_side, 1);
  for (float& scale : frame.scatter_scale.values)
    scale = 1;
  for (Image* image : {&frame.depth, &frame.albedo, &frame.velocity, &frame.scatter_scale})
    spoil(*image, fraction, dice);
  for (uint8_t& id : frame.profile)
    if (dice.below(fraction) == 0) id = ids[dice.below(ids.size())];
  if (light == Lighting::any) spoil(frame.lighting, fraction, dice);
  for (float& value : frame.lighting.values)
    if (light == Lighting::at_most_1) value = dim_light[dice.below(dim_light.size())];
  return frame;
}

StabilityCase random_damage(std::string_view name, Lighting light) {
  return {.name = name,
          .frames = 24,
          .given = [light](uint32_t t) { return spoiled(t, light); },
          .bound = furnace};
}

} // namespace

std::vector<StabilityCase> random_cases() {
  StabilityCase anywhere = random_damage("anything_anywhere", Lighting::any);
  anywhere.finite_only = true;
  StabilityCase most_1 = random_damage("anything_under_light_up_to_1", Lighting::at_most_1);
  most_1.metric = Metric::light_beyond;
  return {anywhere, random_damage("anything_under_even_light", Lighting::even), most_1};
}

} // namespace dermis::tools
