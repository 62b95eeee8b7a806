#include "tests/integration/examples/demo_engine/moving_sheet.hpp"

#include <fmt/format.h>

namespace demo {

namespace {

constexpr double frames_per_second = 25;

// Returns one key per frame with the value of the frame.
template <class Values>
std::string keys(const Motion& motion, uint32_t frames, const Values& values) {
  std::string text = R"({ "keys": [)";
  for (uint32_t f = 0; f < frames; ++f)
    text += fmt::format("{}[{:.17g}, {}]", f == 0 ? "" : ", ", f / frames_per_second,
                        values(f % motion.period));
  return text + "] }";
}

std::string places(const Motion& motion, uint32_t frames,
                   const std::function<glm::dvec3(uint32_t)>& at) {
  return keys(motion, frames, [&](uint32_t phase) {
    const glm::dvec3 v = at(phase);
    return fmt::format("{}, {}, {}", v.x, v.y, v.z);
  });
}

} // namespace

std::string moving_sheet(const Motion& motion, uint32_t frames, const std::string& profile) {
  std::string cuts;
  for (uint32_t f = motion.period; f < frames; f += motion.period)
    cuts += fmt::format("{}{:.17g}", cuts.empty() ? "" : ", ", f / frames_per_second);
  constexpr const char* body =
      R"("profile": "skin", "albedo": [0.7, 0.46, 0.36], "shape": "sphere")";
  return fmt::format(
      R"({{ "dermis_scene": 1, "name": "moving_sheet", "frames_per_second": {}, "cuts": [{}],
    "profiles": [ {{ "name": "skin", "file": "{}" }} ],
    "camera": {{ "position": {}, "target": {}, "vertical_fov": 10 }},
    "lights": [
      {{ "type": "point", "position": {}, "color": [1.0, 0.95, 0.9], "intensity": {} }},
      {{ "type": "point", "position": [-0.20, 0.10, 0.15], "color": [0.75, 0.86, 1.0], "intensity": {} }} ],
    "objects": [
      {{ {}, "rotation": [0, 12, 0], "scale": [0.024, 0.034, 0.0014] }},
      {{ {}, "position": {}, "scale": [0.008, 0.008, 0.008] }},
      {{ "shape": "box", "position": {}, "scale": [0.2, 0.2, 0.002] }} ] }})",
      frames_per_second, cuts, profile, places(motion, frames, motion.camera),
      places(motion, frames,
             [&](uint32_t phase) { return motion.camera(phase) - glm::dvec3(0, 0, 0.3); }),
      places(motion, frames, motion.light),
      keys(motion, frames,
           [&](uint32_t phase) { return fmt::format("{}", motion.intensity(phase)); }),
      keys(motion, frames,
           [&](uint32_t phase) { return fmt::format("{}", 0.1 * motion.intensity(phase)); }),
      body, body, places(motion, frames, motion.lobe), places(motion, frames, motion.shield));
}

} // namespace demo
