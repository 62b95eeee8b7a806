#include "integration/examples/demo_engine/engine.hpp"

#include "integration/examples/demo_engine/render/dermis_host.hpp"
#include "integration/examples/demo_engine/render/ray_placing.hpp"
#include "integration/examples/demo_engine/render/render_cache.hpp"
#include "integration/examples/demo_engine/render/taa.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace demo {
namespace {

constexpr uint32_t max_pixels_per_side = 16384;
constexpr uint32_t max_frames = 1000000;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

Result<> check(const RenderOptions& options) {
  if (options.width < 1 || options.height < 1 || options.width > max_pixels_per_side ||
      options.height > max_pixels_per_side)
    return Error{ErrorKind::usage,
                 fmt::format("the size is {}x{}; expected 1x1 to {}x{} pixels", options.width,
                             options.height, max_pixels_per_side, max_pixels_per_side)};
  if (options.frames < 1 || options.frames > max_frames || options.first_frame > max_frames)
    return Error{
        ErrorKind::usage,
        fmt::format("{} frames from frame {} were requested; expected 1 to {}, from 0 to {}",
                    options.frames, options.first_frame, max_frames, max_frames)};
  return success();
}

std::array<float, 16> rows_of(const glm::dmat4& m) {
  std::array<float, 16> rows{};
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      rows[static_cast<size_t>(r * 4 + c)] = static_cast<float>(m[c][r]);
  return rows;
}

FrameCamera camera_of(const Scene& scene, const SceneState& state) {
  FrameCamera camera;
  camera.orthographic = scene.camera.orthographic;
  camera.clip_from_view = rows_of(state.now.clip_from_view);
  camera.view_from_world = rows_of(state.now.view_from_world);
  camera.previous_clip_from_view = rows_of(state.previous.clip_from_view);
  camera.previous_view_from_world = rows_of(state.previous.view_from_world);
  camera.jitter_pixels = {static_cast<float>(state.now.jitter.x),
                          static_cast<float>(state.now.jitter.y)};
  return camera;
}

// Reads an image and keeps its first `channels`.
Result<> read(VulkanHost& host, const Image& image, uint32_t channels, FloatImage& out) {
  auto texels = read_image(host, image, resting);
  if (!texels) return texels.error();
  const uint32_t stored = find_pixel_format(image.format)->channels;
  out = {image.width, image.height, channels, {}};
  const size_t pixels = size_t{image.width} * image.height;
  out.texels.resize(pixels * channels);
  for (size_t i = 0; i < pixels; ++i)
    for (uint32_t c = 0; c < channels; ++c)
      out.texels[i * channels + c] = (*texels)[i * stored + c];
  return success();
}

Result<> read_inputs(VulkanHost& host, const Renderer& renderer, const SceneState& state,
                     GraphInputs& inputs) {
  struct Readback {
    Target target;
    uint32_t channels;
    FloatImage* out;
  };
  for (const Readback& one :
       {Readback{Target::lighting, 3, &inputs.lighting}, Readback{Target::depth, 1, &inputs.depth},
        Readback{Target::normal, 3, &inputs.normal}, Readback{Target::albedo, 3, &inputs.albedo},
        Readback{Target::material, 1, &inputs.profile},
        Readback{Target::velocity, 2, &inputs.velocity},
        Readback{Target::specular, 3, &inputs.specular},
        Readback{Target::thickness, 1, &inputs.thickness},
        Readback{Target::back_lighting, 3, &inputs.back_lighting}})
    if (auto done = read(host, renderer[one.target], one.channels, *one.out); !done) return done;
  const float nothing = renderer.view.reversed_depth ? 0.0f : 1.0f;
  for (float& depth : inputs.depth.texels) {
    const double metres = view_depth(state.now.clip_from_view, static_cast<double>(depth));
    depth = depth == nothing ? 0.0f : static_cast<float>(metres);
  }
  return success();
}

// A phase ends when the next one begins.
struct PhaseClock {
  Clock::time_point start; // start of rendering
  std::vector<HostPhase>& phases;

  void begin(const char* name) {
    end();
    const double now = 1000.0 * seconds_since(start);
    phases.push_back({name, now, now});
  }
  void end() {
    if (!phases.empty()) phases.back().end_ms = 1000.0 * seconds_since(start);
  }
};

struct Session {
  VulkanHost& host;
  Renderer& renderer;
  DermisHost* dermis; // may be null
  Taa* taa;           // may be null
  const Scene& scene;
  KeptFrames* kept; // may be null: no frames are kept
  Clock::time_point start;
};

// Which outputs of a frame are read back.
struct RequestedOutputs {
  bool inputs = true, pictures = true;
};

// Renders the scene, or restores its kept result if the frame was rendered before.
Result<> run_scene(Session& session, const SceneState& state, uint32_t frame, PhaseClock& clock) {
  const bool again = session.kept && is_kept(*session.kept, frame);
  clock.begin("record scene");
  auto done = run_commands(session.host, [&](VkCommandBuffer commands) {
    record_new_times(session.renderer, commands);
    if (again)
      record_kept(*session.kept, session.renderer, commands, frame);
    else
      record_scene(session.renderer, commands, state);
    clock.begin("run scene");
    return success();
  });
  if (!done || again || !session.kept) return done;
  return keep_frame(*session.kept, session.renderer, frame);
}

Result<> read_pictures(const Session& session, FrameOutputs& out) {
  VulkanHost& host = session.host;
  Renderer& renderer = session.renderer;
  auto done = success();
  if (session.dermis && exports_light(*session.dermis)) {
    done = read(host, renderer[Target::scattered], 3, out.scattered);
    if (!done) return done;
  }
  if (session.dermis && exports_sampling(*session.dermis)) {
    done = read(host, renderer[Target::sampling], 4, out.sampling);
    if (!done) return done;
  }
  if (session.dermis && exports_tile_class(*session.dermis)) {
    done = read(host, renderer[Target::tile_class], 2, out.tile_class);
    if (!done) return done;
  }
  done = read(host, session.taa ? taa_result(*session.taa) : renderer[Target::color], 3, out.color);
  if (done) out.display = tonemap(out.color);
  return done;
}

Result<FrameOutputs> render_frame(Session& session, uint32_t frame, uint64_t frame_index,
                                  RequestedOutputs requested) {
  VulkanHost& host = session.host;
  Renderer& renderer = session.renderer;
  const SceneState state = state_at(session.scene, frame, renderer.view);
  set_frame(renderer, state, session.dermis ? scattering_of(*session.dermis) : Scattering::none);
  FrameOutputs out;
  PhaseClock clock{session.start, out.phases};
  out.frame = frame;
  out.seconds = state.seconds;
  out.cut = state.cut;
  out.exposure = static_cast<float>(session.scene.exposure);
  out.camera = camera_of(session.scene, state);
  const bool rendered = !session.kept || !is_kept(*session.kept, frame);
  auto done = run_scene(session, state, frame, clock);
  if (!done) return done.error();
  if (requested.inputs) {
    clock.begin("read inputs");
    // before the graph updates the lighting in place
    done = read_inputs(host, renderer, state, out.inputs);
    if (!done) return done.error();
  }
  if (session.dermis && uses_rays(*session.dermis)) {
    clock.begin("place rays");
    done = place_rays(renderer, state);
    if (!done) return done.error();
  }
  const bool composites = requested.pictures || session.taa != nullptr;
  clock.begin("record graph");
  done = run_commands(host, [&](VkCommandBuffer commands) -> Result<> {
    if (session.dermis) {
      auto recorded = record_graph(*session.dermis, renderer, state, commands, frame_index);
      if (!recorded) return recorded;
    }
    if (composites) record_composite(renderer, commands);
    if (session.taa) record_taa(*session.taa, renderer, commands, state);
    clock.begin("run graph");
    return success();
  });
  if (!done) return done.error();
  if (requested.pictures) {
    clock.begin("read pictures");
    done = read_pictures(session, out);
    if (!done) return done.error();
  }
  clock.end();
  if (renderer.queries.host && rendered) {
    out.host_times = {{"shadows", elapsed_ms(renderer, at_start, after_shadows)},
                      {"gbuffer", elapsed_ms(renderer, after_shadows, after_gbuffer)},
                      {"lighting", elapsed_ms(renderer, after_gbuffer, after_lighting)}};
    if (composites)
      out.host_times.push_back({"composite", elapsed_ms(renderer, at_composite, at_end)});
  }
  if (!session.dermis) return out;
  out.dermis_times = graph_times(*session.dermis, frame_index);
  auto choice = graph_choice(*session.dermis, frame_index);
  if (!choice) return choice.error();
  out.choice = choice.take();
  auto frontier = graph_frontier(*session.dermis);
  if (!frontier) return frontier.error();
  out.frontier = frontier.take();
  auto histories = graph_histories(*session.dermis);
  if (!histories) return histories.error();
  out.histories = histories.take();
  return out;
}

} // namespace

Result<RenderSummary> render(const RenderOptions& options, const RenderCallbacks& callbacks,
                             RenderCache* kept_cache) {
  const Clock::time_point start = Clock::now();
  if (auto done = check(options); !done) return done.error();
  RenderCache own;
  RenderCache& cache = kept_cache ? *kept_cache : own;
  if (auto done = load_scene_and_device(cache, options); !done) return done.error();
  VulkanHost& host = *cache.host;

  RenderInfo info;
  info.scene = cache.scene->name;
  info.device = host.properties.deviceName;
  info.pixel_aspect = cache.scene->camera.pixel_aspect;
  info.credits = cache.model.credits;
  info.warnings = cache.model.warnings;
  for (const SceneProfile& profile : cache.scene->profiles)
    info.profiles.push_back({static_cast<uint32_t>(info.profiles.size()) + 1, profile.name,
                             options.profile.empty() ? profile.file : options.profile});
  auto usage = kept_cache ? usage_for_keeping() : std::array<VkImageUsageFlags, target_count>{};
  DermisHandle dermis;
  if (!options.graph.empty()) {
    auto made = create_dermis_host(
        host,
        {options.graph, options.graph_text, info.profiles, options.settings, options.width,
         options.height, info.pixel_aspect, options.overlays, options.include, options.shaders,
         options.budget, options.sampling, options.tile_class, options.hooks, options.unbound},
        &cache.slots);
    if (!made) return made.error();
    dermis = made.take();
    const auto of_graph = usage_for_graph(*dermis);
    for (size_t i = 0; i < target_count; ++i)
      usage[i] |= of_graph[i];
    for (const std::string& warning : warnings_of(*dermis))
      info.warnings.push_back(warning);
  }
  if (auto done = prepare_renderer(cache, options, usage); !done) return done.error();
  std::unique_ptr<Taa> taa;
  if (options.taa) {
    auto made = create_taa(*cache.renderer);
    if (!made) return made.error();
    taa = made.take();
  }
  info.triangles = cache.renderer->gpu.triangles;
  info.load_seconds = seconds_since(start);
  if (callbacks.on_start)
    if (auto done = callbacks.on_start(info); !done) return done.error();

  RenderSummary summary;
  Session session{host,      *cache.renderer, dermis.get(),
                  taa.get(), *cache.scene,    kept_cache ? &cache.kept : nullptr,
                  start};
  for (uint32_t i = 0; i < options.frames; ++i) {
    if (dermis && options.reloads)
      for (const std::string& text : options.reloads(options.first_frame + i)) {
        auto taken = reload_graph(*dermis, text);
        if (!taken) return taken.error();
        ++summary.reloads;
        summary.rejected_reloads += *taken ? 0 : 1;
      }
    const uint32_t number = options.first_frame + i;
    RequestedOutputs requested;
    requested.pictures = !options.pictures_of || options.pictures_of(number);
    requested.inputs = options.inputs_of ? options.inputs_of(number) : requested.pictures;
    auto frame = render_frame(session, number, uint64_t{i} + 1, requested);
    if (!frame) return frame.error();
    ++summary.frames;
    if (callbacks.on_frame)
      if (auto done = callbacks.on_frame(*frame); !done) return done.error();
  }
  if (dermis) summary.calibration = graph_calibration(*dermis);
  const std::lock_guard lock(host.log.mutex);
  summary.validation_messages = host.log.messages;
  return summary;
}

} // namespace demo
