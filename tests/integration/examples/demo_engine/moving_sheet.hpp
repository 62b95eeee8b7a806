#pragma once
// The thin back-lit sheet of skin of configs/scenes/back_lit.json with a moving camera, light,
// adjacent lobe, and shield in front of the light. The motion repeats in periods, each with a
// separate history.

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <string>

namespace demo {

// By frame of a period; metres.
struct Motion {
  uint32_t period = 6;
  std::function<glm::dvec3(uint32_t)> camera = [](uint32_t) { return glm::dvec3(0, 0, 0.3); };
  std::function<glm::dvec3(uint32_t)> light = [](uint32_t) {
    return glm::dvec3(0.02, 0.03, -0.15);
  };
  std::function<double(uint32_t)> intensity = [](uint32_t) { return 0.03; };
  std::function<glm::dvec3(uint32_t)> lobe = [](uint32_t) {
    return glm::dvec3(-0.022, -0.012, 0.004);
  };
  // Far above the sheet.
  std::function<glm::dvec3(uint32_t)> shield = [](uint32_t) { return glm::dvec3(0, 5, 0); };
};

// Returns the text of a scene with `frames` frames; `profile` is the file name of its profile. At
// most 256 periods.
std::string moving_sheet(const Motion& motion, uint32_t frames, const std::string& profile);

} // namespace demo
