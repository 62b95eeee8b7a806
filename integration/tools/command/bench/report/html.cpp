#include "integration/tools/command/bench/report/html.hpp"

#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/files/png.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

// Eight hues that colour-blind readers can distinguish (Okabe & Ito 2008), adapted to the colour
// scheme. Further series reuse them with a dashed rim.
constexpr std::string_view style = R"(<style>
:root{color-scheme:light dark;--bg:#fff;--fg:#1c1e21;--dim:#63686e;--line:#d9dce0;--head:#f3f4f6;--mark:#e7f3ec;--bad:#fbe3e1;--g:#7b8188;
--c0:#0072b2;--c1:#d55e00;--c2:#009e73;--c3:#b0568f;--c4:#a37b00;--c5:#3d9bd1;--c6:#555;--c7:#c22}
@media(prefers-color-scheme:dark){:root{--bg:#16181b;--fg:#e4e6e8;--dim:#9aa0a6;--line:#33373c;--head:#202327;--mark:#1c3226;--bad:#43201f;--g:#868d95;
--c0:#56a8e0;--c1:#f08a45;--c2:#35c79b;--c3:#dd8fc0;--c4:#e6c229;--c5:#8fd0f5;--c6:#bbb;--c7:#f77}}
body{background:var(--bg);color:var(--fg);font:15px/1.5 system-ui,sans-serif;margin:2rem auto;padding:0 1.2rem;max-width:1500px}
h1{font-size:1.6rem;margin:0 0 .3rem}h2{font-size:1.15rem;margin:2.2rem 0 .6rem}p{max-width:75ch}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.1rem 1rem}dt{color:var(--dim)}dd{margin:0;overflow-wrap:anywhere}
.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.86rem;font-variant-numeric:tabular-nums}
th,td{padding:.22rem .6rem;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th{white-space:normal;vertical-align:bottom;background:var(--head);position:sticky;top:0;cursor:pointer;user-select:none}
th[aria-sort]::after{content:' \2193';color:var(--dim)}th[aria-sort=ascending]::after{content:' \2191'}th.t,td.t{text-align:left}td.wrap{white-space:normal}
tr.best td{background:var(--mark)}tr.bad td{background:var(--bad)}
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(400px,1fr));gap:1.2rem}figure{margin:0}
figcaption{font-size:.86rem;color:var(--dim)}svg{width:100%;height:auto}svg text{font-size:11px;fill:var(--dim)}
.line{fill:none;stroke:var(--c);stroke-width:1.3}.grid{stroke:var(--line)}.front{fill:none;stroke:var(--dim);stroke-width:1.2;stroke-dasharray:5 3}
.legend{display:flex;flex-wrap:wrap;gap:.3rem 1.2rem;font-size:.9rem}.legend svg{width:34px;height:14px;vertical-align:-2px}
circle{fill:var(--c);stroke:var(--c);stroke-width:1.8}circle.open{fill:var(--bg)}
.maps{display:grid;grid-template-columns:repeat(auto-fill,minmax(250px,1fr));gap:.9rem}
.maps img{width:100%;image-rendering:pixelated;border:1px solid var(--line)}
.s0,.s8{--c:var(--c0)}.s1,.s9{--c:var(--c1)}.s2,.s10{--c:var(--c2)}.s3,.s11{--c:var(--c3)}.s4,.s12{--c:var(--c4)}
.s5,.s13{--c:var(--c5)}.s6,.s14{--c:var(--c6)}.s7,.s15{--c:var(--c7)}
.base{--c:var(--g)}.b1 .line{stroke-dasharray:7 3}.b2 .line{stroke-dasharray:2 2}.b3 .line{stroke-dasharray:9 3 2 3}
.b4 .line{stroke-dasharray:11 3}.b5 .line{stroke-dasharray:4 6}
.s8 circle,.s9 circle,.s10 circle,.s11 circle,.s12 circle,.s13 circle,.s14 circle,.s15 circle{stroke-dasharray:2.5 1.5}
</style>
)";

// Unmeasured values (data-v without a number) sort last in both directions.
constexpr std::string_view script = R"(<script>
for(const th of document.querySelectorAll('th')){th.tabIndex=0;th.onclick=()=>{const body=th.closest('table').tBodies[0],
i=th.cellIndex,up=th.ariaSort!=='ascending';
for(const one of th.parentElement.cells)one.ariaSort=one===th?up?'ascending':'descending':null;
const key=r=>{const v=r.cells[i].dataset.v;return v===undefined?r.cells[i].textContent:v===''?null:+v};
const order=(x,y)=>x===null||y===null?(x===null)-(y===null):(x<y?-1:x>y?1:0)*(up?1:-1);
[...body.rows].sort((a,b)=>order(key(a),key(b))).forEach(r=>body.append(r))};
th.onkeydown=e=>{if(e.key==='Enter'||e.key===' '){e.preventDefault();th.onclick()}}}
</script>
)";

std::string cell(const ReportValue& value, const ReportColumn& column) {
  const std::string text = html_text(cell_text(value, column));
  if (const auto* flag = std::get_if<bool>(&value))
    return fmt::format("<td data-v={}>{}", *flag ? 1 : 0, text);
  if (const auto* whole = std::get_if<int64_t>(&value))
    return fmt::format("<td data-v={}>{}", *whole, text);
  if (const auto* number = std::get_if<double>(&value); number != nullptr && std::isfinite(*number))
    return fmt::format("<td data-v={}>{}", *number, text);
  if (std::holds_alternative<std::string>(value)) return "<td class=t>" + text;
  return "<td data-v=''>&ndash;";
}

bool misses(Goal goal, bool flag) {
  return (goal == Goal::advisory || goal == Goal::required) && !flag;
}

std::string_view mark_of(const ReportTable& table, const std::vector<ReportValue>& row) {
  std::string_view mark;
  for (size_t i = 0; i < row.size(); ++i) {
    const auto* flag = std::get_if<bool>(&row[i]);
    if (flag == nullptr) continue;
    const Goal goal = table.columns[i].style.goal;
    if (misses(goal, *flag)) return " class=bad";
    if (goal == Goal::best && *flag) mark = " class=best";
  }
  return mark;
}

// Returns the legend of highlighted rows, or "" if there are none.
std::string marks_text(const ReportTable& table) {
  std::string text;
  for (const ReportColumn& column : table.columns) {
    if (column.style.goal == Goal::none || count_goals(table, column.style.goal).rows == 0)
      continue;
    text += column.style.goal == Goal::best
                ? " Marked rows are on the front."
                : fmt::format(" Marked rows miss their limits (column '{}').", column.title);
  }
  return text;
}

void add_table(std::string& page, const ReportTable& table) {
  page += "<div class=wide><table><thead><tr>";
  for (size_t i = 0; i < table.columns.size(); ++i)
    if (!table.columns[i].title.empty())
      page += fmt::format("<th{} title='{}'>{}", is_text(table, i) ? " class=t" : "",
                          html_text(table.columns[i].key), html_text(table.columns[i].title));
  page += "</thead><tbody>\n";
  for (const auto& row : table.rows) {
    page += fmt::format("<tr{}>", mark_of(table, row));
    for (size_t i = 0; i < row.size(); ++i)
      if (!table.columns[i].title.empty()) page += cell(row[i], table.columns[i]);
    page += '\n';
  }
  page += "</tbody></table></div>\n";
}

void add_plots(std::string& page, const Report& report) {
  const std::vector<Plot>& plots = report.plots;
  if (plots.empty()) return;
  std::vector<SeriesName> names;
  for (const Plot& plot : plots)
    for (const PlotSeries& series : plot.series)
      if (place_of(names, series.name) == names.size())
        names.push_back({series.name, series.baseline});
  const bool frames = plots.front().over_frames;
  const std::string title = !report.plots_title.empty() ? report.plots_title
                            : frames                    ? "Frame by frame"
                                                        : "Time against error";
  const std::string text =
      !report.plots_text.empty() ? report.plots_text
      : frames                   ? "Point at a frame to see its value. Baselines are grey."
               : "Filled points are on the Pareto front: no other point is both faster "
                 "and more exact. Point at a point to see its name. Baselines are grey.";
  page += fmt::format("<h2>{}</h2><p>{}</p><div class=legend>", html_text(title), html_text(text));
  for (size_t i = 0; i < names.size(); ++i)
    page += fmt::format(
        "<span class='{}'><svg viewBox='0 0 34 14'>{}<circle cx=17 cy=7 r={} /></svg> {}</span>",
        series_class(names, i), frames ? "<path class=line d='M1 7H33' />" : "", frames ? 2 : 5,
        html_text(names[i].name));
  page += "</div><div class=plots>\n";
  for (const Plot& plot : plots)
    page += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                        plot_as_svg(plot, names), html_text(plot.title));
  page += "</div>\n";
}

void add_pictures(std::string& page, const ReportPictures& group) {
  page += fmt::format("<h2>{}</h2><p>{}</p><div class=maps>\n", html_text(group.title),
                      html_text(group.explanation));
  for (const ReportPicture& picture : group.pictures)
    page += fmt::format(
        "<figure><img alt='{0}' src='data:image/png;base64,{1}'><figcaption>{0}</figcaption>"
        "</figure>\n",
        html_text(picture.caption), base64(encode_png(picture.width, picture.height, picture.rgb)));
  page += "</div>\n";
}

} // namespace

std::string html_text(std::string_view text) {
  std::string escaped;
  for (const char c : text)
    switch (c) {
    case '&':
      escaped += "&amp;";
      break;
    case '<':
      escaped += "&lt;";
      break;
    case '>':
      escaped += "&gt;";
      break;
    case '"':
      escaped += "&quot;";
      break;
    case '\'':
      escaped += "&#39;";
      break;
    default:
      escaped += c;
    }
  return escaped;
}

std::string html_page(std::string_view title, std::string_view body) {
  std::string page = "<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport "
                     "content='width=device-width,initial-scale=1'>";
  page += fmt::format("<title>{}</title>\n", html_text(title));
  page.append(style).append("<body>").append(body).append(script);
  return page + "</body></html>\n";
}

std::string base64(std::span<const uint8_t> bytes) {
  constexpr std::string_view letters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? bytes[i + k] : 0u);
    for (size_t k = 0; k < 4; ++k)
      text += k <= count ? letters[(group >> (18 - 6 * k)) & 63] : '=';
  }
  return text;
}

std::string report_as_html(const Report& report) {
  std::string page;
  page +=
      fmt::format("<h1>{}</h1><p>{}</p><dl>\n", html_text(report.title), html_text(report.summary));
  for (const auto& [name, text] : report.info)
    page += fmt::format("<dt>{}<dd>{}\n", html_text(name), html_text(text));
  page += "</dl>\n";
  if (!report.notes.empty()) page += "<h2>Left out</h2><ul>\n";
  for (const std::string& note : report.notes)
    page += fmt::format("<li>{}\n", html_text(note));
  if (!report.notes.empty()) page += "</ul>\n";
  add_plots(page, report);
  if (!report.more.rows.empty()) {
    page += fmt::format("<h2>{}</h2><p>{}</p>\n", html_text(report.more_title),
                        html_text(report.more_text));
    add_table(page, report.more);
  }
  page +=
      fmt::format("<h2>All rows</h2><p>Click a title to sort.{}</p>\n", marks_text(report.table));
  add_table(page, report.table);
  for (const ReportPictures& group : report.pictures)
    add_pictures(page, group);
  return html_page(report.title, page);
}

} // namespace dermis::tools
