#include "integration/tools/command/bench/report/heat_map.hpp"

#include "integration/tools/files/heat_color.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dermis::tools {
namespace {

struct Cells {
  uint32_t width = 0, height = 0;
  std::vector<double> squares, count;
  std::vector<bool> surface;

  size_t index(uint32_t x, uint32_t y) const { return size_t{y} * width + x; }
  double error(size_t i) const { return std::sqrt(squares[i] / count[i]); }

  // Returns the mean error of measured neighbours, or a negative value without any.
  double neighbours(uint32_t x, uint32_t y) const {
    double sum = 0, found = 0;
    for (uint32_t j = y > 0 ? y - 1 : 0; j <= std::min(y + 1, height - 1); ++j)
      for (uint32_t i = x > 0 ? x - 1 : 0; i <= std::min(x + 1, width - 1); ++i)
        if (count[index(i, j)] > 0) sum += error(index(i, j)), ++found;
    return found > 0 ? sum / found : -1;
  }
};

} // namespace

ReportPicture heat_map(std::string caption, std::span<const float> light,
                       const Reference& reference, uint32_t width,
                       std::span<const uint8_t> profile) {
  const uint32_t side = reference.everywhere ? 2 : 8;
  const auto height = static_cast<uint32_t>(profile.size() / width);
  Cells cells{(width + side - 1) / side, (height + side - 1) / side, {}, {}, {}};
  cells.squares.resize(size_t{cells.width} * cells.height);
  cells.count.resize(cells.squares.size());
  cells.surface.resize(cells.squares.size());
  const auto cell_of = [&](size_t pixel) {
    return cells.index(static_cast<uint32_t>(pixel % width) / side,
                       static_cast<uint32_t>(pixel / width) / side);
  };
  for (size_t i = 0; i < profile.size(); ++i)
    if (profile[i] != 0) cells.surface[cell_of(i)] = true;
  for (size_t i = 0; i < reference.pixels.size(); ++i) {
    double error = 0;
    for (size_t c = 0; c < 3; ++c)
      error += rec709[c] *
               (double(light[size_t{3} * reference.pixels[i] + c]) - reference.light[3 * i + c]);
    error *= reference.exposure;
    cells.squares[cell_of(reference.pixels[i])] += error * error;
    cells.count[cell_of(reference.pixels[i])] += 1;
  }
  ReportPicture picture{std::move(caption), cells.width, cells.height, {}};
  for (uint32_t y = 0; y < cells.height; ++y)
    for (uint32_t x = 0; x < cells.width; ++x) {
      const size_t i = cells.index(x, y);
      const double error = !cells.surface[i]    ? -1
                           : cells.count[i] > 0 ? cells.error(i)
                                                : cells.neighbours(x, y);
      constexpr std::array<uint8_t, 3> nothing = {128, 128, 128};
      const auto rgb = error < 0 ? nothing : heat_color(error);
      picture.rgb.insert(picture.rgb.end(), rgb.begin(), rgb.end());
    }
  return picture;
}

std::string heat_map_explanation() {
  return "Error of linear luminance, root mean square over cells of 2x2 pixels (8x8 where the "
         "truth is known "
         "at a subset "
         "of the pixels), logarithmic: black 0.0001 and below, violet 0.0004, red 0.002, orange "
         "0.01, yellow "
         "0.04, nearly "
         "white 0.1 and above. Grey: no subsurface.";
}

} // namespace dermis::tools
