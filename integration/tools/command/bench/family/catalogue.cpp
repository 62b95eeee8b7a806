// The list of scenes: kinds with the limits of random parameters, and tuned parameters.

#include "integration/tools/command/bench/family/catalogue.hpp"

#include "framegraph/model/splitmix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace dermis::tools {
namespace {

// Changing the seed replaces the half "judging". Only a change of the catalogue's rules may do
// that.
constexpr uint64_t judging_seed = 36;

constexpr FamilyParameter any_angle{"angle", 20, 70}, gentle_angle{"angle", 20, 50},
    any_direction{"direction", 0, 180}, any_period{"period", 12, 60}, any_cell{"cell", 1, 4, true},
    any_distance{"distance", 4, 400}, any_light{"light", 0.2, 1};

using View = FamilyView;
constexpr FamilyKind kinds[] = {
    {"plane", "plane", make_plane, false, {}, 0.1, 100, 4},
    {"tilt", "tilt", make_tilt, false, {{any_angle, any_direction}}, 0.5, 16, 3},
    {"bumps", "bumps", make_bumps, true, {{{"period", 24, 96}, gentle_angle}}, 0.5, 16, 3},
    {"egg_crate", "bumps", make_egg_crate, true, {{{"period", 12, 48}, gentle_angle}}, 0.5, 8, 1},
    {"sphere", "sphere", make_sphere, true, {{{"radius", 0.3, 0.48}}}, 0.5, 16, 2},
    {"cylinders", "sphere", make_cylinders, true, {{{"radius", 6, 40}, {"gap", 0, 20}}}, 0.5, 8, 2},
    {"noise", "terrain", make_noise, false, {{{"deviation", 0.2, 1.2}}}, 0.5, 8, 2},
    {"fractal",
     "terrain",
     make_fractal,
     true,
     {{{"height", 10, 60}, {"cell", 16, 64}}},
     0.5,
     12,
     2},
    {"step", "step", make_step, false, {{{"height", 2, 60}, any_light}}, 0.5, 16, 2},
    {"stairs",
     "step",
     make_stairs,
     false,
     {{{"tread", 4, 40}, {"height", 1, 30}, any_light}},
     0.5,
     12,
     2},
    {"zigzag",
     "fold",
     make_zigzag,
     true,
     {{{"angle", 30, 72}, {"period", 12, 60}, any_direction}},
     1,
     16,
     4},
    {"grooves",
     "groove",
     make_grooves,
     false,
     {{{"width", 2, 16, true}, {"depth", 4, 40}, {"spacing", 18, 60, true}, any_light}},
     1,
     12,
     3},
    {"wave", "wave", make_wave, true, {{any_period, {"angle", 30, 70}, any_direction}}, 0.5, 12, 3},
    {"plates", "plate", make_plates, false, {{{"width", 4, 32}, {"height", 2, 40}}}, 0.5, 12, 2},
    {"scales", "plate", make_scales, true, {{{"width", 8, 40}, {"angle", 15, 60}}}, 0.5, 12, 2},
    {"strips",
     "strip",
     make_strips,
     false,
     {{{"width", 1, 24, true}, {"gap", 1, 6, true}}},
     0.5,
     16,
     2},
    {"mask", "strip", make_mask, false, {{{"cell", 1, 12, true}}}, 0.5, 16, 2},
    {"checker", "checker", make_checker, false, {{any_cell}}, 0.5, 8, 3},
    {"stripes", "stripes", make_stripes, false, {{{"width", 1, 24, true}}}, 0.5, 8, 3},
    {"random", "random", make_random_materials, false, {{any_cell}}, 0.5, 8, 3},
    {"screen_door", "dither", make_screen_door, false, {{any_distance}}, 0.5, 8, 2},
    {"checker_dither", "dither", make_checker_dither, false, {{any_distance}}, 0.5, 8, 1},
    {"noise_dither",
     "dither",
     make_noise_dither,
     false,
     {{any_distance, {"fraction", 0.1, 0.7}}},
     0.5,
     8,
     2},
    {"hair",
     "hair",
     make_hair,
     false,
     {{{"width", 1, 3, true}, {"spacing", 4, 24, true}, {"distance", 8, 80}, any_light}},
     0.5,
     8,
     3},
    {"strands",
     "strand",
     make_strands,
     false,
     {{{"width", 1, 4}, {"number", 20, 150, true}, {"distance", 8, 100}}},
     0.5,
     8,
     3},
    {"holes",
     "hole",
     make_holes,
     false,
     {{{"radius", 2, 10}, {"spacing", 22, 40}, {"depth", 0, 60}}},
     0.5,
     12,
     3},
    {"bars", "thin", make_bars, true, {{{"width", 3, 16}, {"gap", 2, 18}}}, 0.5, 12, 2},
    {"ridges",
     "thin",
     make_ridges,
     true,
     {{{"width", 2, 10}, {"spacing", 12, 50}, {"height", 6, 30}}},
     0.5,
     8,
     2},
    {"perspective_tilt",
     "perspective",
     make_tilt,
     false,
     {{{"angle", 15, 40}, any_direction}},
     0.5,
     12,
     1,
     View::perspective},
    {"perspective_bumps",
     "perspective",
     make_bumps,
     true,
     {{{"period", 24, 96}, gentle_angle}},
     0.5,
     12,
     2,
     View::perspective},
    {"perspective_sphere",
     "perspective",
     make_sphere,
     true,
     {{{"radius", 0.3, 0.48}}},
     0.5,
     12,
     1,
     View::perspective},
    {"pixels_plane", "pixels", make_plane, false, {}, 0.5, 16, 2, View::non_square},
    {"pixels_tilt",
     "pixels",
     make_tilt,
     false,
     {{any_angle, any_direction}},
     0.5,
     12,
     2,
     View::non_square},
    {"pixels_bumps",
     "pixels",
     make_bumps,
     true,
     {{{"period", 24, 96}, gentle_angle}},
     0.5,
     12,
     2,
     View::non_square},
    {"pixels_step",
     "pixels",
     make_step,
     false,
     {{{"height", 2, 60}, any_light}},
     0.5,
     12,
     2,
     View::non_square},
    {"pixels_perspective",
     "pixels",
     make_bumps,
     true,
     {{{"period", 24, 96}, gentle_angle}},
     0.5,
     12,
     2,
     View::non_square_perspective},
    {"pixels_bands",
     "pixels",
     make_bands,
     false,
     {{{"width", 6, 30}}},
     0.5,
     12,
     2,
     View::non_square},
};

struct TunedScene {
  std::string_view kind, name;
  std::array<double, 4> values{};
  double d_px = 4;
  FamilyPattern pattern = FamilyPattern::texture;
  bool skin = false;
};
using Pattern = FamilyPattern;
constexpr TunedScene tuned[] = {
    {"plane", "plane_d0.1", {}, 0.1},
    {"plane", "plane_d0.5", {}, 0.5},
    {"plane", "plane_d1", {}, 1, Pattern::texture, true},
    {"plane", "plane_d4", {}, 4},
    {"plane", "plane_d16", {}, 16},
    {"plane", "plane_d40", {}, 40},
    {"plane", "plane_d100", {}, 100},
    {"tilt", "tilt_30_d4", {30, 0}, 4},
    {"tilt", "tilt_60_d2", {60, 40}, 2},
    {"tilt", "tilt_70_d4", {70, 90}, 4},
    {"bumps", "bumps_d1", {48, 45}, 1, Pattern::shade, true},
    {"bumps", "bumps_d4", {48, 45}, 4, Pattern::shade},
    {"egg_crate", "egg_crate_d2", {24, 45}, 2, Pattern::shade},
    {"sphere", "sphere_d4", {0.42}, 4, Pattern::shade, true},
    {"cylinders", "cylinders_d4", {16, 8}, 4, Pattern::shade},
    {"noise", "noise_0.3_d4", {0.3}, 4},
    {"noise", "noise_1_d4", {1}, 4},
    {"fractal", "fractal_d8", {40, 48}, 8, Pattern::shade},
    {"step", "step_d6", {12, 0.25}, 6},
    {"stairs", "stairs_d8", {12, 8, 1}, 8, Pattern::edge},
    {"zigzag", "zigzag_35_d6", {35, 24, 0}, 6, Pattern::edge, true},
    {"zigzag", "zigzag_45_d6", {45, 24, 0}, 6, Pattern::edge, true},
    {"zigzag", "zigzag_56_d6", {56, 24, 0}, 6, Pattern::edge, true},
    {"zigzag", "zigzag_56_d12", {56, 24, 0}, 12, Pattern::edge},
    {"zigzag", "zigzag_70_d2", {70, 24, 0}, 2, Pattern::shade},
    {"grooves", "grooves_d4", {6, 12, 24, 1}, 4, Pattern::edge},
    {"wave", "wave_d4", {24, 50, 30}, 4, Pattern::shade},
    {"wave", "corrugation_d2", {8, 45, 0}, 2, Pattern::edge},
    {"plates", "plates_d4", {10, 20}, 4},
    {"scales", "scales_d4", {16, 45}, 4, Pattern::bands},
    {"strips", "strips_d4", {8, 8}, 4},
    {"strips", "strips_thin_d4", {2, 6}, 4, Pattern::edge},
    {"mask", "mask_1_d4", {1}, 4, Pattern::edge},
    {"mask", "mask_4_d4", {4}, 4, Pattern::texture, true},
    {"checker", "checker_1_d2", {1}, 2, Pattern::edge},
    {"checker", "checker_3_d1", {3}, 1},
    {"stripes", "stripes_2_d2", {2}, 2, Pattern::edge},
    {"stripes", "stripes_4_d2", {4}, 2, Pattern::edge},
    {"stripes", "stripes_8_d2", {8}, 2, Pattern::edge},
    {"stripes", "stripes_16_d2", {16}, 2, Pattern::texture},
    {"random", "random_1_d2", {1}, 2, Pattern::edge},
    {"random", "random_3_d2", {3}, 2},
    {"screen_door", "dithered_5cm", {250}, 5.2468, Pattern::bands, true},
    {"screen_door", "dither_12_d4", {12}, 4, Pattern::bands},
    {"screen_door", "dither_50_d4", {50}, 4, Pattern::bands},
    {"checker_dither", "checker_dither_50_d4", {50}, 4, Pattern::bands},
    {"noise_dither", "noise_dither_8_d4", {8, 0.25}, 4, Pattern::bands},
    {"hair", "hair_d4", {1, 16, 20, 1}, 4, Pattern::edge},
    {"hair", "hair_dark_d2", {1, 6, 40, 0.3}, 2},
    {"strands", "strands_d4", {1, 80, 40}, 4},
    {"holes", "holes_d4", {6, 24, 0}, 4},
    {"holes", "holes_deep_d4", {6, 24, 30}, 4, Pattern::bands, true},
    {"bars", "bars_d4", {6, 10}, 4},
    {"ridges", "ridges_d4", {4, 24, 12}, 4, Pattern::shade},
    {"perspective_tilt", "perspective_tilt_d4", {35, 60}, 4},
    {"perspective_bumps", "perspective_bumps_d4", {48, 45}, 4, Pattern::shade, true},
    {"perspective_sphere", "perspective_sphere_d2", {0.42}, 2, Pattern::shade},
    // The last kinds are measured at every pixel aspect below.
    {"pixels_plane", "pixels_plane", {}, 4},
    {"pixels_tilt", "pixels_tilt", {50, 30}, 4},
    {"pixels_bumps", "pixels_bumps", {48, 45}, 4, Pattern::shade},
    {"pixels_step", "pixels_step", {12, 0.25}, 4},
    {"pixels_perspective", "pixels_perspective", {48, 45}, 4, Pattern::shade},
    {"pixels_bands", "pixels_bands", {11.314}, 3.71, Pattern::bands, true},
};

struct Aspect {
  const char* name;
  double value;
};
constexpr Aspect aspects[] = {{"4to3", 4.0 / 3}, {"3to4", 0.75}, {"2to1", 2},
                              {"1to2", 0.5},     {"4to1", 4},    {"1to4", 0.25}};

bool is_perspective(const FamilyKind& kind) {
  return kind.view == View::perspective || kind.view == View::non_square_perspective;
}

bool is_non_square(const FamilyKind& kind) {
  return kind.view == View::non_square || kind.view == View::non_square_perspective;
}

const FamilyKind& kind_of(std::string_view name) {
  return *std::find_if(std::begin(kinds), std::end(kinds),
                       [&](const FamilyKind& kind) { return kind.name == name; });
}

uint64_t seed_of(std::string_view text) { // FNV-1a
  uint64_t seed = 0xcbf29ce484222325u;
  for (const char c : text)
    seed = (seed ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return seed;
}

// Draws values of the half "judging".
class Draw {
public:
  explicit Draw(uint64_t seed) : random_{seed} {}

  double between(double low, double high) {
    const double t = double(random_.next() >> 11) * 0x1p-53;
    return low > 0 && high > 4 * low ? low * std::pow(high / low, t) : low + t * (high - low);
  }
  bool coin() { return random_.next() % 2 != 0; }
  size_t below(size_t limit) { return random_.below(limit); }
  uint32_t seed() { return static_cast<uint32_t>(random_.next() >> 40); }

private:
  SplitMix64 random_;
};

// Rounds to two digits, so that names and reports show the exact value.
double rounded(double value) {
  if (value == 0) return 0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 1);
  return std::round(value / unit) * unit;
}

FamilyScene drawn_scene(const FamilyKind& kind, uint32_t number) {
  FamilyScene scene;
  scene.name = fmt::format("{}_j{}", kind.name, number);
  Draw draw(splitmix_scramble(judging_seed ^ seed_of(scene.name)));
  scene.kind = &kind;
  scene.member = {std::string(kind.scene_class), "judging", draw.seed()};
  for (size_t i = 0; i < kind.parameters.size(); ++i) {
    const FamilyParameter& parameter = kind.parameters[i];
    if (parameter.high == 0) continue;
    const double value = draw.between(parameter.low, parameter.high);
    scene.values[i] = parameter.whole ? std::round(value) : rounded(value);
  }
  scene.d_px = rounded(draw.between(kind.d_low, kind.d_high));
  scene.skin = draw.coin();
  constexpr FamilyPattern flat[] = {FamilyPattern::texture, FamilyPattern::edge,
                                    FamilyPattern::bands, FamilyPattern::waves};
  scene.pattern = kind.shaded && draw.coin() ? FamilyPattern::shade : flat[draw.below(4)];
  scene.perspective = is_perspective(kind);
  const double aspect = std::exp2(draw.between(0.2, 2) * (draw.coin() ? 1 : -1));
  if (is_non_square(kind)) scene.aspect = rounded(aspect);
  return scene;
}

FamilyScene tuned_scene(const TunedScene& row) {
  const FamilyKind& kind = kind_of(row.kind);
  return {.name = std::string(row.name),
          .member = {std::string(kind.scene_class), "tuning", seed_of(row.name) % 1000},
          .kind = &kind,
          .values = row.values,
          .d_px = row.d_px,
          .perspective = is_perspective(kind),
          .pattern = row.pattern,
          .skin = row.skin};
}

std::vector<FamilyScene> all_scenes() {
  std::vector<FamilyScene> scenes;
  for (const TunedScene& row : tuned) {
    FamilyScene scene = tuned_scene(row);
    if (is_non_square(*scene.kind)) {
      for (const Aspect& aspect : aspects) {
        scene.name = fmt::format("{}_{}", row.name, aspect.name);
        scene.aspect = aspect.value;
        scenes.push_back(scene);
      }
      // The same surface with square pixels is the measure of the others.
      scene.name = fmt::format("{}_1to1", row.name);
      scene.aspect = 1;
      scene.member.scene_class = "square";
    }
    scenes.push_back(scene);
  }
  for (const FamilyKind& kind : kinds)
    for (uint32_t i = 1; i <= kind.judging; ++i)
      scenes.push_back(drawn_scene(kind, i));
  return scenes;
}

} // namespace

std::string FamilyScene::parameters() const {
  std::string text;
  for (size_t i = 0; i < values.size(); ++i)
    if (*kind->parameters[i].name != 0)
      text +=
          fmt::format("{}{} {:g}", text.empty() ? "" : ", ", kind->parameters[i].name, values[i]);
  if (aspect != 1) text += fmt::format("{}aspect {:.3g}", text.empty() ? "" : ", ", aspect);
  return text;
}

const std::vector<FamilyScene>& family_scenes() {
  static const std::vector<FamilyScene> scenes = all_scenes();
  return scenes;
}

std::vector<FamilyScene> few_family_scenes() {
  std::vector<FamilyScene> few;
  std::set<std::string> seen;
  for (const FamilyScene& scene : family_scenes())
    if (seen.insert(scene.member.scene_class).second) few.push_back(scene);
  for (size_t i = 1; i < few.size(); i += 2)
    for (const FamilyScene& scene : family_scenes())
      if (scene.member.scene_class == few[i].member.scene_class && scene.member.half == "judging") {
        few[i] = scene;
        break;
      }
  return few;
}

} // namespace dermis::tools
