// dermis render: renders a scene with the demo engine and a graph; writes images, device times and
// the error against the reference.

#include "framegraph/text/json_writer.hpp"
#include "integration/examples/demo_engine/files.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/output_kind.hpp"
#include "integration/tools/command/run/budget_input.hpp"
#include "integration/tools/command/run/choice_report.hpp"
#include "integration/tools/command/run/host_passes.hpp"
#include "integration/tools/command/run/pass_times.hpp"
#include "integration/tools/command/run/reference_run.hpp"
#include "integration/tools/command/run/rendered_frame.hpp"
#include "integration/tools/command/run/surface_warnings.hpp"
#include "integration/tools/command/run/trace.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "integration/tools/files/exr.hpp"
#include "integration/tools/files/png.hpp"
#include "integration/tools/files/roots.hpp"
#include "passes/choice/defaults.hpp"
#include "passes/choice/error_model.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

namespace dermis::tools {
namespace {

// value of --graph that renders the engine without Dermis
constexpr std::string_view no_graph = "none";

demo::Error cannot_write(std::string problem) {
  return {demo::ErrorKind::environment, std::move(problem)};
}

// State collected over the frames.
struct RenderRun {
  const Session& session;
  const RenderOptions& options;
  Progress progress;
  OutputFolder out{};
  std::set<std::string> written{}; // names of the images
  demo::RenderInfo info{};
  std::vector<CaptureProfile> profiles{};
  PassTimes graph_times{}, host_times{};
  ExposureMeter exposure{};
  uint32_t frames = 0;
  ReferenceFrame last{}; // last frame, with its result:
  std::vector<float> last_scattered{};
  CaptureWriter capture{};
  bool textured_before = false;
  ChoiceReport choices{};
  Trace trace{};
  bool transmission = false; // the graph adds back light before it scatters
  std::vector<std::string> ray_techniques = {};
  bool by_rays = false;   // the last frame scattered by rays, which see more than the screen
  Diagnostics surfaces{}; // warnings of frames, each once
};

demo::Result<> start(RenderRun& run, const demo::RenderInfo& info) {
  run.info = info;
  for (const std::string& warning : info.warnings)
    spdlog::warn("{}", warning);
  for (const std::string& credit : info.credits)
    say(run.session, credit + "\n");
  if (auto read = read_profiles(info.profiles, run.profiles); !read) return read;
  if (const std::string problem = run.out.open(run.options.out); !problem.empty())
    return cannot_write(problem);
  std::string problem;
  if (!run.options.capture.empty() && !run.capture.begin(run.options.capture, problem))
    return cannot_write(problem);
  return demo::success();
}

// Encodes samples in colour: green up to a graph's default maximum, red where the surface was not
// visible in the previous frame, dim in subsurface without samples, black elsewhere.
std::vector<uint8_t> sampling_picture(const demo::FrameOutputs& frame) {
  constexpr float max_samples = 64, dim = 0.25f;
  std::vector<uint8_t> rgb(frame.display.size());
  for (size_t i = 0; i < frame.inputs.profile.texels.size(); ++i) {
    if (!(frame.inputs.profile.texels[i] > 0)) continue;
    const float* sampled = &frame.sampling.texels[4 * i];
    for (size_t c = 0; c < 3; ++c)
      rgb[3 * i + c] = static_cast<uint8_t>(dim * static_cast<float>(frame.display[3 * i + c]));
    // The square root makes a single sample visible.
    if (sampled[0] > 0)
      rgb[3 * i + 1] =
          static_cast<uint8_t>(255 * std::sqrt(std::min(sampled[0] / max_samples, 1.0f)));
    if (sampled[3] > 0.5f) rgb[3 * i] = 255;
  }
  return rgb;
}

// Tints pixels by the class of their tile: grey has no subsurface, green scatters, blue scatters
// below a pixel, yellow has uniform light.
std::vector<uint8_t> skips_picture(const demo::FrameOutputs& frame) {
  constexpr std::array<std::array<float, 3>, 4> tints{
      {{0.25f, 0.25f, 0.25f}, {0.3f, 1, 0.3f}, {0.3f, 0.3f, 1}, {1, 1, 0.3f}}};
  constexpr float minimum = 64; // of 255, keeps dark tiles distinguishable
  std::vector<uint8_t> rgb(frame.display.size());
  for (size_t i = 0; i < rgb.size() / 3; ++i) {
    const auto tile =
        std::min(static_cast<size_t>(frame.tile_class.texels[2 * i]), tints.size() - 1);
    const float floor = tile == 0 ? 0 : minimum;
    for (size_t c = 0; c < 3; ++c)
      rgb[3 * i + c] = static_cast<uint8_t>(
          tints[tile][c] * (floor + (255 - floor) / 255 * float(frame.display[3 * i + c])));
  }
  return rgb;
}

demo::Result<> write_pictures(RenderRun& run, const demo::FrameOutputs& frame) {
  std::string problem;
  const auto name = [&](const char* what, const char* extension) {
    const auto [at, is_new] =
        run.written.insert(fmt::format("{}_{:04}.{}", what, frame.frame, extension));
    return run.out.path_of(*at);
  };
  if (!write_png(name("frame", "png"), frame.color.width, frame.color.height, frame.display,
                 problem) ||
      !write_exr(name("color", "exr"), to_image(frame.color), rgb_names, problem))
    return cannot_write(problem);
  if (!frame.scattered.texels.empty() &&
      !write_exr(name("scattered", "exr"), to_image(frame.scattered), rgb_names, problem))
    return cannot_write(problem);
  if (!frame.sampling.texels.empty() &&
      !write_png(name("debug", "png"), frame.color.width, frame.color.height,
                 sampling_picture(frame), problem))
    return cannot_write(problem);
  if (!frame.tile_class.texels.empty() &&
      !write_png(name("debug", "png"), frame.color.width, frame.color.height, skips_picture(frame),
                 problem))
    return cannot_write(problem);
  return demo::success();
}

// Returns the names of the techniques of an error table that scatter by rays. `given`: the host's
// table, which the library has accepted; empty: the built-in one.
std::vector<std::string> ray_techniques(const std::string& given) {
  Diagnostics ignored;
  const auto document = parse_document(
      "errors", given.empty() ? std::string(choice::default_errors_text()) : given, ignored);
  const auto errors = document ? choice::read_error_model(*document, ignored) : std::nullopt;
  std::vector<std::string> names;
  if (errors)
    for (const choice::TechniqueError& one : errors->techniques)
      if (one.by_rays) names.push_back(one.name);
  return names;
}

// Takes over the images of a frame that was read back.
demo::Result<> take_pictures(RenderRun& run, const demo::FrameOutputs& frame) {
  if (auto written = write_pictures(run, frame); !written) return written;
  auto captured = captured_frame(frame, run.profiles);
  if (!captured) return captured.error();
  warn_of_surfaces(*captured, run.surfaces);
  std::string problem;
  if (!run.options.capture.empty() && !run.capture.add(*captured, problem))
    return cannot_write(problem);
  run.exposure.add(captured->lighting.values, captured->profile);
  run.last = make_reference_frame(*captured);
  if (run.transmission) add_transmission(*captured, run.last);
  run.last_scattered = frame.scattered.texels;
  return demo::success();
}

demo::Result<> take_frame(RenderRun& run, const demo::FrameOutputs& frame) {
  if (interrupted()) return stopped();
  if (!frame.display.empty())
    if (auto taken = take_pictures(run, frame); !taken) return taken;
  // The first of several frames only warms caches.
  if (frame.frame > 0 || run.options.frames == 1) {
    run.graph_times.begin_frame();
    run.host_times.begin_frame();
    for (const demo::PassTime& time : frame.dermis_times)
      run.graph_times.add(time.pass, time.milliseconds);
    for (const demo::PassTime& time : frame.host_times)
      run.host_times.add(time.pass, time.milliseconds);
  }
  if (frame.choice) run.choices.add(frame.frame, *frame.choice, frame.histories);
  if (!run.options.trace.empty()) run.trace.add(frame);
  run.by_rays = frame.choice && std::ranges::find(run.ray_techniques, frame.choice->technique) !=
                                    run.ray_techniques.end();
  run.progress.update(++run.frames);
  return demo::success();
}

// Returns the chosen option of the setting 'texturing'; "post" if the graph has none.
std::string_view texturing_of(const Graph& graph, const CompileChoices& choices) {
  for (size_t i = 0; i < graph.settings.size(); ++i) {
    const SettingDeclaration& setting = graph.settings[i];
    if (setting.name == "texturing" && setting.type == SettingType::enumeration)
      return setting.options[static_cast<size_t>(choices.settings[i].integer)];
  }
  return "post";
}

bool exports_samples(const Graph& graph) {
  return std::any_of(graph.resources.begin(), graph.resources.end(),
                     [](const ResourceDeclaration& one) { return one.name == "sampling"; });
}

bool transmits(const Graph& graph, const CompileChoices& choices) {
  for (size_t i = 0; i < graph.settings.size(); ++i)
    if (graph.settings[i].name == "transmission" && graph.settings[i].type == SettingType::boolean)
      return choices.settings[i].integer != 0;
  return false;
}

// Returns the reason why no error is computed, or "".
std::string why_no_error(const RenderRun& run) {
  if (run.textured_before) return "the reference needs 'texturing' = 'post'";
  if (run.options.graph == no_graph) return "rendered without a graph";
  if (run.by_rays)
    return "the technique traces rays, to which the screen-space reference does not apply; use "
           "'dermis bench "
           "restir'";
  if (run.options.subset == 0) return "not requested (--subset 0)";
  if (run.last_scattered.empty()) return "the graph does not export 'scattered_light'";
  if (subsurface_pixels(run.last.profile) == 0) return "no pixel of the last frame has a profile";
  return "";
}

ExitCode report(RenderRun& run) {
  std::string text, error_json = "null";
  const std::string cold = run.options.frames == 1 ? first_frame : "";
  if (!run.graph_times.empty())
    text += format_times(run.graph_times, "pass of the graph" + cold) + '\n';
  if (!run.host_times.empty())
    text += format_times(run.host_times, "pass of the engine" + cold) + '\n';
  if (!run.choices.empty()) text += run.choices.text() + '\n';
  const std::string no_error = why_no_error(run);
  if (no_error.empty()) {
    const ReferenceFrame& last = run.last;
    const subsurface::ReferenceInput input = last.input();
    const std::vector<uint32_t> pixels =
        subsurface::stratified_subset(last.width, last.height, last.profile, run.options.subset);
    const auto reference = run_reference(run.session, "truth", input, pixels);
    if (!reference) return fail(run.session, ExitCode::interrupted, "stopped");
    const double exposure = run.exposure.result();
    const uint64_t population = subsurface_pixels(last.profile);
    const ErrorFigures figures =
        measure_error(run.last_scattered, *reference, pixels, exposure, population);
    const double d_px = median_d_px(input);
    text +=
        format_error(figures, fmt::format("frame {}", run.frames - 1), population, exposure, d_px);
    error_json = error_as_json(figures, population, exposure, d_px);
  } else {
    text += fmt::format("error of the scattered light: not measured, {}\n", no_error);
  }
  const bool last_only = run.options.pictures == RenderOptions::Pictures::last && run.frames > 1;
  const std::string written = last_only ? fmt::format("the last of {} frames is", run.frames)
                                        : format_count(run.frames, "frame", true);
  say(run.session,
      text + fmt::format("\n{} in {}\ndevice: {}\n", written, run.options.out, run.info.device));
  if (run.session.json) {
    JsonWriter answer;
    answer.open_object()
        .member("ok", true)
        .member("scene", run.info.scene)
        .member("graph", run.options.graph);
    answer.member("device", run.info.device)
        .member("frames", run.frames)
        .member("out", run.options.out);
    answer.member("width", run.options.size.width)
        .member("height", run.options.size.height)
        .member("subsurface_pixels", subsurface_pixels(run.last.profile))
        .key("passes");
    write_times(answer, run.graph_times);
    write_times(answer.key("engine_passes"), run.host_times);
    answer.member("device_ms", run.graph_times.total()).key("error").json(error_json);
    run.choices.write(answer.key("choices"));
    answer.key("diagnostics").json(format_as_json(run.surfaces)).key("credits").open_array();
    for (const std::string& credit : run.info.credits)
      answer.value(credit);
    answer.close().close();
    print(std::move(answer).finish());
  }
  return ExitCode::ok;
}

} // namespace

ExitCode render(const Session& session, const RenderOptions& options) {
  demo::RenderOptions engine;
  engine.scene = options.scene;
  engine.roots = options.inputs.roots;
  engine.model = {options.model.model, options.model.albedo, options.model.normal,
                  options.model.specular, options.model.height};
  engine.width = options.size.width;
  engine.pixel_aspect = options.pixel_aspect;
  engine.height = options.size.height;
  engine.frames = options.frames;
  engine.taa = options.taa;
  engine.kernels = options.kernels;
  engine.sampling = options.debug == RenderOptions::Debug::samples;
  engine.unbound = options.unbound;
  engine.tile_class = options.debug == RenderOptions::Debug::tile_class;
  if (options.pictures == RenderOptions::Pictures::last)
    engine.pictures_of = [&](uint32_t frame) { return frame + 1 == options.frames; };
  GraphInputs inputs = options.inputs;
  constexpr const char* overlay = "debug_tile_class.json"; // not added again if already given
  if (engine.tile_class &&
      std::none_of(inputs.overlays.begin(), inputs.overlays.end(), [&](const std::string& one) {
        return std::filesystem::path(one).filename() == overlay;
      }))
    inputs.overlays.push_back(shipped(std::string("configs/overlays/") + overlay));
  auto budget = read_budget(options.budget);
  if (!budget) return fail(session, budget.error());
  engine.budget = budget.take();

  // Read the graph here first, so that its messages have excerpts and JSON form and --set is
  // checked.
  bool textured = false, transmission = false;
  std::optional<HostPasses> host_passes;
  if (options.graph != no_graph) {
    Diagnostics diagnostics;
    const std::optional<LoadedGraph> loaded = load_graph(options.graph, inputs, diagnostics);
    if (!loaded) return fail_graph(session, options.graph, diagnostics);
    const CompileChoices choices = read_choices(loaded->graph, options.settings);
    if (!choices.problem.empty()) return fail(session, ExitCode::usage, choices.problem);
    if (std::string unused = unused_budget(options.budget, *loaded, options.graph); !unused.empty())
      return fail(session, ExitCode::usage, unused);
    if (engine.sampling && !exports_samples(loaded->graph))
      return fail(session, ExitCode::usage,
                  fmt::format("--debug samples: '{}' does not export 'sampling'; afis_guided.json, "
                              "sap_blend.json and sap_residual.json do",
                              options.graph));
    if (!compile_generic(*loaded, options.size, choices, diagnostics))
      return fail_graph(session, options.graph, diagnostics);
    engine.graph = options.graph;
    engine.graph_text = loaded->text;
    host_passes.emplace(loaded->host_pass_types);
    engine.hooks = host_passes->hooks();
    engine.overlays = loaded->overlays;
    engine.include = for_engine(open_included(options.graph, options.inputs.roots));
    if (!options.shaders.empty()) engine.shaders = for_engine(open_below({options.shaders}));
    engine.settings = settings_as_json(loaded->graph, options.settings);
    // Only 'post' scatters the light that the reference scatters: irradiance before albedo.
    textured = texturing_of(loaded->graph, choices) != "post";
    if (texturing_of(loaded->graph, choices) == "demodulate")
      spdlog::warn("texturing=demodulate expects lighting that contains albedo; that of `render` "
                   "does not, so that surfaces with subsurface appear without their albedo");
    transmission = transmits(loaded->graph, choices);
  } else if (!options.settings.empty() || !options.inputs.overlays.empty() ||
             !options.inputs.pass_types.empty() || !options.shaders.empty() ||
             !options.unbound.empty() || options.budget.ms > 0 ||
             !options.budget.calibration.empty() || !options.budget.errors.empty() ||
             engine.sampling || engine.tile_class) {
    return fail(session, ExitCode::usage,
                "--set, --overlay, --pass-types, --shaders, --unbound, --debug, --budget, "
                "--calibration and --errors need a graph");
  }
  if (!options.capture.empty() && options.pictures == RenderOptions::Pictures::last)
    return fail(session, ExitCode::usage,
                "--capture needs the images of all frames: --pictures all");

  OutputFolder trace_folder;
  if (!options.trace.empty())
    if (const std::string problem = trace_folder.open_for(options.trace); !problem.empty())
      return fail(session, ExitCode::environment, problem);

  RenderRun run{.session = session,
                .options = options,
                .progress = Progress(progress_style(session.quiet, session.json), "render", "frame",
                                     options.frames),
                .textured_before = textured,
                .transmission = transmission,
                .ray_techniques = ray_techniques(engine.budget.errors.text)};
  demo::RenderCallbacks callbacks;
  callbacks.on_start = [&](const demo::RenderInfo& info) { return start(run, info); };
  callbacks.on_frame = [&](const demo::FrameOutputs& frame) { return take_frame(run, frame); };
  const auto summary = demo::render(engine, callbacks);
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  if (!summary) return fail(session, summary.error());
  std::string problem;
  if (!options.capture.empty() && !run.capture.finish(problem))
    return fail(session, ExitCode::environment, problem);
  if (!options.trace.empty())
    problem = deliver_text(options.trace, run.trace.json(session.command, run.info.device));
  if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  print_beside_document(session, run.surfaces);
  if (const std::string earlier = earlier_outputs("render", options.out, run.written);
      !earlier.empty())
    spdlog::warn("{}", for_terminal(earlier));
  return report(run);
}

} // namespace dermis::tools
