#pragma once
// One graph of the soak with its views, and what may happen to it between frames.

#include "tests/integration/abi/dermis_fixture.hpp"
#include "tests/integration/soak/pictures.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dermis::abi_test {

// Light is stored in halves on its way and at its end, each time rounded by 2^-11 of its value at most.
inline constexpr double soak_rounding = 1.0 / 1024;

struct StageDesc {
  std::string name, graph;           // as graph_file() names it
  std::vector<std::string> overlays; // files of configs/overlays
  // Settings that change, with the values that they may have, as JSON.
  std::vector<std::pair<std::string, std::vector<std::string>>> settings;
  bool keeps_history = false; // a frame may show light of others
  // In units of the brightest light that counts: what comes out at most, and how far from light that was
  // even.
  double maximum = 1.0 + soak_rounding, even_error = soak_rounding;
};
std::vector<StageDesc> soak_stages();

struct SoakView {
  dermis_view view = nullptr; // null: the graph's own
  uint64_t frame = 0;         // recorded last
  Surface surface;
  Light light;
  double brightest_yet = 0; // since the last cut
  bool calm = true;         // even light alone since the last cut
  std::map<std::string, demo::Image> images;
  std::vector<dermis_image_binding> bound;
};

struct SoakTotals {
  uint64_t frames = 0, pictures = 0, reloads = 0, rejected_reloads = 0, resizes = 0, settings = 0,
           view_settings = 0, profiles = 0, budgets = 0, cuts = 0, discards = 0, views = 0, graphs = 0,
           damaged = 0, even = 0, not_finite = 0;
  std::map<std::string, double> brightest, even_error; // by stage, the worst
};

struct Stage {
  StageDesc desc;
  dermis_graph graph = nullptr;
  uint32_t width = soak_side, height = soak_side;
  std::vector<SoakView> views;
};

} // namespace dermis::abi_test
