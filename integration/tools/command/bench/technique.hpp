#pragma once
// One technique at one setting, ready to run on still frames.

#include "integration/tools/command/bench/plan_file.hpp"
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

struct TechniqueTimes { // milliseconds of one run
  double device = 0;    // all passes but those that only hand light to tools
  double sampling = 0;  // the scattering passes alone: without tiles, setup and combination
};

struct TechniqueCounts { // of one frame
  uint32_t dispatches = 0;
  uint64_t transient_bytes = 0;
  double mean_spp = 0;                   // stochastic samples a subsurface pixel
  std::optional<double> reads_per_pixel; // nullopt: a pass whose reads nobody has counted
  std::string unknown_pass_type;         // then: its pass type
};

// What a frame's depth is handed over as.
enum class DepthGiven : uint8_t {
  view_distance, // as captures have it
  depth_buffer,  // what a depth test with the frame's own projection leaves; nothing there: the far plane
};

// Keeps its graph on the device from frame to frame as long as size and slots fit. One thread.
class TechniqueRun {
public:
  // Errors: input (a graph that cannot be read or compiled, a setting that is not there).
  static demo::Result<std::unique_ptr<TechniqueRun>> create(demo::VulkanHost& host,
                                                            const TechniqueRequest& request,
                                                            std::span<const CaptureProfile> profiles,
                                                            std::span<const float> sap_tables);

  // Uploads the frame and runs once; the scattered light before albedo, 3 values a pixel. `follows`: it comes
  // after the frame that was scattered last, so histories go on, where the graph says so also over another
  // size; otherwise they begin anew.
  demo::Result<std::vector<float>> scatter(const CapturedFrame& frame, bool follows = false,
                                           DepthGiven depth = DepthGiven::view_distance);
  // The next frame is the first of a new graph: frame numbers and histories begin again.
  void start_anew() { device_.reset(); }
  // The next frame has this number, if it is higher than the one that would follow.
  void skip_to(uint64_t frame_index);
  // Whether the last scatter had to make its graph: then the driver compiled, and its times say nothing.
  bool was_made_anew() const { return made_anew_; }
  // Of the last run. Errors: environment (no timestamps).
  demo::Result<TechniqueTimes> times();
  // What the last run's kernels say of their sampling, 3 values a pixel: samples, those behind the history,
  // confidence. Empty where the graph does not hand it out.
  demo::Result<std::vector<float>> sampling();
  uint64_t history_bytes();
  // Runs the last frame again, on whatever light is there.
  demo::Result<TechniqueTimes> run_again();
  // Of the last frame. `sampled_fraction`: of its subsurface pixels, those whose light is scattered at all;
  // `d_px`: its median d per channel; `taken`: samples a subsurface pixel where they were counted on the
  // device.
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
  uint64_t next_frame_index_ = 0; // 0: as it comes
};

} // namespace dermis::tools
