#include "tests/passes/device/show.hpp"

#include "tests/integration/soak/pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dermis::testing {
namespace {

using abi_test::soak_side;
using abi_test::unit;

constexpr uint32_t min_side = 16, random_frames = 4, golden_frames = 6;
constexpr uint32_t golden_width = 64, golden_height = 48;

// Returns whether the tests can fill the format.
bool is_testable(Format format) {
  constexpr std::array known = {Format::r8_uint,    Format::r16f,    Format::r32f,
                                Format::d32f,       Format::rg16f,   Format::rgba8_unorm,
                                Format::rgba8_srgb, Format::rgba16f, Format::rgba32f};
  return std::find(known.begin(), known.end(), format) != known.end();
}

bool is_bound_by_host(const ResourceDeclaration& resource) {
  return resource.origin == Origin::imported || resource.exported;
}

std::vector<Format> testable_formats(const ResourceDeclaration& resource) {
  std::vector<Format> formats;
  for (const Format format : resource.formats)
    if (is_testable(format)) formats.push_back(format);
  return formats;
}

// Returns the upper left part of the soak's square pictures.
std::vector<float> cropped(const std::vector<float>& square, uint32_t channels, const Show& show) {
  std::vector<float> out;
  for (uint32_t y = 0; y < show.height; ++y) {
    const float* row = square.data() + size_t{y} * soak_side * channels;
    out.insert(out.end(), row, row + size_t{show.width} * channels);
  }
  return out;
}

std::vector<float> noise(SplitMix64& random, const Show& show, uint32_t channels, double maximum) {
  std::vector<float> out(size_t{show.width} * show.height * channels);
  for (float& value : out)
    value = static_cast<float>(maximum * unit(random));
  return out;
}

// Fills pictures that the soak does not generate. Thickness is up to 0.02 m, factors on d up to 2,
// all others up to 1.
std::vector<float> other_picture(SplitMix64& random, const Show& show, const std::string& name) {
  const double maximum = name == "thickness" ? 0.02 : name == "scatter_scale" ? 2.0 : 1.0;
  return noise(random, show, shown_channels(name), maximum);
}

void draw_rectangle(SplitMix64& random, const Show& show, ShownFrame& frame) {
  frame.width = show.width;
  frame.height = show.height;
  if (random.below(100) >= 15) return;
  frame.width = static_cast<uint32_t>(1 + random.below(show.width));
  frame.height = static_cast<uint32_t>(1 + random.below(show.height));
  frame.x = static_cast<uint32_t>(random.below(show.width - frame.width + 1));
  frame.y = static_cast<uint32_t>(random.below(show.height - frame.height + 1));
}

} // namespace

uint32_t shown_channels(const std::string& import) {
  if (import == "lighting" || import == "albedo" || import == "back_lighting") return 4;
  return import == "velocity" ? 2 : 1;
}

Show random_show(uint64_t seed, const Graph& graph) {
  SplitMix64 random{~seed};
  Show show;
  show.width = static_cast<uint32_t>(min_side + random.below(soak_side - min_side + 1));
  show.height = static_cast<uint32_t>(min_side + random.below(soak_side - min_side + 1));
  const bool all = random.below(3) == 0;
  for (const ResourceDeclaration& resource : graph.resources) {
    // Transmission needs both.
    const bool transmission = resource.name == "thickness" || resource.name == "back_lighting";
    const bool left_out = is_bound_by_host(resource) && resource.optional && !all &&
                          !transmission && random.below(100) < 30;
    show.bound.push_back(!left_out);
    show.formats.push_back(Format::undefined);
    if (const auto formats = testable_formats(resource);
        is_bound_by_host(resource) && !formats.empty())
      show.formats.back() = formats[random.below(formats.size())];
  }
  abi_test::Surface surface = abi_test::draw_surface(random);
  for (uint32_t f = 0; f < random_frames; ++f) {
    ShownFrame frame;
    frame.cut = f > 0 && random.below(100) < 15;
    draw_rectangle(random, show, frame);
    if (random.below(100) < 20) surface = abi_test::draw_surface(random);
    const abi_test::Light light = abi_test::draw_light(random, random.below(100) < 20);
    for (const ResourceDeclaration& resource : graph.resources) {
      if (resource.origin != Origin::imported) continue;
      std::vector<float>& picture = frame.pictures[resource.name];
      if (resource.name == "lighting")
        picture = cropped(light.texels, 4, show);
      else if (resource.name == "depth")
        picture = cropped(surface.depth, 1, show);
      else if (resource.name == "material")
        picture = cropped(surface.material, 1, show);
      else if (resource.name == "velocity")
        picture = cropped(surface.velocity, 2, show);
      else
        picture = other_picture(random, show, resource.name);
    }
    show.frames.push_back(std::move(frame));
  }
  return show;
}

Show golden_show(const Graph& graph) {
  Show show;
  show.width = golden_width;
  show.height = golden_height;
  for (const ResourceDeclaration& resource : graph.resources) {
    const bool light = resource.name == "lighting" || resource.name == "scattered_light";
    show.bound.push_back(!is_bound_by_host(resource) || resource.origin == Origin::imported ||
                         light);
    const auto formats = testable_formats(resource);
    show.formats.push_back(is_bound_by_host(resource) && !formats.empty() ? formats.front()
                                                                          : Format::undefined);
  }
  SplitMix64 random{1};
  std::map<std::string, std::vector<float>> others; // Equal in all frames.
  for (const ResourceDeclaration& resource : graph.resources)
    if (resource.origin == Origin::imported)
      others[resource.name] = other_picture(random, show, resource.name);
  for (uint32_t f = 0; f < golden_frames; ++f) {
    ShownFrame frame;
    frame.width = golden_width;
    frame.height = golden_height;
    frame.pictures = others;
    for (uint32_t y = 0; y < golden_height; ++y)
      for (uint32_t x = 0; x < golden_width; ++x) {
        const size_t i = size_t{y} * golden_width + x;
        const float dx = (static_cast<float>(x) - 20.0f) / 16.0f,
                    dy = (static_cast<float>(y) - 24.0f) / 16.0f;
        const float inside = 1.0f - dx * dx - dy * dy;
        frame.pictures["depth"][i] = inside > 0 ? 0.5f - 0.01f * inside : x < 44 ? 0.52f : 0.54f;
        frame.pictures["material"][i] = y < 4 ? 0.0f : x < 44 ? 1.0f : 2.0f;
        const bool lit = (x + 2 * f) / 8 % 2 == 0;
        for (size_t c = 0; c < 3; ++c) // Multiples of 1/64, which half floats represent exactly.
          frame.pictures["lighting"][4 * i + c] =
              (lit ? 0.75f : 0.125f) + static_cast<float>((x * 7 + y * 5 + f * 3 + c) % 8) / 64.0f;
        if (frame.pictures.contains("velocity"))
          frame.pictures["velocity"][2 * i] = frame.pictures["velocity"][2 * i + 1] = 0.0f;
      }
    show.frames.push_back(std::move(frame));
  }
  return show;
}

} // namespace dermis::testing
