// dermis bench dynamic: measures techniques over sequences of frames with changing light, camera or
// objects.

#include "integration/tools/command/bench/dynamic/accumulation.hpp"
#include "integration/tools/command/bench/dynamic/combined_reference.hpp"
#include "integration/tools/command/bench/dynamic/comparison.hpp"
#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/bench/suite/techniques.hpp"
#include "integration/tools/command/bench/technique.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "passes/common/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dermis::tools {
namespace {

struct MeasuredSequence {
  std::vector<FrameLight> light;                              // one per frame
  std::vector<double> device_ms, sampling_ms, spp, group_spp; // one per frame
  Accumulation accumulation;                                  // used if camera or surfaces move
  SequenceFigures figures;
  TechniqueCounts counts;
  uint64_t history_bytes = 0;
};

struct DynamicBench {
  SuiteRun& run;
  const DynamicFile& file;
  demo::VulkanHost& host;
  std::vector<DynamicTechnique> techniques;
  std::vector<float> sap_tables = {};
  std::vector<DynamicRow> rows = {};
};

double mean_of(const std::vector<double>& values, uint32_t first) {
  if (values.size() <= first) return 0;
  return std::accumulate(values.begin() + first, values.end(), 0.0) / double(values.size() - first);
}
double largest_of(const std::vector<double>& values, uint32_t first) {
  return values.size() <= first ? 0 : *std::max_element(values.begin() + first, values.end());
}

struct SampleCounts {
  double mean = 0;     // over pixels with a profile
  double in_group = 0; // mean over the same pixels of the most samples in the pixel's tile
};

// `sampling` has 3 values per pixel, of which the first is the number of samples.
SampleCounts count_samples(const std::vector<float>& sampling, const CapturedFrame& frame) {
  constexpr uint32_t side = 8; // pixels of a tile, which is a group on a GPU
  const uint32_t width = frame.description.width, height = frame.description.height;
  double sum = 0, in_groups = 0, pixels = 0;
  for (uint32_t top = 0; top < height; top += side)
    for (uint32_t left = 0; left < width; left += side) {
      double most = 0, covered = 0;
      for (uint32_t y = top; y < std::min(top + side, height); ++y)
        for (uint32_t x = left; x < std::min(left + side, width); ++x) {
          const size_t pixel = size_t{y} * width + x;
          if (frame.profile[pixel] == 0) continue;
          const auto samples = double(sampling[3 * pixel]);
          sum += samples;
          most = std::max(most, samples);
          covered += 1;
        }
      in_groups += most * covered;
      pixels += covered;
    }
  return pixels > 0 ? SampleCounts{sum / pixels, in_groups / pixels} : SampleCounts{};
}

demo::Result<> measure_frame(const DynamicBench& bench, const Sequence& sequence, size_t t,
                             TechniqueRun& run, const Reference& reference,
                             MeasuredSequence& measured) {
  const SequenceFrame& frame = sequence.frames[t];
  auto light = run.scatter(frame.captured, t > 0 && !frame.cut);
  if (!light) return light.error();
  FrameLight chosen{{}, reference.light};
  for (const uint32_t pixel : reference.pixels)
    for (size_t c = 0; c < 3; ++c)
      chosen.found.push_back(double((*light)[size_t{3} * pixel + c]));
  if (!sequence.request.still) {
    const auto& mean = measured.accumulation.add(frame.captured, *light, t > 0 && !frame.cut);
    for (const uint32_t pixel : reference.pixels)
      chosen.accumulated.insert(chosen.accumulated.end(), mean[pixel].light.begin(),
                                mean[pixel].light.end());
  }
  measured.light.push_back(std::move(chosen));
  const auto times = run.times();
  if (!times) return times.error();
  measured.device_ms.push_back(times->device);
  measured.sampling_ms.push_back(times->sampling);
  auto sampling = run.sampling();
  if (!sampling) return sampling.error();
  if (!sampling->empty()) {
    const SampleCounts counts = count_samples(*sampling, frame.captured);
    measured.spp.push_back(counts.mean);
    measured.group_spp.push_back(counts.in_group);
  }
  if (t + 1 == sequence.frames.size()) {
    std::optional<double> taken;
    if (!measured.spp.empty()) taken = mean_of(measured.spp, bench.file.counted);
    measured.counts = run.counts(1, d_of(frame.captured, sequence.d_px), taken);
    measured.history_bytes = run.history_bytes();
  }
  return demo::success();
}

Plot frames_plot(const SequenceRequest& request, const char* what, const char* axis) {
  return {fmt::format("{} {}, {} of each frame", request.scene, request.framing, what),
          "frame",
          axis,
          {},
          true};
}

// Returns a series over frames. `point` returns a frame's value and its text.
template <class Point>
PlotSeries series_of(const DynamicTechnique& technique, size_t frames, Point point) {
  PlotSeries series{
      technique.technique + " " + technique.guidance, {}, is_baseline(technique.technique)};
  for (size_t t = 0; t < frames; ++t) {
    const auto [value, text] = point(t);
    series.points.push_back({double(t), value,
                             fmt::format("{} {} {}, frame {}: {}", technique.technique,
                                         technique.guidance, technique.setting, t, text),
                             false});
  }
  return series;
}

void add_plots(DynamicBench& bench, const Sequence& sequence,
               const std::vector<MeasuredSequence>& all) {
  Plot errors = frames_plot(sequence.request, "error", "RMSE of linear luminance");
  Plot samples = frames_plot(sequence.request, "samples", "samples a pixel");
  for (size_t i = 0; i < all.size(); ++i) {
    const std::vector<double>& psnr_db = all[i].figures.psnr_db;
    errors.series.push_back(series_of(bench.techniques[i], psnr_db.size(), [&](size_t t) {
      return std::pair(std::pow(10.0, -psnr_db[t] / 20), fmt::format("{:.2f} dB", psnr_db[t]));
    }));
    const std::vector<double>& spp = all[i].spp;
    constexpr double min_shown = 0.1; // lower bound for the logarithmic axis
    if (!spp.empty())
      samples.series.push_back(series_of(bench.techniques[i], spp.size(), [&](size_t t) {
        return std::pair(std::max(spp[t], min_shown), fmt::format("{:.2f}", spp[t]));
      }));
  }
  bench.run.report.plots.push_back(std::move(errors));
  if (!samples.series.empty()) bench.run.report.plots.push_back(std::move(samples));
}

DynamicRow row_of(const Sequence& sequence, const DynamicTechnique& technique,
                  const MeasuredSequence& one, uint32_t counted) {
  DynamicRow row{sequence.request.scene, sequence.request.framing, sequence.d_px, technique};
  row.mean_spp = one.spp.empty() ? one.counts.mean_spp : mean_of(one.spp, counted);
  row.peak_spp = one.spp.empty() ? one.counts.mean_spp : largest_of(one.spp, counted);
  row.group_spp = one.spp.empty() ? one.counts.mean_spp : mean_of(one.group_spp, counted);
  row.reads_per_pixel = one.counts.reads_per_pixel;
  row.mean_ms = mean_of(one.device_ms, counted);
  row.max_ms = largest_of(one.device_ms, counted);
  row.sampling_ms = mean_of(one.sampling_ms, counted);
  row.figures = one.figures;
  if (sequence.request.still) row.flicker = one.figures.flicker;
  row.history_bytes = one.history_bytes;
  if (one.spp.size() > counted) row.spp.assign(one.spp.begin() + counted, one.spp.end());
  return row;
}

demo::Result<> measure_sequence(DynamicBench& bench, SequenceRequest request) {
  SuiteRun& run = bench.run;
  if (const uint64_t frames = run.number("frames"); frames > 0) request.frames = uint32_t(frames);
  if (request.frames <= bench.file.counted)
    return demo::Error{demo::ErrorKind::usage,
                       fmt::format("{} {} has {} frames, but frames are counted from number {} on; "
                                   "expected more frames",
                                   request.scene, request.framing, request.frames,
                                   bench.file.counted)};
  auto rendered =
      render_sequence(request, run.size().width, run.size().height, head_model(run.text("head")));
  if (!rendered) return rendered.error();
  const Sequence sequence = rendered.take();

  std::vector<std::unique_ptr<TechniqueRun>> runs;
  for (const DynamicTechnique& technique : bench.techniques) {
    auto made = TechniqueRun::create(bench.host, technique,
                                     sequence.frames.front().captured.description.profiles,
                                     bench.sap_tables);
    if (!made) return made.error();
    runs.push_back(made.take());
  }
  std::vector<MeasuredSequence> all(runs.size());
  const std::string name = fmt::format("{} {}", request.scene, request.framing);
  Progress progress = run.progress("frame", sequence.frames.size(), name);
  KnownReferences known;
  for (size_t t = 0; t < sequence.frames.size(); ++t) {
    progress.update(t);
    const CapturedFrame& frame = sequence.frames[t].captured;
    const std::string what = fmt::format("reference of {}, frame {}", name, t),
                      cache = run.text("cache");
    const uint32_t subset = bench.file.subset;
    const auto reference =
        request.still ? make_reference_of_still(run.session, frame, what, subset, cache, known)
                      : make_reference(run.session, frame, what, subset, cache);
    if (!reference || interrupted()) return stopped();
    for (size_t i = 0; i < runs.size(); ++i)
      if (auto done = measure_frame(bench, sequence, t, *runs[i], *reference, all[i]); !done)
        return done;
  }
  for (size_t i = 0; i < all.size(); ++i) {
    all[i].figures =
        sequence_figures(all[i].light, bench.file.counted, request.still, sequence.exposure);
    bench.rows.push_back(row_of(sequence, bench.techniques[i], all[i], bench.file.counted));
  }
  add_plots(bench, sequence, all);
  return demo::success();
}

// Shortens a file for --quick.
void quicken(DynamicFile& file) {
  constexpr uint32_t more_frames = 2; // after those in which histories start
  file.counted = std::min(file.counted, more_frames);
  file.subset = std::min(file.subset, quick_subset);
  for (SequenceRequest& scene : file.scenes)
    scene.frames = std::min(scene.frames, file.counted + more_frames);
}

demo::Result<> measure_dynamic(SuiteRun& run, const Emit<DynamicRow>& emit) {
  auto read = run.read(read_dynamic);
  if (!read) return read.error();
  DynamicFile file = read.take();
  if (run.quick) quicken(file);
  auto techniques = select_techniques(run, file.techniques);
  if (!techniques) return techniques.error();
  std::vector<std::string> scenes, framings;
  for (const SequenceRequest& request : file.scenes) {
    scenes.push_back(request.scene);
    framings.push_back(request.framing);
  }
  if (auto good = check_names(run, "scenes", scenes); !good) return good;
  if (auto good = check_names(run, "framings", framings); !good) return good;
  const auto host = run.open_device();
  if (!host) return host.error();
  DynamicBench bench{run, file, **host, techniques.take(),
                     subsurface::make_shared_sap_tables({true, true})};
  std::vector<std::string> known;
  for (const SequenceRequest& request : file.scenes) {
    known.push_back(fmt::format("{} {}", request.scene, request.framing));
    if (run.is_requested("scenes", request.scene) && run.is_requested("framings", request.framing))
      if (auto done = measure_sequence(bench, request); !done) return done;
  }
  if (bench.rows.empty()) return no_scene_selected(std::move(known));
  run.add_info("size", fmt::format("{}x{} pixels", run.size().width, run.size().height));
  run.add_info("truth", fmt::format("at {} stratified pixels a frame", file.subset));
  run.add_info("frames", fmt::format("counted from number {} of each sequence on", file.counted));
  add_comparisons(run.report, bench.rows);
  add_published(run.report, bench.rows);
  for (const DynamicRow& row : bench.rows)
    emit(row);
  return demo::success();
}

template <auto Member> ReportValue of_technique(const DynamicRow& row) {
  return row.technique.*Member;
}

template <auto Figure> ReportValue figure_of(const DynamicRow& row) {
  return row.figures.*Figure;
}

} // namespace

Suite dynamic_suite() {
  using Row = DynamicRow;
  const ColumnStyle page{.in_text = false}, four{.digits = 4},
      four_on_page{.digits = 4, .in_text = false};
  return make_suite<Row>(
      {.name = "dynamic",
       .what = "Measure samples, time, error and flicker with changing light, camera or objects",
       .title = "Changing light, cameras and objects",
       .summary = "Error of the scattered light before albedo against the fp64 reference of each "
                  "frame: linear "
                  "Rec.709 luminance, the sequence's 99.9th percentile of light at 1. Samples are "
                  "counted on "
                  "the device.",
       .options = {size_option({320, 180}),
                   {"frames", "Frames per sequence; 0: as in the file", 0u, "", 0u, 0, 3600},
                   head_option("Folder of the head scan, which replaces the bust"),
                   only_option("scenes"),
                   only_option("framings"),
                   only_option("techniques"),
                   file_option("tests/benchmark/dynamic.json"),
                   cache_option()}},
      {{"scene", "scene", &Row::scene, {.groups = true}},
       {"d_px", "d, px", &Row::d_px, page},
       {"framing", "framing", &Row::framing, {.groups = true}},
       {"technique", "technique", of_technique<&DynamicTechnique::technique>},
       {"setting", "setting", of_technique<&DynamicTechnique::setting>},
       {"guidance", "guidance", of_technique<&DynamicTechnique::guidance>},
       {"min_samples", "least samples", of_technique<&DynamicTechnique::min_samples>, page},
       {"mean_spp", "samples", &Row::mean_spp},
       {"peak_spp", "most samples", &Row::peak_spp},
       {"group_spp", "most samples in a tile", &Row::group_spp},
       {"reads_per_pixel", "reads a pixel", &Row::reads_per_pixel, page},
       {"mean_ms", "ms", &Row::mean_ms, four},
       {"max_ms", "longest ms", &Row::max_ms, four_on_page},
       {"sampling_ms", "scattering ms", &Row::sampling_ms, four_on_page},
       {"psnr_db_frame", "PSNR dB", figure_of<&SequenceFigures::psnr_db_frame>, four},
       {"psnr_db_accumulated", "accumulated dB", figure_of<&SequenceFigures::psnr_db_accumulated>,
        four},
       {"psnr_db_sdr8", "8-bit dB", figure_of<&SequenceFigures::psnr_db_sdr8>, four_on_page},
       {"flicker", "flicker", &Row::flicker},
       {"history_bytes", "history bytes", &Row::history_bytes, page}},
      measure_dynamic);
}

} // namespace dermis::tools
