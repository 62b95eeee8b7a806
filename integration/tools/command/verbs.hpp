#pragma once
// The verbs of the command: one function of its options per verb. arguments.cpp fills the options.
// Paths may be "": no file is then written or read. `scenes`, `techniques` and other filters may be
// empty, which selects all.

#include "framegraph/explain/traffic.hpp"
#include "integration/examples/demo_engine/budget.hpp"
#include "integration/examples/demo_engine/kernel_shape.hpp"
#include "integration/tools/command/session.hpp"
#include "integration/tools/command/shipped.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

struct Size {
  uint32_t width = 0, height = 0; // pixels, 1..16384
};

// name=value of --set; the value is JSON text or the unquoted text of a JSON string.
using NamedValue = std::pair<std::string, std::string>;

// Files that are combined with a graph file.
struct GraphInputs {
  std::vector<std::string> overlays;   // applied in this order
  std::vector<std::string> roots;      // additional folders that files may include from
  std::vector<std::string> pass_types; // files that declare the host's pass types
};

struct ValidateOptions {
  // of any kind, distinguished by their version key; or capture folders
  std::vector<std::string> files;
  std::string profiles;  // folder of the profiles that captures name
  std::string sarif;     // SARIF output file, - for standard output
  GraphInputs inputs;    // for the graphs among the files
  bool diagnose = false; // report usual integration mistakes in captured frames
};
ExitCode validate(const Session& session, const ValidateOptions& options);

struct UpgradeOptions {
  std::vector<std::string> files;
  bool check = false; // write nothing; fail if a file would change
};
ExitCode upgrade(const Session& session, const UpgradeOptions& options);

// Options of the choice by budget.
struct BudgetArguments {
  double ms = 0;         // device time per frame; 0: no budget
  double percentile = 0; // fraction of frames within the budget; 0: the library's
  demo::Trials trials = demo::Trials::always;
  bool deterministic = false;      // judge times only by the calibration
  std::string calibration, errors; // files; "": the library's
};

struct ExplainOptions {
  std::string graph; // or the code of a diagnostic: "D0103"
  GraphInputs inputs;
  Size size{1920, 1080};
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound; // optional imports and exports that the host does not bind
  double pixel_aspect = 0;          // width / height of a pixel; 0: 1, or the scene's
  bool two_queues = false;          // use a second queue for async passes where possible
  bool frame = false;               // explain the choices of a frame of `scene` instead of the plan
  std::string scene = shipped("configs/scenes/bust.json");
  BudgetArguments budget; // of that frame
  bool choices = false;   // list the configurations of the budget instead of the plan
  std::string out = "-";
};
ExitCode explain(const Session& session, const ExplainOptions& options);

struct GraphOptions {
  std::string graph;
  GraphInputs inputs;
  Size size{1920, 1080};
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound; // optional imports and exports that the host does not bind
  bool two_queues = false;          // use a second queue for async passes where possible
  std::string out = "-";            // DOT, or JSON with --json
  std::string html;                 // write the viewer's page to this file instead
  std::string frame;                // report of render --json, for the page
};
ExitCode graph(const Session& session, const GraphOptions& options);

struct PlanDiffOptions {
  // one or two graphs or saved plans; one graph is used for both sides
  std::vector<std::string> files;
  GraphInputs inputs; // for the graphs on both sides
  Size size{1920, 1080};
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound;
  std::vector<std::string> b_overlays; // for the second side only, after the common overlays
  Size b_size{};                       // 0x0: equal to the first side's size
  std::vector<NamedValue> b_settings;
  std::vector<std::string> b_unbound;
  bool exit_code = false; // fail if the plans differ
};
ExitCode plan_diff(const Session& session, const PlanDiffOptions& options);

struct PlanSaveOptions {
  std::string graph;
  GraphInputs inputs;
  Size size{1920, 1080};
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound;
  bool two_queues = false; // use a second queue for async passes where possible
  std::string out;         // file
};
ExitCode plan_save(const Session& session, const PlanSaveOptions& options);

struct PlanVerifyOptions {
  std::vector<std::string> files; // saved plans
};
ExitCode plan_verify(const Session& session, const PlanVerifyOptions& options);

struct TestOptions {
  // expectation files, or folders that are searched recursively
  std::vector<std::string> paths;
  bool update = false;                 // write observed values instead of comparing
  std::string junit;                   // JUnit output file
  std::vector<std::string> roots;      // folders of files that cases include or overlay
  std::vector<std::string> pass_types; // files that declare the host's pass types
};
ExitCode test(const Session& session, const TestOptions& options);

struct ModelOptions { // for scenes with a shape "model"
  std::string model, albedo, normal, specular;
  double height = 0.0; // metres; 0: as in the file
};

struct SchemaOptions {
  std::string name;      // graph, profile, ...; "": all schemas
  std::string out = "-"; // file, or the folder for all schemas
  // files of the host's pass types, which graphs and fragments may then use
  std::vector<std::string> pass_types;
};
ExitCode schema(const Session& session, const SchemaOptions& options);

struct KernelsOptions {
  std::vector<std::string> graphs; // files, or names of shipped graphs; empty: all shipped graphs
  GraphInputs inputs;
  Size size{2560, 1440};
  std::vector<NamedValue> settings; // apply to the graphs that have them, like `unbound`
  std::vector<std::string> unbound; // optional imports and exports that the host does not bind
  std::string device;               // part of its name; "": the first discrete GPU, or any device
  std::string limits;               // limits file
  std::string assembly;             // output folder
  std::string shaders;              // folder of shaders that replace the built-in ones
  bool small_groups = false;        // of at most 128 invocations
  TrafficAssumptions assumptions;
};
ExitCode kernels(const Session& session, const KernelsOptions& options);

struct DoctorOptions {};
ExitCode doctor(const Session& session, const DoctorOptions& options);

struct RenderOptions {
  std::string scene, graph, out, capture; // `capture` "": no capture
  Size size{640, 360};
  double pixel_aspect = 0; // width / height of a pixel; 0: the scene's
  uint32_t frames = 8;
  uint32_t subset = 4096; // pixels per frame compared with the reference; 0: no comparison
  std::vector<NamedValue> settings;
  GraphInputs inputs;
  ModelOptions model;
  BudgetArguments budget;
  bool taa = false; // temporal anti-aliasing in the engine
  demo::KernelShape kernels = demo::KernelShape::by_device;
  enum class Debug : uint8_t {
    none,
    samples,
    // also write images of samples or skipped tiles
    tile_class
  } debug = Debug::none;
  std::vector<std::string> unbound; // optional slots of the graph that the engine does not bind
  enum class Pictures : uint8_t { all, last } pictures = Pictures::all; // frames to write
  std::string trace;                                                    // Chrome trace output file
  std::string shaders; // folder of shaders that replace the built-in ones
};
ExitCode render(const Session& session, const RenderOptions& options);

struct CaptureOptions {
  std::string scene, out;
  Size size{640, 360};
  double pixel_aspect = 0; // width / height of a pixel; 0: the scene's
  uint32_t frames = 8, first = 0;
  ModelOptions model;
  std::vector<std::string> roots; // additional folders that scene and model may read from
};
ExitCode capture(const Session& session, const CaptureOptions& options);

struct WatchOptions {
  std::string scene, graph, out;
  GraphInputs inputs;
  std::vector<NamedValue> settings;
  Size size{320, 180};
  uint32_t frames = 4, subset = 1024;
  std::string build; // command that rebuilds the program when a shader changes
  // folder of those shaders; without `build`, renderings use the folder directly
  std::string shaders = "shaders";
  uint32_t rounds = 0; // number of renderings; 0: until stopped
};
ExitCode watch(const Session& session, const WatchOptions& options);

struct ReportBugOptions {
  std::string graph, out;
  std::string scene = shipped("configs/scenes/bust.json");
  std::string frames; // capture to use instead of the scene
  GraphInputs inputs;
  std::vector<NamedValue> settings;
  Size size{640, 360};
  uint32_t count = 8; // frames of the scene, the last of which is kept
};
ExitCode report_bug(const Session& session, const ReportBugOptions& options);

struct CalibrateOptions {
  std::string graph = shipped("configs/graphs/skin.json"),
              scene = shipped("configs/scenes/bust.json"), out = "-";
  std::string calibration; // initial calibration file; "": the library's calibration
  GraphInputs inputs;
  Size size{640, 360};
  uint32_t frames = 16; // per combination of choices and distance
};
ExitCode calibrate(const Session& session, const CalibrateOptions& options);

struct SheetOptions {
  std::string scene = shipped("configs/scenes/bust.json"), out;
  std::vector<std::string> graphs, profiles; // files; empty: the shipped ones
  std::vector<std::string> pass_types;       // files that declare the host's pass types
  std::vector<std::string> roots;            // additional folders that the scene may read from
  Size size{320, 180};                       // of one image
  std::vector<double> budgets;               // ms by calibrated times; a row each. None: no budget
  std::string calibration;                   // file; "": the library's
};
ExitCode sheet(const Session& session, const SheetOptions& options);

struct ApplyOptions {
  std::string graph, frames, out, profiles;
  GraphInputs inputs;
  std::vector<NamedValue> settings;
  uint32_t repeat = 1; // runs per frame; times are medians
};
ExitCode apply(const Session& session, const ApplyOptions& options);

struct ReferenceOptions {
  std::string frames, out, profiles;
  std::vector<std::string> roots; // additional folders that the capture may read from
  uint32_t subset = 0;            // pixels per frame; 0: all
};
ExitCode reference(const Session& session, const ReferenceOptions& options);

struct PictureRegion {
  uint32_t x = 0, y = 0;
  Size size;
  std::string text; // text of the option
};
struct CompareOptions {
  std::string a, b;
  std::vector<PictureRegion> regions;
  std::string heat;              // output file for an image of the differences
  double min_psnr = -HUGE_VAL;   // dB; fail below
  bool flip = false;             // also compute FLIP
  std::string flip_map;          // output file for an image of FLIP
  double pixels_per_degree = 67; // of the viewer, for FLIP
  double max_flip = 1;           // mean FLIP; fail above
};
ExitCode compare(const Session& session, const CompareOptions& options);

struct BenchAllOptions {
  std::string out;                         // output folder
  std::vector<std::string> suites;         // empty: all
  std::string head;                        // folder of the head scan; "": its scenes are left out
  std::string cache = "build/bench_truth"; // folder for references
  bool again = false;                      // also repeat suites that an earlier run measured
  bool quick = false;
};
ExitCode bench_all(const Session& session, const BenchAllOptions& options);

} // namespace dermis::tools
