// All that can be wrong at once: any value in any picture, at random places. Each frame is another one, and
// follows the one before.
#include "integration/command/bench/stability/cases.hpp"

#include <array>

namespace dermis::tools {
namespace {

constexpr std::array values{not_a_number, infinity,  -infinity, 0.0f,  -0.0f,  -1.0f, 1e-45f,
                            1e-40f,       0x1p-126f, 6e-8f,     1e-5f, 0.5f,   1.0f,  1e3f,
                            65504.0f,     65520.0f,  0x1p31f,   1e30f, -1e30f, 3e38f, -3e38f};
constexpr std::array<uint8_t, 7> ids{0, 1, 2, 3, 4, 5, 200}; // the last one has no profile
constexpr std::array shares{256u, 8u, 1u};                   // one of so many pixels

// Numbers that differ from place to place and repeat from run to run (splitmix64).
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

void spoil(Image& image, uint32_t share, Dice& dice) {
  for (float& value : image.values)
    if (dice.below(share) == 0) value = values[dice.below(values.size())];
}

CapturedFrame spoiled(uint32_t t, bool even_light) {
  Dice dice(t);
  const uint32_t share = shares[t % shares.size()];
  CapturedFrame frame = sound_frame();
  frame.velocity = Image::sized(stability_side, stability_side, 3);
  frame.scatter_scale = Image::sized(stability_side, stability_side, 1);
  for (float& scale : frame.scatter_scale.values)
    scale = 1;
  for (Image* image : {&frame.depth, &frame.albedo, &frame.velocity, &frame.scatter_scale})
    spoil(*image, share, dice);
  for (uint8_t& id : frame.profile)
    if (dice.below(share) == 0) id = ids[dice.below(ids.size())];
  if (!even_light) spoil(frame.lighting, share, dice);
  return frame;
}

StabilityCase anything(std::string_view name, bool even_light) {
  StabilityCase made;
  made.name = name;
  made.frames = 24;
  made.given = [even_light](uint32_t t) { return spoiled(t, even_light); };
  made.finite_only = !even_light;
  made.bound = furnace;
  return made;
}

} // namespace

std::vector<StabilityCase> random_cases() {
  return {anything("anything_anywhere", false), anything("anything_under_even_light", true)};
}

} // namespace dermis::tools
