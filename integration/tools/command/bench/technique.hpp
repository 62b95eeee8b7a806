#pragma once
// Runs one technique at one setting on still frames.

#include "integration/tools/command/bench/suite/bench_file.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/run/apply_slots.hpp"
#include "integration/tools/command/run/device_graph.hpp"
#include "passes/common/reference/reference.hpp"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// Type of the pass that exports light for tools and for hosts that apply albedo later; not part of
// a technique.
inline constexpr std::string_view export_scattered_type = "subsurface.export_scattered";

struct TechniqueTimes { // milliseconds per run
  double device = 0;    // all passes except those that only export light
  double sampling = 0;  // only the scattering passes, without tiles, setup and combination
};

struct TechniqueCounts { // of one frame
  uint32_t dispatches = 0;
  uint64_t transient_bytes = 0;
  double mean_spp = 0;                   // stochastic samples per subsurface pixel
  std::optional<double> reads_per_pixel; // nullopt: the reads of a pass are unknown
  std::string unknown_pass_type;         // that pass's type
};

// The form in which a frame's depth is passed.
enum class DepthGiven : uint8_t {
  view_distance, // as in captures
  depth_buffer,  // as a depth test with the frame's projection; background is the far plane
};

// Returns d per channel of the most frequent profile, scaled so that its widest channel projects to
// `d_px`.
subsurface::PerChannel d_of(const CapturedFrame& frame, double d_px);

// Keeps its graph on the device between frames as long as size and slots fit. One thread.
class TechniqueRun {
public:
  // Errors: input (a graph that cannot be read or compiled, an unknown setting).
  static demo::Result<std::unique_ptr<TechniqueRun>>
  create(demo::VulkanHost& host, const TechniqueRequest& request,
         std::span<const CaptureProfile> profiles, std::span<const float> sap_tables);

  // Uploads the frame, runs once and returns the scattered light before albedo, 3 values per pixel.
  // If `follows`, the frame follows the last scattered frame and histories continue, also after a
  // change of size if the graph declares so. Otherwise histories restart.
  demo::Result<std::vector<float>> scatter(const CapturedFrame& frame, bool follows = false,
                                           DepthGiven depth = DepthGiven::view_distance);
  // Sets the budget of the next frames, after the first. Errors: those of DeviceGraph::set_budget.
  demo::Result<> set_budget(const dermis_budget& budget) { return device_->set_budget(budget); }
  // Returns the choice of the last frame; nullopt if nothing was counted.
  std::optional<demo::ReportedFrame> choice() { return device_->choice(); }
  // Makes the next frame the first of a new graph: frame numbers and histories restart.
  void start_anew() { device_.reset(); }
  // Sets the seconds that the host states between frames; 0: not stated.
  void set_frame_seconds(float seconds) { frame_seconds_ = seconds; }
  // Sets the number of the next frame if it is higher than the regular next number.
  void skip_to(uint64_t frame_index);
  // Returns whether the last scatter created its graph. The driver then compiled, and times are
  // meaningless.
  bool was_made_anew() const { return made_anew_; }
  // Returns times of the last run. Errors: environment (no timestamps).
  demo::Result<TechniqueTimes> times();
  // Returns times of the last run if it was long, else of run_again(): a GPU waits while images are
  // uploaded and read.
  demo::Result<TechniqueTimes> times_at_full_clock();
  // Returns the sampling data of the last run, 3 values per pixel: samples, samples behind the
  // history, confidence. Empty if the graph does not export sampling data.
  demo::Result<std::vector<float>> sampling();
  uint64_t history_bytes();
  // Runs the last frame again, on the light left by the previous run. Repeats a short frame until a
  // GPU, which slows down while it waits, has reached its clock rate; the number of the next frame
  // then depends on the device's speed. Returns times of the last run.
  demo::Result<TechniqueTimes> run_again();
  // Returns counts of the last frame. `sampled_fraction` is the fraction of its subsurface pixels
  // that scatter; `d_px` is its median d per channel; `taken` is the number of samples per
  // subsurface pixel, if counted on the device.
  TechniqueCounts counts(double sampled_fraction, const subsurface::PerChannel& d_px,
                         std::optional<double> taken = {});

  const TechniqueRequest& request() const { return request_; }

private:
  TechniqueRun(demo::VulkanHost& host, TechniqueRequest request)
      : host_(host), request_(std::move(request)) {}
  demo::Result<> prepare(const CapturedFrame& frame, const SlotChoice& slots, bool follows);

  demo::VulkanHost& host_;
  TechniqueRequest request_;
  LoadedGraph loaded_;
  std::string text_;
  std::vector<DeviceGraphRequest::Profile> profiles_;
  std::span<const float> sap_tables_;
  DeviceGraphRequest made_for_;
  CompiledPlan plan_;
  std::unique_ptr<DeviceGraph> device_;
  bool made_anew_ = false;
  dermis_frame frame_ = DERMIS_FRAME_INIT;
  float frame_seconds_ = 0;
  uint64_t next_frame_index_ = 0; // 0: regular numbering
};

} // namespace dermis::tools
