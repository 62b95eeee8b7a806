// Draws plots with logarithmic axes, or over frames, as SVG. Colours come from the page's style:
// classes s0, s1, ... by the index of the series, and b0, b1, ... for baselines, which differ by
// line style.

#include "integration/tools/command/bench/report/html.hpp"
#include "integration/tools/command/bench/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr double width = 460, height = 300; // of the image
constexpr double left = 70, right = 14, top = 12, bottom = 44;

struct Axis {
  double low = 0, high = 1; // log10 of the values, or the values of a linear axis
  double from = 0, to = 1;  // position in the image
  bool even = false;

  double place(double value) const {
    return from + ((even ? value : std::log10(value)) - low) / (high - low) * (to - from);
  }
};

// Returns whether the plot can show the point: a zero or an infinite value has no place on a
// logarithmic axis.
bool is_shown(const Plot& plot, const PlotPoint& point) {
  const auto has_place = [](double value) { return std::isfinite(value) && value > 0; };
  return has_place(point.y) && (plot.over_frames ? std::isfinite(point.x) : has_place(point.x));
}

// Returns the plot without the points that it cannot show.
Plot shown_part(Plot plot) {
  for (PlotSeries& series : plot.series)
    std::erase_if(series.points, [&](const PlotPoint& point) { return !is_shown(plot, point); });
  return plot;
}

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
  return value == 0 || (value >= 1e-4 && value < 10000) ? fmt::format("{:.4g}", value)
                                                        : fmt::format("{:.0e}", value);
}

// Returns ticks at 1, 2, 5 of each decade; at 1 only if the axis spans many decades, more if it
// spans few.
std::vector<double> ticks(const Axis& axis) {
  if (axis.even) {
    // frames
    const double step = axis.high > 100 ? 50 : axis.high > 40 ? 10 : axis.high > 8 ? 5 : 1;
    std::vector<double> frames;
    for (double at = 0; at <= axis.high; at += step)
      frames.push_back(at);
    return frames;
  }
  constexpr double mantissas[] = {1, 2, 5, 3, 7, 1.5, 4, 6, 8};
  const double decades = axis.high - axis.low;
  const size_t count = decades > 3.5   ? 1
                       : decades > 1   ? 3
                       : decades > 0.6 ? 5
                                       : std::size(mantissas);
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
    svg +=
        fmt::format("<line class=grid x1={0:.1f} x2={0:.1f} y1={1} y2={2} /><text x={0:.1f} y={3} "
                    "text-anchor=middle>{4}</text>",
                    x.place(tick), top, height - bottom, height - bottom + 15, number(tick));
  for (const double tick : ticks(y))
    svg +=
        fmt::format("<line class=grid x1={1} x2={2} y1={0:.1f} y2={0:.1f} /><text x={3} y={4:.1f} "
                    "text-anchor=end>{5}</text>",
                    y.place(tick), left, width - right, left - 5, y.place(tick) + 4, number(tick));
  svg += fmt::format("<text x={} y={} text-anchor=middle>{}</text>", (left + width - right) / 2,
                     height - 8, html_text(plot.x_title));
  svg += fmt::format("<text transform='translate(13 {}) rotate(-90)' text-anchor=middle>{}</text>",
                     (top + height - bottom) / 2, html_text(plot.y_title));
}

void add_front(std::string& svg, const Plot& plot, const Axis& x, const Axis& y) {
  std::vector<PlotPoint> front;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points)
      if (point.on_front) front.push_back(point);
  std::sort(front.begin(), front.end(),
            [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  if (front.size() < 2) return;
  svg += "<polyline class=front points='";
  for (const PlotPoint& point : front)
    svg += fmt::format("{:.1f},{:.1f} ", x.place(point.x), y.place(point.y));
  svg += "' />";
}

} // namespace

size_t place_of(const std::vector<SeriesName>& names, std::string_view name) {
  const auto at = std::find_if(names.begin(), names.end(),
                               [&](const SeriesName& one) { return one.name == name; });
  return static_cast<size_t>(at - names.begin());
}

std::string series_class(const std::vector<SeriesName>& names, size_t place) {
  constexpr std::ptrdiff_t lines = 6; // line styles for baselines
  if (!names[place].baseline) return fmt::format("s{}", place);
  const auto before =
      std::count_if(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(place),
                    [](const SeriesName& one) { return one.baseline; });
  return fmt::format("s{} base b{}", place, before % lines);
}

std::string plot_as_svg(const Plot& whole, const std::vector<SeriesName>& names) {
  const Plot plot = shown_part(whole);
  const Axis x = plot.over_frames ? frames_axis(plot, left, width - right)
                                  : axis_over(plot, &PlotPoint::x, left, width - right);
  const Axis y = axis_over(plot, &PlotPoint::y, height - bottom, top);
  std::string svg = fmt::format("<svg viewBox='0 0 {} {}' role=img aria-label='{}'>", width, height,
                                html_text(plot.title));
  add_axes(svg, plot, x, y);
  add_front(svg, plot, x, y);
  for (const PlotSeries& series : plot.series) {
    svg += fmt::format("<g class='{}'>", series_class(names, place_of(names, series.name)));
    if (plot.over_frames) {
      svg += "<polyline class=line points='";
      for (const PlotPoint& point : series.points)
        svg += fmt::format("{:.1f},{:.1f} ", x.place(point.x), y.place(point.y));
      svg += "' />";
    }
    for (const PlotPoint& point : series.points)
      svg += fmt::format("<circle cx={:.1f} cy={:.1f} r={}{}><title>{}</title></circle>",
                         x.place(point.x), y.place(point.y), plot.over_frames ? 1.5 : 5.0,
                         point.on_front ? "" : " class=open", html_text(point.label));
    svg += "</g>";
  }
  return svg + "</svg>";
}

} // namespace dermis::tools
