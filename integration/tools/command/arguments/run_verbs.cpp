// Verbs that render and run graphs.
#include "integration/tools/command/arguments/add_verb.hpp"

#include <cstdio>
#include <map>

namespace dermis::tools {
namespace {

constexpr uint32_t max_repeat = 10000;
constexpr uint32_t max_subset = 1u << 24u; // pixels

// Adds the options of the choice by budget.
void add_budget(CLI::App& verb, RenderOptions& options) {
  const char* group = "The choice";
  constexpr double max_ms = 1e6;
  verb.add_option("--budget", options.budget_ms,
                  "Device milliseconds a frame for settings \"by\": \"budget\"")
      ->check(CLI::Range(0.0, max_ms))
      ->type_name("MS")
      ->group(group);
  verb.add_flag("--deterministic", options.deterministic,
                "Judge times by the calibration alone: the same on every machine")
      ->group(group);
  verb.add_option("--calibration", options.calibration, "What dermis calibrate wrote for this device")
      ->type_name("FILE")
      ->group(group);
}

void add_model(CLI::App& verb, ModelOptions& model) {
  const char* group = "Model, for scenes that show one";
  verb.add_option("--model", model.model, "glTF file")->type_name("FILE")->group(group);
  verb.add_option("--albedo", model.albedo, "Picture, sRGB")->type_name("FILE")->group(group);
  verb.add_option("--normal", model.normal, "Tangent-space normal map")->type_name("FILE")->group(group);
  verb.add_option("--specular", model.specular, "Picture, linear")->type_name("FILE")->group(group);
  verb.add_option("--height", model.height, "Height in metres that the model is scaled to")
      ->check(CLI::Range(1e-3, 1e3))
      ->group(group);
}

// Parses X,Y,WxH: the corner, then the size.
bool parse_region(const std::string& text, PictureRegion& region) {
  int read = 0;
  const int fields = std::sscanf(text.c_str(), "%5u,%5u,%5ux%5u%n", &region.x, &region.y, &region.size.width,
                                 &region.size.height, &read);
  region.text = text;
  return fields == 4 && static_cast<size_t>(read) == text.size() && region.size.width > 0 &&
         region.size.height > 0;
}
std::string check_region(const std::string& text) {
  PictureRegion region;
  return parse_region(text, region)
             ? ""
             : fmt::format("'{}' is no region; expected X,Y,WIDTHxHEIGHT as in 100,20,64x64", text);
}

} // namespace

void add_picture_verbs(CLI::App& app, Invocation& invocation) {
  add_verb<RenderOptions>(
      app, invocation, "render", "Render a scene with the demo engine and a graph, and measure the error",
      "dermis render configs/scenes/bust.json --graph configs/graphs/burley.json --size 640x360 --frames 8 "
      "--out out/",
      render, [](CLI::App& verb, RenderOptions& options) {
        verb.add_option("scene", options.scene, "Scene file")->required()->type_name("FILE");
        verb.add_option("--graph,-g", options.graph, "Graph file, or none to render without Dermis")
            ->required()
            ->type_name("FILE");
        verb.add_option("--out,-o", options.out, "Folder for pictures")->required()->type_name("DIR");
        add_size(verb, options.size);
        verb.add_option("--frames,-n", options.frames, "Frames to render [8]")
            ->check(CLI::Range(1u, max_frames));
        verb.add_option("--capture", options.capture, "Folder for what the graph saw")->type_name("DIR");
        verb.add_option("--trace", options.trace,
                        "Chrome trace of passes, phases of the host's thread and choices over frames, for "
                        "ui.perfetto.dev and chrome://tracing")
            ->type_name("FILE");
        verb.add_option("--shaders", options.shaders,
                        "Folder of shaders, laid out as this project's, that take the place of the program's")
            ->type_name("DIR");
        verb.add_flag(
            "--taa", options.taa,
            "Temporal anti-aliasing in the engine, after the graph: sub-pixel jitter (Halton 2, 3)");
        static const std::map<std::string, RenderOptions::Debug> views{
            {"samples", RenderOptions::Debug::samples}, {"skips", RenderOptions::Debug::skips}};
        add_choice(verb, "--debug", options.debug, views,
                   "Also pictures debug_NNNN.png. samples: green where the graph sampled, red where a "
                   "surface had no past. skips: green tiles scatter, blue ones are below a pixel, yellow "
                   "ones flat in light, grey ones have no subsurface")
            ->type_name("VIEW");
        verb.add_option("--subset", options.subset,
                        "Pixels of the last frame compared with the truth; 0: none [4096]")
            ->check(CLI::Range(0u, max_subset));
        add_settings(verb, options.settings);
        add_parts(verb, options.parts);
        add_budget(verb, options);
        add_model(verb, options.model);
      });
  add_verb<CaptureOptions>(
      app, invocation, "capture", "Write down what a graph would see of a scene: captured frames for apply",
      "dermis capture configs/scenes/bust.json --out capture/", capture,
      [](CLI::App& verb, CaptureOptions& options) {
        verb.add_option("scene", options.scene, "Scene file")->required()->type_name("FILE");
        verb.add_option("--out,-o", options.out, "Folder for the frames")->required()->type_name("DIR");
        add_size(verb, options.size);
        verb.add_option("--frames,-n", options.frames, "Frames to capture [8]")
            ->check(CLI::Range(1u, max_frames));
        verb.add_option("--first", options.first, "Frame of the scene to begin at [0]")
            ->check(CLI::Range(0u, max_frames));
        add_model(verb, options.model);
        add_root(verb, options.roots,
                 "Folder that scene and model may read from, beside their own; may be repeated");
      });
  add_verb<WatchOptions>(
      app, invocation, "watch",
      "Render again whenever a file or a shader changes, and say what changed in plan and error",
      "dermis watch configs/scenes/bust.json --graph configs/graphs/sap.json --out out/watch\n"
      "  dermis watch configs/scenes/bust.json -g configs/graphs/sap.json -o out/watch --build 'cmake "
      "--build "
      "build/release'",
      watch,
      [](CLI::App& verb, WatchOptions& options) {
        verb.add_option("scene", options.scene, "Scene file")->required()->type_name("FILE");
        verb.add_option("--graph,-g", options.graph, "Graph file")->required()->type_name("FILE");
        verb.add_option("--out,-o", options.out, "Folder for the newest pictures")
            ->required()
            ->type_name("DIR");
        add_size(verb, options.size);
        verb.add_option("--frames,-n", options.frames, "Frames of a rendering [4]")
            ->check(CLI::Range(1u, max_frames));
        verb.add_option("--subset", options.subset, "Pixels compared with the truth; 0: none [1024]")
            ->check(CLI::Range(0u, max_subset));
        verb.add_option(
                "--build", options.build,
                "Command that builds this program anew where a shader changes, instead of compiling shaders "
                "itself")
            ->type_name("LINE");
        verb.add_option("--shaders", options.shaders, "Folder of the shaders to render with [shaders]")
            ->type_name("DIR");
        verb.add_option("--rounds", options.rounds, "Renderings to make; 0: until Ctrl-C [0]");
        add_settings(verb, options.settings);
        add_parts(verb, options.parts);
      },
      true);
  add_verb<ReportBugOptions>(
      app, invocation, "report-bug",
      "Put together what somebody else needs to see the same: graph, settings, device, plan and a frame",
      "dermis report-bug configs/graphs/sap.json --set variant=base --out bug.tar.gz", report_bug,
      [](CLI::App& verb, ReportBugOptions& options) {
        verb.add_option("graph", options.graph, "Graph file")->required()->type_name("FILE");
        verb.add_option("--out,-o", options.out,
                        "Folder, or archive (.tar.gz, .tgz) with one, to make; it must not be there")
            ->required()
            ->type_name("PATH");
        CLI::Option* frames =
            verb.add_option("--frames", options.frames, "Capture of an engine, whose last frame is taken")
                ->type_name("DIR");
        verb.add_option("--scene", options.scene, "Scene to capture a frame of [configs/scenes/bust.json]")
            ->excludes(frames)
            ->type_name("FILE");
        verb.add_option("--count,-n", options.count, "Which frame of it, counted from 1 [8]")
            ->excludes(frames)
            ->check(CLI::Range(1u, max_frames));
        add_size(verb, options.size);
        add_settings(verb, options.settings);
        add_parts(verb, options.parts);
      });
  add_verb<SheetOptions>(
      app, invocation, "sheet", "Render a scene with every technique and material into one picture",
      "dermis sheet --out out/sheet.png", sheet, [](CLI::App& verb, SheetOptions& options) {
        verb.add_option("scene", options.scene, "Scene file [configs/scenes/bust.json]")->type_name("FILE");
        verb.add_option("--out,-o", options.out, "Picture, PNG")->required()->type_name("FILE");
        repeat(verb.add_option("--graphs", options.graphs,
                               "Graph files, separated by commas, one row each, below one without a graph "
                               "[those that ship]")
                   ->delimiter(',')
                   ->type_name("FILE"));
        add_pass_types(verb, options.pass_types);
        repeat(verb.add_option("--profiles", options.profiles,
                               "Profile files, separated by commas, one column each, for all objects that "
                               "scatter [skin, jade, marble, wax, ketchup, milk]")
                   ->delimiter(',')
                   ->type_name("FILE"));
        add_size(verb, options.size);
        add_root(verb, options.roots, "Folder that the scene may read from, beside its own; may be repeated");
      });
  add_verb<CalibrateOptions>(
      app, invocation, "calibrate", "Measure what a graph's passes cost on this device",
      "dermis calibrate --out calibration.json", calibrate, [](CLI::App& verb, CalibrateOptions& options) {
        verb.add_option("graph", options.graph, "Graph file [configs/graphs/skin.json]")->type_name("FILE");
        verb.add_option("--scene", options.scene, "Scene file [configs/scenes/bust.json]")->type_name("FILE");
        verb.add_option("--out,-o", options.out, "File, or - for standard output [-]")->type_name("FILE");
        verb.add_option("--calibration", options.calibration,
                        "File of an earlier run to begin from: what this graph does not run is scaled as the "
                        "rest was [the library's own]")
            ->type_name("FILE");
        verb.add_option("--frames,-n", options.frames,
                        "Frames of each combination of choices, near and far [16]")
            ->check(CLI::Range(2u, max_frames));
        add_size(verb, options.size);
        add_parts(verb, options.parts);
      });
  add_verb<ApplyOptions>(
      app, invocation, "apply", "Run a graph on captured frames",
      "dermis apply --graph configs/graphs/burley.json --frames capture/ --out out/", apply,
      [](CLI::App& verb, ApplyOptions& options) {
        verb.add_option("--graph,-g", options.graph, "Graph file")->required()->type_name("FILE");
        verb.add_option("--frames", options.frames, "Capture folder")->required()->type_name("DIR");
        verb.add_option("--out,-o", options.out, "Folder for EXRs")->required()->type_name("DIR");
        verb.add_option("--profiles", options.profiles,
                        "Folder of profiles that frames name [configs/profiles]")
            ->type_name("DIR");
        verb.add_option("--repeat", options.repeat, "Times each frame is run; times are medians [1]")
            ->check(CLI::Range(1u, max_repeat));
        add_settings(verb, options.settings);
        add_parts(verb, options.parts);
      });
  add_verb<ReferenceOptions>(
      app, invocation, "reference", "Compute the exact scattered light of captured frames",
      "dermis reference --frames capture/ --out truth/", reference,
      [](CLI::App& verb, ReferenceOptions& options) {
        verb.add_option("--frames", options.frames, "Capture folder")->required()->type_name("DIR");
        verb.add_option("--out,-o", options.out, "Folder for EXRs")->required()->type_name("DIR");
        verb.add_option("--profiles", options.profiles,
                        "Folder of profiles that frames name [configs/profiles]")
            ->type_name("DIR");
        verb.add_option("--subset", options.subset, "Pixels of a frame, chosen evenly; 0: all [0]")
            ->check(CLI::Range(0u, max_subset));
        add_root(verb, options.roots,
                 "Folder that the capture may read from, beside its own; may be repeated");
      });
  add_verb<CompareOptions>(
      app, invocation, "compare", "Say how far two pictures, or two folders of them, are apart",
      "dermis compare out/a/frame_0007.png out/b/frame_0007.png --heat out/heat.png\n  dermis compare out/a "
      "out/b --flip --least-psnr 40",
      compare, [](CLI::App& verb, CompareOptions& options) {
        verb.add_option("a", options.a, "PNG, EXR, or a folder of them")->required()->type_name("A");
        verb.add_option("b", options.b, "What it is compared with")->required()->type_name("B");
        verb.add_option("--heat", options.heat, "PNG for a picture of the differences")->type_name("FILE");
        repeat(verb.add_option_function<std::vector<std::string>>(
                       "--region",
                       [&options](const std::vector<std::string>& all) {
                         for (const std::string& one : all)
                           parse_region(one, options.regions.emplace_back());
                       },
                       "Also these pixels alone; may be repeated")
                   ->check(CLI::Validator(check_region, "X,Y,WxH")));
        CLI::Option* flip = verb.add_flag("--flip", options.flip,
                                          "Also FLIP, the difference that a reader sees who flips between A "
                                          "and the reference B; of EXRs over the "
                                          "exposures at which B can be shown");
        verb.add_option("--flip-map", options.flip_map, "PNG for a picture of it")
            ->needs(flip)
            ->type_name("FILE");
        verb.add_option("--pixels-per-degree", options.pixels_per_degree, "Of the reader's view [67]")
            ->needs(flip)
            ->check(CLI::Range(1.0, 1000.0))
            ->type_name("N");
        verb.add_option("--most-flip", options.max_flip, "Fail where a picture or region has more on average")
            ->needs(flip)
            ->check(CLI::Range(0.0, 1.0))
            ->type_name("N");
        constexpr double max_db = 100;
        verb.add_option("--least-psnr", options.min_psnr, "Fail where a picture or region has less")
            ->check(CLI::Range(0.0, max_db))
            ->type_name("DB");
      });
}

} // namespace dermis::tools
