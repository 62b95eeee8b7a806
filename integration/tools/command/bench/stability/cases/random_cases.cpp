// Random combination of all damage: any value in any image at random positions. Each frame differs
// and follows the previous frame.
#include "integration/tools/command/bench/stability/cases.hpp"

#include <array>

namespace dermis::tools {
namespace {

constexpr std::array any_value{not_a_number, infinity,  -infinity, 0.0f,  -0.0f,  -1.0f, 1e-45f,
                               1e-40f,       0x1p-126f, 6e-8f,     1e-5f, 0.5f,   1.0f,  1e3f,
                               65504.0f,     65520.0f,  0x1p31f,   1e30f, -1e30f, 3e38f, -3e38f};
constexpr std::array<uint8_t, 7> ids{0, 1, 2, 3, 4, 5, 200}; // the last id has no profile
constexpr std::array dim_light{0.0f, 1e-3f, 0.5f, 1.0f};     // light values
constexpr std::array fractions{256u, 8u, 1u};                // one of that many pixels

// Pseudo-random numbers, repeatable across runs (splitmix64).
class Dice {
public:
  explicit Dice(uint64_t seed) : state_(seed) {}
  uint32_t below(size_t bound) {
    state_ += 0x9e3779b97f4a7c15u;
    uint64_t mixed = (state_ ^ (state_ >> 30)) * 0xbf58476d1ce4e5b9u;
    mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebu;
    return static_cast<uint32_t>((mixed ^ (mixed >> 31)) % bound);
  }

private:
  uint64_t state_;
};

void spoil(Image& image, uint32_t fraction, Dice& dice) {
  for (float& value : image.values)
    if (dice.below(fraction) == 0) value = any_value[dice.below(any_value.size())];
}

enum class Light : uint8_t { any, even, at_most_1 };

CapturedFrame spoiled(uint32_t t, Light light) {
  Dice dice(t);
  const uint32_t fraction = fractions[t % fractions.size()];
  CapturedFrame frame = sound_frame();
  frame.velocity = Image::sized(stability_side, stability_side, 3);
  frame.scatter_scale = Image::sized(stability_side, stability_side, 1);
  for (float& scale : frame.scatter_scale.values)
    scale = 1;
  for (Image* image : {&frame.depth, &frame.albedo, &frame.velocity, &frame.scatter_scale})
    spoil(*image, fraction, dice);
  for (uint8_t& id : frame.profile)
    if (dice.below(fraction) == 0) id = ids[dice.below(ids.size())];
  if (light == Light::any) spoil(frame.lighting, fraction, dice);
  for (float& value : frame.lighting.values)
    if (light == Light::at_most_1) value = dim_light[dice.below(dim_light.size())];
  return frame;
}

StabilityCase anything(std::string_view name, Light light) {
  StabilityCase made;
  made.name = name;
  made.frames = 24;
  made.given = [light](uint32_t t) { return spoiled(t, light); };
  made.bound = furnace;
  return made;
}

} // namespace

std::vector<StabilityCase> random_cases() {
  StabilityCase anywhere = anything("anything_anywhere", Light::any);
  anywhere.finite_only = true;
  StabilityCase most_1 = anything("anything_under_light_up_to_1", Light::at_most_1);
  most_1.judged = Judged::light_beyond;
  return {anywhere, anything("anything_under_even_light", Light::even), most_1};
}

} // namespace dermis::tools
