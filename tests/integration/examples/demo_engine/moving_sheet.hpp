#pragma once
// A thin sheet of skin with its light behind it, as configs/scenes/back_lit.json, where camera, light, a lobe
// beside it and a shield before the light move: in periods that are alike, each with a history of its own.

#include <glm/glm.hpp>

#include <cstdint>
#include <functional>
#include <string>

namespace demo {

// By frame of a period; metres.
struct Motion {
  uint32_t period = 6;
  std::function<glm::dvec3(uint32_t)> camera = [](uint32_t) { return glm::dvec3(0, 0, 0.3); };
  std::function<glm::dvec3(uint32_t)> light = [](uint32_t) { return glm::dvec3(0.02, 0.03, -0.15); };
  std::function<double(uint32_t)> intensity = [](uint32_t) { return 0.03; };
  std::function<glm::dvec3(uint32_t)> lobe = [](uint32_t) { return glm::dvec3(-0.022, -0.012, 0.004); };
  std::function<glm::dvec3(uint32_t)> shield = [](uint32_t) { return glm::dvec3(0, 5, 0); }; // far above
};

// Text of a scene of so many frames; `profile`: file name of its profile. At most 256 periods.
std::string moving_sheet(const Motion& motion, uint32_t frames, const std::string& profile);

} // namespace demo
