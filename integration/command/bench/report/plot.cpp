// Plots with logarithmic axes, or over frames, as SVG. Colours come from the page: classes s0, s1, ... by the
// series' place in its list.

#include "integration/command/bench/report/html.hpp"
#include "integration/command/bench/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr double width = 460, height = 300; // of the picture
constexpr double left = 58, right = 14, top = 12, bottom = 44;

struct Axis {
  double low = 0, high = 1; // log10, or the values where the axis is even
  double from = 0, to = 1;  // picture
  bool even = false;

  double place(double value) const {
    return from + ((even ? value : std::log10(value)) - low) / (high - low) * (to - from);
  }
};

Axis frames_axis(const Plot& plot, double from, double to) {
  double last = 1;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points)
      last = std::max(last, point.x);
  return {0, last, from, to, true};
}

Axis axis_over(const Plot& plot, double PlotPoint::*which, double from, double to) {
  double low = 1e300, high = 0;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points) {
      low = std::min(low, point.*which);
      high = std::max(high, point.*which);
    }
  if (!(high > 0)) low = high = 1;
  const double margin = std::max(0.05, 0.06 * std::log10(high / low));
  return {std::log10(low) - margin, std::log10(high) + margin, from, to};
}

std::string number(double value) {
  return value >= 1e-4 && value < 10000 ? fmt::format("{:.4g}", value) : fmt::format("{:.0e}", value);
}

// 1, 2, 5 of each decade; 1 alone where the axis spans many, more where it spans little.
std::vector<double> ticks(const Axis& axis) {
  if (axis.even) {
    const double step = axis.high > 100 ? 50 : axis.high > 40 ? 10 : 5; // frames
    std::vector<double> frames;
    for (double at = 0; at <= axis.high; at += step)
      frames.push_back(at);
    return frames;
  }
  constexpr double mantissas[] = {1, 2, 5, 3, 7, 1.5, 4, 6, 8};
  const double decades = axis.high - axis.low;
  const size_t count = decades > 3.5 ? 1 : decades > 1 ? 3 : decades > 0.6 ? 5 : std::size(mantissas);
  std::vector<double> all;
  for (int decade = static_cast<int>(std::floor(axis.low)); decade <= axis.high; ++decade)
    for (size_t i = 0; i < count; ++i) {
      const double at = std::log10(mantissas[i]) + decade;
      if (at >= axis.low && at <= axis.high) all.push_back(std::pow(10.0, at));
    }
  return all;
}

void add_axes(std::string& svg, const Plot& plot, const Axis& x, const Axis& y) {
  for (const double tick : ticks(x))
    svg += fmt::format("<line class=grid x1={0:.1f} x2={0:.1f} y1={1} y2={2} /><text x={0:.1f} y={3} "
                       "text-anchor=middle>{4}</text>",
                       x.place(tick), top, height - bottom, height - bottom + 15, number(tick));
  for (const double tick : ticks(y))
    svg += fmt::format("<line class=grid x1={1} x2={2} y1={0:.1f} y2={0:.1f} /><text x={3} y={4:.1f} "
                       "text-anchor=end>{5}</text>",
                       y.place(tick), left, width - right, left - 5, y.place(tick) + 4, number(tick));
  svg += fmt::format("<text x={} y={} text-anchor=middle>{}</text>", (left + width - right) / 2, height - 8,
                     html_text(plot.x_title));
  svg += fmt::format("<text transform='translate(13 {}) rotate(-90)' text-anchor=middle>{}</text>",
                     (top + height - bottom) / 2, html_text(plot.y_title));
}

void add_front(std::string& svg, const Plot& plot, const Axis& x, const Axis& y) {
  std::vector<PlotPoint> front;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points)
      if (point.on_front) front.push_back(point);
  std::sort(front.begin(), front.end(), [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  if (front.size() < 2) return;
  svg += "<polyline class=front points='";
  for (const PlotPoint& point : front)
    svg += fmt::format("{:.1f},{:.1f} ", x.place(point.x), y.place(point.y));
  svg += "' />";
}

} // namespace

std::string plot_as_svg(const Plot& plot, const std::vector<std::string>& names) {
  const Axis x = plot.over_frames ? frames_axis(plot, left, width - right)
                                  : axis_over(plot, &PlotPoint::x, left, width - right);
  const Axis y = axis_over(plot, &PlotPoint::y, height - bottom, top);
  std::string svg =
      fmt::format("<svg viewBox='0 0 {} {}' role=img aria-label='{}'>", width, height, html_text(plot.title));
  add_axes(svg, plot, x, y);
  add_front(svg, plot, x, y);
  for (const PlotSeries& series : plot.series) {
    const auto place = std::find(names.begin(), names.end(), series.name) - names.begin();
    svg += fmt::format("<g class='s{}{}'>", place, series.baseline ? " base" : "");
    if (plot.over_frames) {
      svg += "<polyline class=line points='";
      for (const PlotPoint& point : series.points)
        svg += fmt::format("{:.1f},{:.1f} ", x.place(point.x), y.place(point.y));
      svg += "' />";
    }
    for (const PlotPoint& point : series.points)
      svg += fmt::format("<circle cx={:.1f} cy={:.1f} r={}{}><title>{}</title></circle>", x.place(point.x),
                         y.place(point.y), plot.over_frames ? 1.5 : 5.0, point.on_front ? "" : " class=open",
                         html_text(point.label));
    svg += "</g>";
  }
  return svg + "</svg>";
}

} // namespace dermis::tools
