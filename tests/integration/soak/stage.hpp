#pragma once
// One graph of the soak with its views, and the possible changes between frames.

#include "tests/integration/abi/dermis_fixture.hpp"
#include "tests/integration/soak/pictures.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dermis::abi_test {

// Light is stored in half floats on its path and at its end, each time rounded by at most 2^-11 of
// its value.
inline constexpr double soak_rounding = 1.0 / 1024;

struct StageDesc {
  std::string name, graph;           // As graph_file() names it.
  std::vector<std::string> overlays; // Files of configs/overlays.
  // Settings that change, with their possible values as JSON.
  std::vector<std::pair<std::string, std::vector<std::string>>> settings;
  bool keeps_history = false; // A frame may show light of earlier frames.
  // In units of the brightest valid light: the largest output, and the largest change of even
  // light.
  double maximum = 1.0 + soak_rounding, even_error = soak_rounding;
};
std::vector<StageDesc> soak_stages();

struct SoakView {
  dermis_view view = nullptr; // Null: the graph's own view.
  uint64_t frame = 0;         // The last recorded frame.
  Surface surface;
  Light light;
  double brightest_yet = 0; // Since the last cut.
  bool calm = true;         // Only even light since the last cut.
  std::map<std::string, demo::Image> images;
  std::vector<dermis_image_binding> bound;
};

struct SoakTotals {
  uint64_t frames = 0, pictures = 0, reloads = 0, rejected_reloads = 0, resizes = 0, settings = 0,
           view_settings = 0, profiles = 0, budgets = 0, cuts = 0, discards = 0, views = 0,
           graphs = 0, damaged = 0, even = 0, not_finite = 0;
  std::map<std::string, double> brightest, even_error; // By stage, the worst.
};

struct Stage {
  StageDesc desc;
  dermis_graph graph = nullptr;
  uint32_t width = soak_side, height = soak_side;
  std::vector<SoakView> views;
};

} // namespace dermis::abi_test
