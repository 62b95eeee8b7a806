#pragma once
// The verbs of the command, one a file, each a function of its options. arguments.cpp fills the options.

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

// name=value as given to --set; the value is JSON text, or the bare text of a JSON string.
using NamedValue = std::pair<std::string, std::string>;

// What is put together with a graph file.
struct GraphParts {
  std::vector<std::string> overlays; // files, applied in this order
  std::vector<std::string> roots; // folders that files may be read from which others name, beside their own
  std::vector<std::string> pass_types; // files of the host's pass types
};

struct ValidateOptions {
  std::vector<std::string> files; // of any kind, told apart by their version key; or folders of captures
  std::string profiles;           // folder of the profiles that captures name
  std::string sarif;              // file for the messages as SARIF, - for standard output; "": none
  GraphParts parts;               // of the graphs among the files
  bool diagnose = false;          // name usual mistakes of integration in captured frames
};
ExitCode validate(const Session& session, const ValidateOptions& options);

struct UpgradeOptions {
  std::vector<std::string> files;
  bool check = false; // write nothing, fail where something would be written
};
ExitCode upgrade(const Session& session, const UpgradeOptions& options);

struct ExplainOptions {
  std::string graph; // or the code of a diagnostic: "D0103"
  GraphParts parts;
  Size size{1920, 1080};
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound; // optional imports and exports that the host leaves out
  bool two_queues = false;          // passes declared async get a queue of their own where they can
  bool frame = false;               // what was chosen for a frame of `scene`, instead of the plan
  std::string scene = shipped("configs/scenes/bust.json");
  double budget_ms = 0; // of that frame; 0: none
  bool deterministic = false;
  std::string out = "-";
};
ExitCode explain(const Session& session, const ExplainOptions& options);

struct GraphOptions {
  std::string graph;
  GraphParts parts;
  Size size{1920, 1080};
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound; // optional imports and exports that the host leaves out
  bool two_queues = false;          // passes declared async get a queue of their own where they can
  std::string out = "-";            // DOT, or JSON with --json
  std::string html;                 // file for the page of the viewer instead; "": none
  std::string frame;                // report of render --json, for the page; "": none
};
ExitCode graph(const Session& session, const GraphOptions& options);

struct PlanDiffOptions {
  std::vector<std::string> files; // one or two: graphs or saved plans; one graph stands for both sides
  GraphParts parts;               // of the graphs on both sides
  Size size{1920, 1080};
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound;
  std::vector<std::string> b_overlays; // of the second side, after the common ones
  Size b_size{};                       // 0x0: as the first side
  std::vector<NamedValue> b_settings;
  std::vector<std::string> b_unbound;
  bool exit_code = false; // fail where the plans differ
};
ExitCode plan_diff(const Session& session, const PlanDiffOptions& options);

struct PlanSaveOptions {
  std::string graph;
  GraphParts parts;
  Size size{1920, 1080};
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound;
  bool two_queues = false; // passes declared async get a queue of their own where they can
  std::string out;         // file
};
ExitCode plan_save(const Session& session, const PlanSaveOptions& options);

struct PlanVerifyOptions {
  std::vector<std::string> files; // saved plans
};
ExitCode plan_verify(const Session& session, const PlanVerifyOptions& options);

struct TestOptions {
  std::vector<std::string> paths;      // expectation files, or folders that hold some at any depth
  bool update = false;                 // state what is observed instead of comparing
  std::string junit;                   // file for results; "": none
  std::vector<std::string> roots;      // folders of included files and of overlays that cases name
  std::vector<std::string> pass_types; // files of the host's pass types
};
ExitCode test(const Session& session, const TestOptions& options);

struct ModelOptions { // of a scene with a shape "model"
  std::string model, albedo, normal, specular;
  double height = 0.0; // metres; 0: as in the file
};

struct SchemaOptions {
  std::string name;      // graph, profile, ...; "": all of them
  std::string out = "-"; // file, or the folder for all
};
ExitCode schema(const Session& session, const SchemaOptions& options);

struct DoctorOptions {};
ExitCode doctor(const Session& session, const DoctorOptions& options);

struct RenderOptions {
  std::string scene, graph, out, capture; // capture "": none
  Size size{640, 360};
  uint32_t frames = 8;
  uint32_t subset = 4096; // pixels of a frame that are compared with the truth; 0: no comparison
  std::vector<NamedValue> settings;
  GraphParts parts;
  ModelOptions model;
  double budget_ms = 0;       // of device time for the graph's choices; 0: their defaults
  bool deterministic = false; // judge times by the calibration alone
  std::string calibration;    // file of dermis calibrate; "": the library's own
  bool taa = false;           // temporal anti-aliasing in the engine
  enum class Debug : uint8_t {
    none,
    samples,
    skips
  } debug = Debug::none; // also pictures of what the graph did
  std::string trace;     // file for a Chrome trace; "": none
  std::string shaders;   // folder of shaders that take the place of the program's; "": none
};
ExitCode render(const Session& session, const RenderOptions& options);

struct CaptureOptions {
  std::string scene, out;
  Size size{640, 360};
  uint32_t frames = 8, first = 0;
  ModelOptions model;
  std::vector<std::string> roots; // folders that scene and model may read from, beside their own
};
ExitCode capture(const Session& session, const CaptureOptions& options);

struct WatchOptions {
  std::string scene, graph, out;
  GraphParts parts;
  std::vector<NamedValue> settings;
  Size size{320, 180};
  uint32_t frames = 4, subset = 1024;
  std::string build;               // command that builds the program anew where a shader changed; "": none
  std::string shaders = "shaders"; // folder of those; without `build` renderings use what is in it
  uint32_t rounds = 0;             // renderings to make; 0: until it is stopped
};
ExitCode watch(const Session& session, const WatchOptions& options);

struct ReportBugOptions {
  std::string graph, out;
  std::string scene = shipped("configs/scenes/bust.json");
  std::string frames; // capture to take instead of the scene; "": none
  GraphParts parts;
  std::vector<NamedValue> settings;
  Size size{640, 360};
  uint32_t count = 8; // frames of the scene up to the one that is kept
};
ExitCode report_bug(const Session& session, const ReportBugOptions& options);

struct CalibrateOptions {
  std::string graph = shipped("configs/graphs/skin.json"), scene = shipped("configs/scenes/bust.json"),
              out = "-";
  std::string calibration; // file that it begins from; "": the library's own
  GraphParts parts;
  Size size{640, 360};
  uint32_t frames = 16; // of each combination of choices at each distance
};
ExitCode calibrate(const Session& session, const CalibrateOptions& options);

struct SheetOptions {
  std::string scene = shipped("configs/scenes/bust.json"), out;
  std::vector<std::string> graphs, profiles; // files; empty: those that ship
  std::vector<std::string> pass_types;       // files of the host's pass types
  std::vector<std::string> roots;            // folders that the scene may read from, beside its own
  Size size{320, 180};                       // of one picture
};
ExitCode sheet(const Session& session, const SheetOptions& options);

struct ApplyOptions {
  std::string graph, frames, out, profiles;
  GraphParts parts;
  std::vector<NamedValue> settings;
  uint32_t repeat = 1; // times each frame is run; times are medians
};
ExitCode apply(const Session& session, const ApplyOptions& options);

struct ReferenceOptions {
  std::string frames, out, profiles;
  std::vector<std::string> roots; // folders that the capture may read from, beside its own
  uint32_t subset = 0;            // pixels of a frame; 0: all
};
ExitCode reference(const Session& session, const ReferenceOptions& options);

struct PictureRegion {
  uint32_t x = 0, y = 0;
  Size size;
  std::string text; // as given
};
struct CompareOptions {
  std::string a, b;
  std::vector<PictureRegion> regions;
  std::string heat;              // file for a picture of the differences; "": none
  double min_psnr = 0;           // dB; fail below
  bool flip = false;             // also FLIP
  std::string flip_map;          // file for a picture of it; "": none
  double pixels_per_degree = 67; // of the reader's view, for FLIP
  double max_flip = 1;           // mean FLIP; fail above
};
ExitCode compare(const Session& session, const CompareOptions& options);

struct BenchCompileOptions {
  std::string shapes = shipped("tests/benchmark/shapes.json");
  std::string graphs;                  // folder of graph files to measure instead; "": none
  std::vector<std::string> pass_types; // files of the host's pass types
  std::string json, html;              // files to write; "": none
  bool optimize = false;               // also the level that takes seconds a graph
  bool quick = false;                  // smaller and fewer, to see that it runs: in the suites below as well
};
ExitCode bench_compile(const Session& session, const BenchCompileOptions& options);

struct BenchRecordOptions {
  std::string graphs = shipped("configs/graphs"), profile = shipped("configs/profiles/skin.json");
  std::vector<std::string> pass_types; // files of the host's pass types
  std::string json, html;              // files to write; "": none
  Size size{1280, 720};
};
ExitCode bench_record(const Session& session, const BenchRecordOptions& options);

struct BenchAllOptions {
  std::string out;                         // folder
  std::vector<std::string> suites;         // only these; empty: all
  std::string head;                        // folder of the head scan; "": its scenes are left out
  std::string cache = "build/bench_truth"; // folder for references
  bool again = false;                      // also what an earlier run has measured
  bool quick = false;
};
std::vector<std::string> bench_suite_names(); // "record", "skip", ...
ExitCode bench_all(const Session& session, const BenchAllOptions& options);

struct BenchErrorTimeOptions {
  std::string file = shipped("tests/benchmark/error_time.json"); // what is measured
  Size size{640, 360};
  std::string json, csv, html;             // files to write; "": none
  std::string head;                        // folder of the head scan; "": its scenes are left out
  bool study = false;                      // also the scenes that are for the study of one head
  std::vector<std::string> scenes;         // only these; empty: all
  std::vector<std::string> techniques;     // likewise
  std::string cache = "build/bench_truth"; // folder for references; "": none is kept
  bool quick = false;
};
ExitCode bench_error_time(const Session& session, const BenchErrorTimeOptions& options);

struct BenchReferenceOptions {
  std::string file = shipped("tests/benchmark/truth.json"); // techniques and tolerances
  std::string json, csv, html;                              // files to write; "": none
  bool quick = false;
};
ExitCode bench_reference(const Session& session, const BenchReferenceOptions& options);

struct BenchDynamicOptions {
  std::string file = shipped("tests/benchmark/dynamic.json"); // what is measured
  Size size{320, 180};
  uint32_t frames = 0;                       // of each sequence; 0: as the file says
  std::string json, csv, html;               // files to write; "": none
  std::string head;                          // folder of the head scan, to take the bust's place; "": none
  std::vector<std::string> scenes, framings; // only these; empty: all
  std::vector<std::string> techniques;       // likewise
  std::string cache = "build/bench_truth";   // folder for references; "": none is kept
  bool quick = false;
};
ExitCode bench_dynamic(const Session& session, const BenchDynamicOptions& options);

struct BenchSupplementOptions {
  uint32_t runs = 4096;
  std::string json, html; // files to write; "": none
};
ExitCode bench_supplement(const Session& session, const BenchSupplementOptions& options);

struct BenchStabilityOptions {
  std::string file = shipped("tests/benchmark/stability.json"); // techniques
  std::vector<std::string> cases, techniques;                   // only these; empty: all
  uint64_t updates = 1000000;                                   // of moving values in half floats
  std::string json, html;                                       // files to write; "": none
  bool quick = false;
};
ExitCode bench_stability(const Session& session, const BenchStabilityOptions& options);

struct BenchBudgetOptions {
  std::string graph = shipped("configs/graphs/skin.json");
  std::string calibration; // file of dermis calibrate; "": the library's own
  std::vector<std::string> scenes{"flashing", "regular", "dynamic", "dolly", "cut"}; // in configs/scenes
  Size size{480, 270};
  uint32_t frames = 32;                    // judged, of each run
  uint32_t repetitions = 3;                // timed runs of a budget
  std::string head;                        // folder of the head scan, for scenes that show it; "": none
  std::vector<std::string> pass_types;     // files of the host's pass types
  std::string json, html;                  // files to write; "": none
  std::string cache = "build/bench_truth"; // folder for references; "": none is kept
  bool quick = false;
};
ExitCode bench_budget(const Session& session, const BenchBudgetOptions& options);

struct BenchSkipOptions {
  std::string graph = shipped("configs/graphs/skin.json"), profile = shipped("configs/profiles/skin.json");
  Size size{1280, 720}; // of a small view the fixed cost of 22 dispatches is a large share
  uint32_t repetitions = 31;
  std::vector<std::string> pass_types; // files of the host's pass types
  std::string json, html;              // files to write; "": none
  bool quick = false;
};
ExitCode bench_skip(const Session& session, const BenchSkipOptions& options);

struct BenchRestirOptions {
  std::string file = shipped("tests/benchmark/restir.json"); // what is measured
  Size size{96, 96};
  std::string json, csv, html;             // files to write; "": none
  std::string head;                        // folder of the head scan; "": its scene is left out
  std::vector<std::string> scenes, shifts; // only these; empty: all
  std::string cache = "build/bench_truth"; // folder for references; "": none is kept
  bool quick = false;
};
ExitCode bench_restir(const Session& session, const BenchRestirOptions& options);
std::string why_no_restir(); // what this machine lacks for it; "": nothing

} // namespace dermis::tools
