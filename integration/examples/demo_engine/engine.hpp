#pragma once
// Renders a scene frame by frame without a window, with or without Dermis, and hands out what an engine, its
// graph and its user see: pictures, the graph's inputs as floats, the camera, device times.

#include "integration/examples/demo_engine/context_hooks.hpp"
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

// A glTF file that takes the place of each object of shape "model". Maps override those of the file.
struct ModelOptions {
  std::string mesh;                     // .glb or .gltf; "" = none
  std::string albedo, normal, specular; // image files; "" = none
  double height_metres = 0.0;           // scales the model to this height; 0 = as in the file (metres)
  bool operator==(const ModelOptions&) const = default;
};

// A perspective camera that takes the place of the scene's and stays where it is.
struct CameraPlace {
  std::array<double, 3> position{}, target{}; // metres
  double vertical_fov = 25.0;                 // degrees, 1..150
  bool operator==(const CameraPlace&) const = default;
};

struct NamedText {
  std::string name, text; // name: of the file, for messages
};

struct RenderOptions {
  std::string scene; // scene file
  std::string graph; // graph file; "" = without Dermis: light times albedo, as an engine has it before
  std::vector<NamedText> overlays;                                          // of the graph, in order
  std::function<std::optional<NamedText>(const std::string& name)> include; // opens what the graph includes
  // Opens shaders that take the place of the library's ("sap/subsurface_sap_up.comp", "sap/sap.glsl"); empty:
  // none do.
  std::function<std::optional<NamedText>(const std::string& name)> shaders = {};
  ModelOptions model;
  std::string profile; // file that takes the place of each of the scene's profiles; "" = as the scene says
  std::vector<std::string> roots = {}; // folders that scene and model may read from, beside their own
  uint32_t width = 640, height = 360;  // pixels, 1..16384
  uint32_t first_frame = 0, frames = 1;
  double frames_per_second = 0; // 0: the scene's
  bool reversed_depth = false;  // far plane at depth 0
  bool jitter = false;          // sub-pixel camera jitter (Halton 2, 3; period 8)
  bool taa = false;             // temporal anti-aliasing of `color`, with jitter
  bool sampling = false;        // hand out what the graph says of its samples
  bool skips = false;           // and of what it left out
  bool validation = false;      // run under the Khronos validation layer
  std::string device;           // part of the device's name; "" = choose
  std::optional<CameraPlace> camera;
  double zoom = 1.0; // how many times larger the camera shows things: its field of view shrinks; > 0
  std::vector<std::pair<std::string, std::string>> settings; // of the graph: name, JSON text
  double budget_ms = 0;       // of device time for the graph's choices, a frame; 0: their defaults
  bool deterministic = false; // judge times by the calibration alone: the same choices on every machine
  // Texts that the graph is reloaded with before a frame, one after the other; those with errors leave it as
  // it is. May be empty. The graph must include nothing.
  std::function<std::vector<std::string>(uint32_t frame)> reloads = {};
  // Are a frame's pictures read back? Empty: of every frame. The others come without them.
  std::function<bool(uint32_t frame)> pictures_of = {};
  std::function<bool(uint32_t frame)> inputs_of = {}; // the same of its inputs; empty: as of its pictures
  NamedText calibration;   // JSON of an earlier run's RenderSummary::calibration; "": the library's own
  ContextHooks hooks = {}; // of a new stage's context
};

// Row by row from the top left; channels floats a pixel.
struct FloatImage {
  uint32_t width = 0, height = 0, channels = 0;
  std::vector<float> texels;
};

struct ScatteringProfile {
  uint32_t id = 0;  // in the profile image; 1..255
  std::string name; // as the scene calls it
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
  double milliseconds = 0.0; // of device time
};

// What the host's thread did, milliseconds since rendering began; one behind the other.
struct HostPhase {
  std::string name;
  double begin_ms = 0.0, end_ms = 0.0;
};

// What the graph was given; read back before it ran.
struct GraphInputs {
  FloatImage lighting; // 3: diffuse light before albedo
  FloatImage depth;    // 1: metres along the view axis, 0 = nothing there
  FloatImage normal;   // 3: geometric normal in view space, unit length; 0 where nothing is
  FloatImage albedo;   // 3: linear
  FloatImage profile;  // 1: id, 0 = no subsurface
  FloatImage velocity; // 2: pixels, now - previous, +x right, +y down, without jitter
  FloatImage specular; // 3: reflected light, never given to the graph
  // Of the light that brings most through from behind: its way through the object, metres (1), and its
  // irradiance on the far side (3).
  FloatImage thickness, back_lighting;
};

// What the library chose for the frame, and what it expected.
struct FrameChoice {
  std::string outcome, technique, why, next_better; // next_better: lacks least time; "": none
  double budget_ms = 0, predicted_ms = 0, predicted_spread_ms = 0, measured_ms = -1, metered_ms = 0,
         predicted_rmse = 0;
  double next_better_missing_ms = 0, mean_d_px = 0;
  uint32_t outcomes = 1, view_tiles = 0, scattering_tiles = 0, copied_tiles = 0, switches = 0;
  uint32_t uniform_tiles = 0, dispatches = 0;
  uint64_t groups = 0;
  std::array<uint32_t, 3> sampled_tiles{};      // of the scattering ones, with 8, 16 and 32 samples a pixel
  uint32_t sample_units = 0, sample_demand = 0; // taken; that would be without a budget
  uint32_t probed_tiles = 0;                    // 0: the frame's error is not known
  double probed_rmse = 0, probed_rmse_low = 0, probed_rmse_high = 0;
  double transmitted_rms = 0; // light through thin parts, exposed; 0: none, or not counted
  std::string miss;           // why it took longer than the budget; "": it did not
};

// What a history of the graph holds after the frame.
struct FrameHistory {
  std::string name;
  bool valid = false;
  uint32_t age = 0; // frames in a row that are in it
  std::string why;  // it holds nothing; where it holds something, why it held nothing when it last did not
};

struct FrameOutputs {
  uint32_t frame = 0;   // first_frame .. first_frame + frames - 1
  double seconds = 0.0; // scene time
  bool cut = false;     // the camera has jumped since the frame before
  float exposure = 1.0f;
  FrameCamera camera;
  GraphInputs inputs;
  FloatImage scattered; // 3: light before albedo after scattering; empty when the graph does not export
                        // "scattered_light"
  FloatImage sampling;  // 4: samples, those behind history, confidence or spread, 1 where a surface was new;
                        // anything where there is no subsurface. Empty unless asked for and exported
  FloatImage skips; // 2: class of the tile (0 nothing, 1 scatters, 2 below a pixel, 3 flat light), profile
                    // id. Empty unless asked for and exported
  FloatImage color; // 3: linear radiance times exposure
  std::vector<uint8_t> display;        // RGB, tonemapped and sRGB encoded
  std::vector<PassTime> host_times;    // shadows, gbuffer, lighting, composite
  std::optional<FrameChoice> choice;   // none without Dermis
  std::vector<FrameHistory> histories; // of the graph, also of plans that did not run
  std::vector<HostPhase> phases;       // of this frame; "run scene" and "run graph" wait for the device
  std::vector<PassTime> dermis_times; // passes of the graph in plan order; empty without Dermis or timestamps
};

// Known once everything is loaded, before the first frame.
struct RenderInfo {
  std::string scene, device;
  uint64_t triangles = 0;
  double load_seconds = 0.0;
  float metres_per_unit = 1.0f;
  std::vector<ScatteringProfile> profiles;
  std::vector<std::string> credits;  // to be printed: who made the model, under which licence
  std::vector<std::string> warnings; // of the scene, the model and the graph
};

struct RenderSummary {
  uint32_t frames = 0;
  uint32_t reloads = 0, rejected_reloads = 0; // refused: among `reloads`
  std::string calibration; // what the graph learned of the device's times, JSON; "" without Dermis
  std::vector<std::string> validation_messages; // empty unless validation found something
};

struct RenderCallbacks {
  std::function<Result<>(const RenderInfo&)> on_start;   // may be empty
  std::function<Result<>(const FrameOutputs&)> on_frame; // may be empty; an error ends the rendering with it
};

// A device, a scene that is loaded on it, and its frames as graphs are given them, up to a gigabyte of them:
// kept from one call of render() to the next, so that only the graph begins anew. Belongs to one thread.
struct Stage;
struct StageDeleter {
  void operator()(Stage* stage) const;
};
using StageHandle = std::unique_ptr<Stage, StageDeleter>;
StageHandle make_stage();

// Runs on the calling thread (loading uses two more). With a stage, frames that it keeps are the same bits as
// if they were rendered, and `host_times` has no times for them; it is made anew where a call asks for
// another device, scene, model, camera or size. Errors: input (scene, model, graph, profile; the text holds
// all located messages), usage (size, frames), environment (no driver, no memory), internal.
Result<RenderSummary> render(const RenderOptions& options, const RenderCallbacks& callbacks,
                             Stage* stage = nullptr);

// Filmic curve after Narkowicz 2016, "ACES Filmic Tone Mapping Curve", then the sRGB curve; 8 bits a channel.
std::vector<uint8_t> tonemap(const FloatImage& linear_rgb);

} // namespace demo
