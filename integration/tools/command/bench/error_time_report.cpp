#include "integration/tools/command/bench/error_time_report.hpp"

#include "integration/tools/command/bench/quick.hpp"
#include "integration/tools/command/bench/report/heat_map.hpp"
#include "integration/tools/command/bench/report/pareto.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

struct Spread {
  double median = 0, low = 0, high = 0; // low and high: 10 % and 90 %
};

Spread spread_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto at = [&](double fraction) {
    return values[static_cast<size_t>(fraction * double(values.size() - 1) + 0.5)];
  };
  return {at(0.5), at(0.1), at(0.9)};
}

std::vector<ReportColumn> error_time_columns() {
  return {{"scene", "scene"},
          {"d_px", "d, px"},
          {"framing", "framing"},
          {"technique", "technique"},
          {"setting", "setting"},
          {"device_ms", "ms", 4},
          {"device_ms_low", ""},
          {"device_ms_high", ""},
          {"repetitions", ""},
          {"sampling_ms", "scattering ms", 4},
          {"mean_spp", "samples"},
          {"reads_per_pixel", "reads a pixel"},
          {"rmse", "RMSE"},
          {"rmse_low", ""},
          {"rmse_high", ""},
          {"rmse_r", ""},
          {"rmse_g", ""},
          {"rmse_b", ""},
          {"psnr_db", "PSNR dB", 4},
          {"max_error", "largest"},
          {"p99_error", "99 %"},
          {"psnr_db_sdr8", "8-bit dB", 4},
          {"psnr_db_self", "self dB", 4},
          {"transient_bytes", "bytes"},
          {"dispatches", "dispatches"},
          {"time_ratio", "ms / baseline"},
          {"rmse_ratio", "RMSE / baseline"},
          {"pixels", ""},
          {"population", ""},
          {"on_pareto_front", "front"}};
}

void fill_table(const ErrorTimeBench& bench, Report& report) {
  report.table.columns = error_time_columns();
  const size_t count = bench.techniques.size();
  for (size_t first = 0; first < bench.measured.size(); first += count) {
    std::vector<Cost> costs;
    const ErrorTimeRow* baseline = nullptr;
    for (size_t i = first; i < first + count; ++i) {
      const ErrorTimeRow& one = bench.measured[i];
      costs.push_back({spread_of(one.device_ms).median, one.error.figures.rmse});
      const TechniqueRequest& request = bench.techniques[one.technique]->request();
      if (request.technique == bench.file.baseline_technique &&
          request.setting == bench.file.baseline_setting)
        baseline = &one;
    }
    const std::vector<bool> front = pareto_front(costs);
    for (size_t i = first; i < first + count; ++i) {
      const ErrorTimeRow& one = bench.measured[i];
      const Subject& subject = bench.subjects[one.subject];
      const TechniqueRequest& request = bench.techniques[one.technique]->request();
      const Spread device = spread_of(one.device_ms);
      const ErrorFigures& error = one.error.figures;
      const auto optional = [](const std::optional<double>& value) {
        return value ? ReportValue(*value) : ReportValue();
      };
      ReportValue time_ratio, rmse_ratio;
      if (baseline != nullptr) {
        time_ratio = device.median / spread_of(baseline->device_ms).median;
        if (baseline->error.figures.rmse > 0) rmse_ratio = error.rmse / baseline->error.figures.rmse;
      }
      report.table.rows.push_back({subject.scene,
                                   subject.d_px,
                                   subject.framing,
                                   request.technique,
                                   request.setting,
                                   device.median,
                                   device.low,
                                   device.high,
                                   static_cast<int64_t>(one.device_ms.size()),
                                   spread_of(one.sampling_ms).median,
                                   one.counts.mean_spp,
                                   optional(one.counts.reads_per_pixel),
                                   error.rmse,
                                   error.rmse_low,
                                   error.rmse_high,
                                   error.rmse_rgb[0],
                                   error.rmse_rgb[1],
                                   error.rmse_rgb[2],
                                   error.psnr_db,
                                   error.max_error,
                                   error.p99_error,
                                   one.error.psnr_db_sdr8,
                                   optional(one.psnr_db_self),
                                   static_cast<int64_t>(one.counts.transient_bytes),
                                   static_cast<int64_t>(one.counts.dispatches),
                                   time_ratio,
                                   rmse_ratio,
                                   static_cast<int64_t>(error.pixels),
                                   static_cast<int64_t>(one.error.population),
                                   static_cast<bool>(front[i - first])});
    }
  }
}

void fill_plots(const ErrorTimeBench& bench, Report& report) {
  for (size_t s = 0; s < bench.subjects.size(); ++s) {
    const Subject& subject = bench.subjects[s];
    Plot plot{fmt::format("{} {}, d = {:.2f} px", subject.scene, subject.framing, subject.d_px),
              "device time, ms",
              "RMSE of linear luminance",
              {}};
    for (size_t row = 0; row < bench.measured.size(); ++row) {
      const ErrorTimeRow& one = bench.measured[row];
      if (one.subject != s || !(one.error.figures.rmse > 0)) continue;
      const TechniqueRequest& request = bench.techniques[one.technique]->request();
      if (plot.series.empty() || plot.series.back().name != request.technique)
        plot.series.push_back({request.technique, {}, is_baseline(request.technique)});
      const double ms = spread_of(one.device_ms).median;
      plot.series.back().points.push_back({ms, one.error.figures.rmse,
                                           fmt::format("{} {}: {:.2f} ms, RMSE {:.5f}", request.technique,
                                                       request.setting, ms, one.error.figures.rmse),
                                           std::get<bool>(report.table.at(row, "on_pareto_front"))});
    }
    report.plots.push_back(std::move(plot));
  }
}

std::string early_end(const ErrorTimeFile& file) {
  if (file.row_milliseconds == 0) return "";
  return fmt::format("; a technique ends early on a scene after {} ms, but not before {}",
                     file.row_milliseconds, file.min_repetitions);
}

} // namespace

Report make_error_time_report(const ErrorTimeBench& bench, double seconds) {
  Report report;
  report.bench = "error-time";
  report.title = "Run time and error";
  report.summary =
      "Error of the scattered light before albedo against the fp64 truth: linear Rec.709 luminance, the "
      "scene's 99.9th percentile of light at 1. Time is the sum of the device's timestamps over all passes "
      "of a technique.";
  report.info = machine_info(bench.session.command, bench.host.properties.deviceName);
  report.info.emplace_back("size",
                           fmt::format("{}x{} pixels", bench.options.size.width, bench.options.size.height));
  report.info.emplace_back("repetitions",
                           fmt::format("median of {} after {} to warm up, all techniques in turn{}",
                                       bench.file.repetitions, bench.file.warm_up, early_end(bench.file)));
  report.info.emplace_back(
      "truth", fmt::format("everywhere on planes, else at {} stratified pixels", bench.file.subset));
  report.info.emplace_back(
      "reads a pixel",
      "counted from the kernels' source (integration/tools/references/image_reads.cpp) times "
      "the texels each pass computes for a pixel of the view");
  report.info.emplace_back("baseline",
                           fmt::format("{} {}", bench.file.baseline_technique, bench.file.baseline_setting));
  if (bench.options.quick) report.info.push_back(quick_fact());
  report.info.emplace_back("took", format_duration(seconds));
  report.notes = bench.notes;
  report.pictures.push_back(scene_pictures(bench.subjects));
  fill_table(bench, report);
  fill_plots(bench, report);
  report.pictures.push_back(bench.maps);
  return report;
}

std::string text_of_error_time(const Report& report) {
  Table table;
  table.columns = {{"scene"},         {"framing"},     {"d px", true}, {"technique"},
                   {"setting"},       {"ms", true},    {"RMSE", true}, {"PSNR dB", true},
                   {"largest", true}, {"reads", true}, {"front"}};
  std::string last;
  for (size_t i = 0; i < report.table.rows.size(); ++i) {
    const auto text = [&](const char* key, int digits = 0) { return report.table.text_at(i, key, digits); };
    const std::string here = text("scene") + text("framing") + text("d_px", 3);
    if (!last.empty() && here != last) table.rows.emplace_back();
    last = here;
    table.rows.push_back({text("scene"), text("framing"), text("d_px", 2), text("technique"), text("setting"),
                          text("device_ms", 2), text("rmse", 5), text("psnr_db", 2), text("max_error", 4),
                          text("reads_per_pixel", 1),
                          std::get<bool>(report.table.at(i, "on_pareto_front")) ? "*" : ""});
  }
  return format_table(table);
}

} // namespace dermis::tools
