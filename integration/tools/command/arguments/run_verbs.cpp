// Verbs that render and run graphs.
#include "integration/tools/command/arguments/add_verb.hpp"

#include <cstdio>
#include <map>

namespace dermis::tools {
namespace {

constexpr uint32_t max_repeat = 10000;
constexpr uint32_t max_subset = 1u << 24u; // pixels
constexpr const char* of_scene = "Width of a pixel over its height [the scene's]";

void add_model(CLI::App& verb, ModelOptions& model) {
  const char* group = "Model, for scenes that use one";
  CLI::Option* file = add_path(verb, "--model", model.model, "glTF file")->group(group);
  const auto add_map = [&](const char* name, std::string& path, const char* what) {
    add_path(verb, name, path, what)->group(group)->needs(file);
  };
  add_map("--albedo", model.albedo, "Albedo image, sRGB");
  add_map("--normal", model.normal, "Tangent-space normal map");
  add_map("--specular", model.specular, "Specular image, linear");
  verb.add_option("--height", model.height, "Scale the model to this height, metres")
      ->check(in_range(1e-3, 1e3))
      ->group(group)
      ->needs(file);
}

// Parses X,Y,WxH: the corner, then the size.
bool parse_region(const std::string& text, PictureRegion& region) {
  int read = 0;
  const int fields = std::sscanf(text.c_str(), "%5u,%5u,%5ux%5u%n", &region.x, &region.y,
                                 &region.size.width, &region.size.height, &read);
  region.text = text;
  return fields == 4 && static_cast<size_t>(read) == text.size() && region.size.width > 0 &&
         region.size.height > 0;
}
std::string check_region(const std::string& text) {
  PictureRegion region;
  return parse_region(text, region)
             ? ""
             : fmt::format("'{}' is not a region; expected X,Y,WIDTHxHEIGHT such as 100,20,64x64",
                           text);
}

} // namespace

void add_picture_verbs(CLI::App& app, Invocation& invocation) {
  add_verb<RenderOptions>(
      app, invocation, "render",
      "Render a scene with the demo engine and a graph, and measure the error",
      "dermis render configs/scenes/bust.json --graph configs/graphs/burley.json --size 640x360 "
      "--frames 8 "
      "--out out/",
      render, [](CLI::App& verb, RenderOptions& options) {
        add_path(verb, "scene", options.scene, "Scene file")->required();
        add_path(verb, "--graph,-g", options.graph, "Graph file, or none to render without Dermis")
            ->required();
        add_path(verb, "--out,-o", options.out, "Folder for images", "DIR")->required();
        add_size(verb, options.size);
        add_pixel_aspect(verb, options.pixel_aspect, of_scene);
        add_frames(verb, options.frames, "Frames to render [8]");
        add_path(verb, "--capture", options.capture,
                 "Also write the graph's inputs as a capture to this folder", "DIR");
        add_path(verb, "--trace", options.trace,
                 "Write a Chrome trace of passes, host phases and choices, for ui.perfetto.dev or "
                 "chrome://tracing");
        add_path(verb, "--shaders", options.shaders,
                 "Folder of shaders, laid out like shaders/ of this project, that replace the "
                 "built-in ones",
                 "DIR")
            ->check(folder_exists());
        verb.add_flag("--taa", options.taa,
                      "Use temporal anti-aliasing in the engine, after the graph, with sub-pixel "
                      "jitter (Halton 2, 3)");
        static const std::map<std::string, demo::KernelShape> shapes{
            {"device", demo::KernelShape::by_device},
            {"gpu", demo::KernelShape::gpu},
            {"gpu_small", demo::KernelShape::gpu_small},
            {"cpu", demo::KernelShape::cpu}};
        add_choice(verb, "--kernels", options.kernels, shapes,
                   "Shape of the kernels: for GPUs, for GPUs with groups of at most 128 "
                   "invocations, for drivers on the CPU, or by the device's type [device]")
            ->type_name("SHAPE");
        static const std::map<std::string, RenderOptions::Debug> views{
            {"samples", RenderOptions::Debug::samples},
            {"tile_class", RenderOptions::Debug::tile_class}};
        add_choice(
            verb, "--debug", options.debug, views,
            "Also write debug_NNNN.png. samples: green pixels were sampled, red pixels have no "
            "history. tile_class: green tiles scatter, blue tiles scatter below a pixel, yellow "
            "tiles have "
            "uniform light, grey tiles have no subsurface")
            ->type_name("VIEW");
        static const std::map<std::string, RenderOptions::Pictures> pictures{
            {"all", RenderOptions::Pictures::all}, {"last", RenderOptions::Pictures::last}};
        add_choice(
            verb, "--pictures", options.pictures, pictures,
            "Frames to write as images. With last, other frames are only timed, and the error is "
            "in units of the last frame's exposure instead of that of all frames [all]")
            ->type_name("FRAMES");
        verb.add_option("--subset", options.subset,
                        "Pixels of the last frame compared with the reference; 0: none [4096]")
            ->check(CLI::Range(0u, max_subset));
        add_settings(verb, options.settings);
        add_unbound(verb, options.unbound);
        add_graph_inputs(verb, options.inputs);
        add_budget(verb, options.budget);
        add_model(verb, options.model);
      });
  add_verb<CaptureOptions>(
      app, invocation, "capture", "Write the graph inputs of a scene as captured frames",
      "dermis capture configs/scenes/bust.json --out capture/", capture,
      [](CLI::App& verb, CaptureOptions& options) {
        add_path(verb, "scene", options.scene, "Scene file")->required();
        add_path(verb, "--out,-o", options.out, "Folder for the frames", "DIR")->required();
        add_size(verb, options.size);
        add_pixel_aspect(verb, options.pixel_aspect, of_scene);
        add_frames(verb, options.frames, "Frames to capture [8]");
        verb.add_option("--first", options.first, "First frame of the scene [0]")
            ->check(CLI::Range(0u, max_frames));
        add_model(verb, options.model);
        add_root(verb, options.roots,
                 "Additional folder that scene and model may read from; may be repeated");
      });
  add_verb<WatchOptions>(
      app, invocation, "watch",
      "Render again whenever a file or shader changes, and report changes of plan and error",
      "dermis watch configs/scenes/bust.json --graph configs/graphs/sap.json --out out/watch\n"
      "  dermis watch configs/scenes/bust.json -g configs/graphs/sap.json -o out/watch --build "
      "'cmake "
      "--build "
      "build/release'",
      watch,
      [](CLI::App& verb, WatchOptions& options) {
        add_path(verb, "scene", options.scene, "Scene file")->required();
        add_path(verb, "--graph,-g", options.graph, "Graph file")->required();
        add_path(verb, "--out,-o", options.out, "Folder for the newest images", "DIR")->required();
        add_size(verb, options.size);
        add_frames(verb, options.frames, "Frames per rendering [4]");
        verb.add_option("--subset", options.subset,
                        "Pixels compared with the reference; 0: none [1024]")
            ->check(CLI::Range(0u, max_subset));
        verb.add_option(
                "--build", options.build,
                "Command that rebuilds this program when a shader changes, instead of compiling "
                "shaders at run time")
            ->type_name("LINE");
        add_path(verb, "--shaders", options.shaders,
                 "Folder of the shaders to render with [shaders]", "DIR")
            ->check(folder_exists());
        verb.add_option("--rounds", options.rounds, "Number of renderings; 0: until Ctrl-C [0]")
            ->check(CLI::Range(0u, 1000000u));
        add_settings(verb, options.settings);
        add_graph_inputs(verb, options.inputs);
      },
      true);
  add_verb<ReportBugOptions>(
      app, invocation, "report-bug",
      "Pack graph, settings, device, plan and a frame, to reproduce a problem elsewhere",
      "dermis report-bug configs/graphs/sap.json --set variant=base --out bug.tar.gz", report_bug,
      [](CLI::App& verb, ReportBugOptions& options) {
        add_path(verb, "graph", options.graph, "Graph file")->required();
        add_path(verb, "--out,-o", options.out,
                 "Folder or archive (.tar.gz, .tgz) to write; must not exist", "PATH")
            ->required();
        CLI::Option* frames = add_path(verb, "--frames", options.frames,
                                       "Capture of an engine; the last frame is used", "DIR");
        add_path(verb, "--scene", options.scene,
                 "Scene to capture a frame of [configs/scenes/bust.json]")
            ->excludes(frames);
        verb.add_option("--count,-n", options.count, "Number of the scene's frame, from 1 [8]")
            ->excludes(frames)
            ->check(CLI::Range(1u, max_frames));
        add_size(verb, options.size)->excludes(frames);
        add_settings(verb, options.settings);
        add_graph_inputs(verb, options.inputs);
      });
  add_verb<SheetOptions>(
      app, invocation, "sheet",
      "Render a scene with several techniques and materials into one image",
      "dermis sheet --out out/sheet.png", sheet, [](CLI::App& verb, SheetOptions& options) {
        add_path(verb, "scene", options.scene, "Scene file [configs/scenes/bust.json]");
        add_path(verb, "--out,-o", options.out, "PNG file to write")->required();
        repeat(
            add_path(verb, "--graphs", options.graphs,
                     "Graph files, separated by commas; one row each, below a row without a graph "
                     "[shipped graphs; skin with --budgets]")
                ->delimiter(','));
        add_pass_types(verb, options.pass_types);
        repeat(add_path(verb, "--profiles", options.profiles,
                        "Profile files, separated by commas; one column each, used for all objects "
                        "that scatter [skin, jade, marble, wax, ketchup, milk]")
                   ->delimiter(','));
        add_size(verb, options.size);
        CLI::Option* budgets = verb.add_option("--budgets", options.budgets,
                                               "Budgets in milliseconds, separated by commas; one "
                                               "row each per graph, after 24 frames, by "
                                               "calibrated times");
        repeat(budgets->check(in_range(1e-6, max_budget_ms))->type_name("MS")->delimiter(','));
        add_path(verb, "--calibration", options.calibration, "Costs of passes (dermis calibrate)")
            ->needs(budgets);
        add_root(verb, options.roots,
                 "Additional folder that the scene may read from; may be repeated");
      });
  add_verb<CalibrateOptions>(
      app, invocation, "calibrate", "Measure the cost of a graph's passes on this device",
      "dermis calibrate --out calibration.json", calibrate,
      [](CLI::App& verb, CalibrateOptions& options) {
        add_path(verb, "graph", options.graph, "Graph file [configs/graphs/skin.json]");
        add_path(verb, "--scene", options.scene, "Scene file [configs/scenes/bust.json]");
        add_path(verb, "--out,-o", options.out, "File to write, - for standard output [-]");
        add_path(verb, "--calibration", options.calibration,
                 "Initial calibration; passes that this graph does not run are scaled like the "
                 "measured ones [built-in]");
        add_frames(verb, options.frames, "Frames per combination of choices, near and far [16]", 2);
        add_size(verb, options.size);
        add_graph_inputs(verb, options.inputs);
      });
  add_verb<ApplyOptions>(
      app, invocation, "apply", "Run a graph on captured frames",
      "dermis apply --graph configs/graphs/burley.json --frames capture/ --out out/", apply,
      [](CLI::App& verb, ApplyOptions& options) {
        add_path(verb, "--graph,-g", options.graph, "Graph file")->required();
        add_path(verb, "--frames", options.frames, "Capture folder", "DIR")->required();
        add_path(verb, "--out,-o", options.out, "Folder for EXR images", "DIR")->required();
        add_path(verb, "--profiles", options.profiles,
                 "Folder of the frames' profiles [configs/profiles]", "DIR")
            ->check(folder_exists());
        verb.add_option("--repeat", options.repeat, "Runs per frame; times are medians [1]")
            ->check(CLI::Range(1u, max_repeat));
        add_settings(verb, options.settings);
        add_graph_inputs(verb, options.inputs);
      });
  add_verb<ReferenceOptions>(
      app, invocation, "reference", "Compute the exact scattered light of captured frames",
      "dermis reference --frames capture/ --out reference/", reference,
      [](CLI::App& verb, ReferenceOptions& options) {
        add_path(verb, "--frames", options.frames, "Capture folder", "DIR")->required();
        add_path(verb, "--out,-o", options.out, "Folder for EXR images", "DIR")->required();
        add_path(verb, "--profiles", options.profiles,
                 "Folder of the frames' profiles [configs/profiles]", "DIR")
            ->check(folder_exists());
        verb.add_option("--subset", options.subset,
                        "Pixels per frame, evenly distributed; 0: all [0]")
            ->check(CLI::Range(0u, max_subset));
        add_root(verb, options.roots,
                 "Additional folder that the capture may read from; may be repeated");
      });
  add_verb<CompareOptions>(
      app, invocation, "compare",
      "Measure the difference of two images or of two folders of images",
      "dermis compare out/a/frame_0007.png out/b/frame_0007.png --heat out/heat.png\n"
      "  dermis compare out/a out/b --flip --min-psnr 40",
      compare, [](CLI::App& verb, CompareOptions& options) {
        verb.add_option("a", options.a, "PNG, EXR, or a folder of them")
            ->required()
            ->type_name("A");
        verb.add_option("b", options.b, "Image or folder to compare with")
            ->required()
            ->type_name("B");
        add_path(verb, "--heat", options.heat,
                 "Write an image of the differences to this PNG file");
        repeat(verb.add_option_function<std::vector<std::string>>(
                       "--region",
                       [&options](const std::vector<std::string>& all) {
                         for (const std::string& one : all)
                           parse_region(one, options.regions.emplace_back());
                       },
                       "Also compare only these pixels; may be repeated")
                   ->check(CLI::Validator(check_region, "X,Y,WxH")));
        CLI::Option* flip = verb.add_flag(
            "--flip", options.flip,
            "Also compute FLIP, the perceived difference when A alternates with the reference "
            "B; for EXR images over the exposures at which B can be displayed");
        add_path(verb, "--flip-map", options.flip_map, "Write an image of FLIP to this PNG file")
            ->needs(flip);
        verb.add_option("--pixels-per-degree", options.pixels_per_degree,
                        "Pixels per degree of the viewer's field of view [67]")
            ->needs(flip)
            ->check(in_range(1.0, 1000.0))
            ->type_name("N");
        verb.add_option("--max-flip", options.max_flip,
                        "Fail if the mean FLIP of an image or region is higher")
            ->needs(flip)
            ->check(in_range(0.0, 1.0))
            ->type_name("N");
        constexpr double max_db = 100;
        verb.add_option("--min-psnr", options.min_psnr,
                        "Fail if the PSNR of an image or region is lower")
            ->check(in_range(0.0, max_db))
            ->type_name("DB");
      });
}

} // namespace dermis::tools
