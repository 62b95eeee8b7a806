#pragma once
// Renders a scene frame by frame without a window, with or without Dermis. Returns what an engine,
// its graph and its user see: pictures, the graph's inputs as floats, the camera, device times.

#include "integration/examples/demo_engine/budget.hpp"
#include "integration/examples/demo_engine/context_hooks.hpp"
#include "integration/examples/demo_engine/kernel_shape.hpp"
#include "integration/examples/demo_engine/result.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace demo {

// A glTF file that replaces each object of shape "model". Maps override those of the file.
struct ModelOptions {
  std::string mesh;                     // .glb or .gltf; "" = none
  std::string albedo, normal, specular; // image files; "" = none
  double height_metres = 0.0;           // height in metres; 0 = as in the file
  bool operator==(const ModelOptions&) const = default;
};

// A static perspective camera that replaces the scene's camera.
struct CameraPlace {
  std::array<double, 3> position{}, target{}; // metres
  double vertical_fov = 25.0;                 // degrees, 1..150
  bool operator==(const CameraPlace&) const = default;
};

struct RenderOptions {
  std::string scene; // scene file
  // Graph file; "" = without Dermis: light times albedo, as in an engine before the integration.
  std::string graph;
  std::string graph_text;          // text of the graph; "" = that of the file
  std::vector<NamedText> overlays; // overlays of the graph, in order
  // Opens files that the graph includes.
  std::function<std::optional<NamedText>(const std::string& name)> include;
  // Opens shaders that replace those of the library ("sap/subsurface_sap_up.comp", "sap/sap.glsl").
  // Empty: no replacements.
  std::function<std::optional<NamedText>(const std::string& name)> shaders = {};
  ModelOptions model;
  // File that replaces each of the scene's profiles; "" = the profiles of the scene.
  std::string profile;
  // Folders that scene and model may read from, in addition to their own.
  std::vector<std::string> roots = {};
  uint32_t width = 640, height = 360; // pixels, 1..16384
  uint32_t first_frame = 0, frames = 1;
  double frames_per_second = 0;     // 0: the scene's
  bool reversed_depth = false;      // far plane at depth 0
  bool jitter = false;              // sub-pixel camera jitter (Halton 2, 3; period 8)
  bool taa = false;                 // temporal anti-aliasing of `color`, with jitter
  bool sampling = false;            // reads back the graph's `sampling` output
  bool tile_class = false;          // reads back the graph's `tile_class` output
  std::vector<std::string> unbound; // optional slots of the graph that are not bound
  bool validation = false;          // run under the Khronos validation layer
  KernelShape kernels = KernelShape::by_device;
  std::string device; // part of the device's name; "" = choose
  std::optional<CameraPlace> camera;
  // Magnification by a smaller field of view of the camera; > 0.
  double zoom = 1.0;
  double pixel_aspect = 0; // width / height of a pixel, 1/8..8; 0: the scene's
  // settings of the graph: name, JSON text
  std::vector<std::pair<std::string, std::string>> settings;
  Budget budget;
  // Returns texts with which the graph is reloaded before a frame, in order. A text with errors
  // leaves the graph unchanged. May be empty. The graph must include nothing.
  std::function<std::vector<std::string>(uint32_t frame)> reloads = {};
  // Returns whether a frame's pictures are read back. Empty: for every frame.
  std::function<bool(uint32_t frame)> pictures_of = {};
  // Returns whether a frame's inputs are read back. Empty: if its pictures are.
  std::function<bool(uint32_t frame)> inputs_of = {};
  ContextHooks hooks = {}; // hooks of a new cache's context
};

// Pixels row by row from the top left; `channels` floats per pixel.
struct FloatImage {
  uint32_t width = 0, height = 0, channels = 0;
  std::vector<float> texels;
};

struct ScatteringProfile {
  uint32_t id = 0;  // id in the profile image; 1..255
  std::string name; // name in the scene
  std::string file; // path of the profile file
};

// Matrices act on column vectors and are listed row by row, as in dermis.h.
struct FrameCamera {
  bool orthographic = false;
  std::array<float, 16> clip_from_view{}, view_from_world{};
  std::array<float, 16> previous_clip_from_view{}, previous_view_from_world{};
  std::array<float, 2> jitter_pixels{};
  float metres_per_unit = 1.0f;
};

struct PassTime {
  std::string pass;
  double milliseconds = 0.0; // device time
};

// A phase of the host's thread, in milliseconds since rendering began. Phases are consecutive.
struct HostPhase {
  std::string name;
  double begin_ms = 0.0, end_ms = 0.0;
};

// The graph's inputs, read back before the graph ran. The comments give the number of channels.
struct GraphInputs {
  FloatImage lighting; // 3: diffuse light before albedo
  FloatImage depth;    // 1: metres along the view axis, 0 = nothing visible
  FloatImage normal;   // 3: geometric normal in view space, unit length; 0 if nothing is visible
  FloatImage albedo;   // 3: linear
  FloatImage profile;  // 1: id, 0 = no subsurface
  FloatImage velocity; // 2: pixels, now - previous, +x right, +y down, without jitter
  FloatImage specular; // 3: reflected light, not an input of the graph
  // For the light with the most transmission from behind: thickness of the object along its
  // direction, metres (1), and irradiance on the far side (3).
  FloatImage thickness, back_lighting;
};

// The library's choice for the frame and its expectations.
struct FrameChoice {
  // next_better: the more accurate configuration that exceeds the budget by least time; "": none.
  std::string configuration, technique, why, next_better;
  double budget_ms = 0, predicted_ms = 0, predicted_margin_ms = 0, measured_ms = -1,
         calibrated_ms = 0, predicted_rmse = 0;
  double next_better_missing_ms = 0, mean_d_px = 0;
  double mean_relief = -1; // negative: not counted
  uint32_t configurations = 1, view_tiles = 0, scattering_tiles = 0, copied_tiles = 0, switches = 0;
  uint32_t uniform_tiles = 0, dispatches = 0;
  uint64_t groups = 0;
  std::array<uint32_t, 3> sampled_tiles{};      // tiles with 8, 16, 32 samples per pixel
  uint32_t sample_units = 0, sample_demand = 0; // units spent; units that all tiles would take
  uint32_t probed_tiles = 0;                    // 0: the frame's error is unknown
  double probed_rmse = 0, probed_rmse_low = 0, probed_rmse_high = 0;
  double transmitted_rms = 0; // RMS of transmitted light, exposed; 0: none, or not counted
  std::string miss;           // why the frame exceeded the budget; "": it did not
};

// Expected time and error of a configuration in a frame like this one.
struct FrameOutcome {
  std::string configuration;
  double expected_ms = 0, percentile_ms = 0, expected_rmse = 0;
  bool fits = false, dominated = false;
  uint64_t transient_bytes = 0, history_bytes = 0;
};

// State of a history of the graph after the frame.
struct FrameHistory {
  std::string name;
  bool valid = false;
  uint32_t age = 0; // number of consecutive frames in the history
  // Why the history is invalid; if valid, why it was invalid last.
  std::string why;
};

struct FrameOutputs {
  uint32_t frame = 0;   // first_frame .. first_frame + frames - 1
  double seconds = 0.0; // scene time
  bool cut = false;     // the camera has jumped since the previous frame
  float exposure = 1.0f;
  FrameCamera camera;
  GraphInputs inputs;
  // 3: light before albedo after scattering; empty unless the graph exports "scattered_light".
  FloatImage scattered;
  // 4: samples, samples in history, confidence or spread, 1 for a new surface. Undefined without
  // subsurface. Empty unless requested and exported.
  FloatImage sampling;
  // 2: class of the tile (0 nothing, 1 scatters, 2 below a pixel, 3 uniform light), profile id.
  // Empty unless requested and exported.
  FloatImage tile_class;
  FloatImage color;                   // 3: linear radiance times exposure
  std::vector<uint8_t> display;       // RGB, tonemapped and sRGB encoded
  std::vector<PassTime> host_times;   // shadows, gbuffer, lighting, composite
  std::optional<FrameChoice> choice;  // none without Dermis
  std::vector<FrameOutcome> frontier; // of all configurations, by rising time
  // Histories of the graph, including those of plans that did not run.
  std::vector<FrameHistory> histories;
  // Phases of this frame; "run scene" and "run graph" wait for the device.
  std::vector<HostPhase> phases;
  // Passes of the graph in plan order; empty without Dermis or timestamps.
  std::vector<PassTime> dermis_times;
};

// Information that is known after loading, before the first frame.
struct RenderInfo {
  std::string scene, device;
  uint64_t triangles = 0;
  double load_seconds = 0.0;
  float metres_per_unit = 1.0f;
  double pixel_aspect = 1.0; // width / height of a pixel
  std::vector<ScatteringProfile> profiles;
  std::vector<std::string> credits;  // texts that must be printed: author and licence of the model
  std::vector<std::string> warnings; // warnings of the scene, the model and the graph
};

struct RenderSummary {
  uint32_t frames = 0;
  uint32_t reloads = 0, rejected_reloads = 0; // rejected_reloads are included in `reloads`
  // Learned costs of the device, JSON; "" without Dermis.
  std::string calibration;
  std::vector<std::string> validation_messages; // empty unless validation found something
};

struct RenderCallbacks {
  std::function<Result<>(const RenderInfo&)> on_start; // may be empty
  // May be empty; an error ends the rendering and is returned.
  std::function<Result<>(const FrameOutputs&)> on_frame;
};

// A device, a scene that is loaded on it, and up to 1 GiB of frames with the graph's inputs. A
// cache is kept from one call of render() to the next, so that only the graph is rebuilt. Belongs
// to one thread.
struct RenderCache;
struct RenderCacheDeleter {
  void operator()(RenderCache* cache) const;
};
using RenderCacheHandle = std::unique_ptr<RenderCache, RenderCacheDeleter>;
RenderCacheHandle make_render_cache();

// Renders on the calling thread (loading uses two more threads). With a cache, kept frames are
// bit-identical to rendered frames, and `host_times` has no times for them. The cache is rebuilt if
// a call needs another device, scene, model, camera or size. Errors: input (scene, model, graph,
// profile; the text holds all located messages), usage (size, frames), environment (no driver, no
// memory), internal.
Result<RenderSummary> render(const RenderOptions& options, const RenderCallbacks& callbacks,
                             RenderCache* cache = nullptr);

// Applies a filmic curve after Narkowicz 2016, "ACES Filmic Tone Mapping Curve", then the sRGB
// curve; returns 8 bits per channel.
std::vector<uint8_t> tonemap(const FloatImage& linear_rgb);

} // namespace demo
