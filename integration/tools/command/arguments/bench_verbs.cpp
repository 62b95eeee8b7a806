// Verbs that measure.
#include "integration/tools/command/arguments/add_verb.hpp"

namespace dermis::tools {
namespace {

constexpr uint32_t max_sequence_frames = 3600, max_supplement_runs = 1u << 20;

// Adds options for a bench's output files; `csv` may be null.
void add_report_files(CLI::App& verb, std::string& json, std::string* csv, std::string& html,
                      const char* page) {
  verb.add_option("--json", json, "Write the rows as JSON to this file, - for standard output")
      ->type_name("FILE");
  if (csv != nullptr)
    verb.add_option("--csv", *csv, "Write the rows as CSV to this file, - for standard output")
        ->type_name("FILE");
  verb.add_option("--html", html, page)->type_name("FILE");
}

void add_quick(CLI::App& verb, bool& quick, const std::vector<const char*>& instead_of = {}) {
  CLI::Option* flag = verb.add_flag(
      "--quick", quick,
      "Smoke test with small images and few repetitions, scenes or techniques; figures are meaningless");
  for (const char* option : instead_of)
    flag->excludes(option);
}

void add_cache(CLI::App& verb, std::string& cache) {
  verb.add_option("--cache", cache, "Folder of cached references [build/bench_truth]")->type_name("DIR");
}

void add_head(CLI::App& verb, std::string& head) {
  verb.add_option("--head", head, "Folder of the head scan (LeePerrySmith.glb and its maps)")
      ->type_name("DIR");
}

// Adds an option that restricts the bench to some names of a type ("scenes").
void add_only(CLI::App& verb, const std::string& kind, std::vector<std::string>& names) {
  repeat(verb.add_option("--" + kind, names, "Only these " + kind + ", separated by commas")
             ->type_name("NAME")
             ->delimiter(','));
}

} // namespace

void add_bench_verbs(CLI::App& app, Invocation& invocation) {
  CLI::App& bench = add_group(app, "bench", "Measure the library on this machine",
                              "dermis bench record --html bench_record.html");
  add_verb<BenchCompileOptions>(
      bench, invocation, "compile", "Measure time and memory of compiling random graphs or given graphs",
      "dermis bench compile --json build/bench_compile.json", bench_compile,
      [](CLI::App& verb, BenchCompileOptions& options) {
        verb.add_option("--shapes", options.shapes,
                        "Description of the random graphs [tests/benchmark/shapes.json]")
            ->type_name("FILE");
        verb.add_option("--graphs", options.graphs, "Measure the graph files of a folder instead")
            ->type_name("DIR");
        add_pass_types(verb, options.pass_types);
        verb.add_flag("--optimize", options.optimize,
                      "Also measure the packing level that takes seconds per graph");
        add_quick(verb, options.quick);
        add_report_files(verb, options.json, nullptr, options.html,
                         "Write an HTML page with the rows to this file");
      },
      true);
  add_verb<BenchRecordOptions>(
      bench, invocation, "record",
      "Measure time and allocations of recording graphs, on a device that only counts",
      "dermis bench record --json build/bench_record.json", bench_record,
      [](CLI::App& verb, BenchRecordOptions& options) {
        verb.add_option("--graphs", options.graphs, "Folder of graph files [configs/graphs]")
            ->type_name("DIR");
        add_pass_types(verb, options.pass_types);
        verb.add_option("--profile", options.profile, "Profile of id 1 [configs/profiles/skin.json]")
            ->type_name("FILE");
        add_size(verb, options.size);
        add_report_files(verb, options.json, nullptr, options.html,
                         "Write an HTML page with the rows to this file");
      },
      true);
  add_verb<BenchAllOptions>(
      bench, invocation, "all", "Run every suite and write pages with an index; continues an interrupted run",
      "dermis bench all --out build/bench", bench_all,
      [&invocation](CLI::App& verb, BenchAllOptions& options) {
        verb.add_option("--out,-o", options.out, "Folder for pages and rows")->required()->type_name("DIR");
        const CLI::Option* suites = repeat(verb.add_option("--suites", options.suites,
                                                           fmt::format("Only these, separated by commas: {}",
                                                                       format_list(bench_suite_names())))
                                               ->type_name("NAME")
                                               ->delimiter(','));
        invocation.offered[suites] = bench_suite_names();
        verb.add_option("--head", options.head, "Folder of the head scan, for suites that support it")
            ->type_name("DIR");
        verb.add_flag("--again", options.again,
                      "Repeat suites that an earlier run into this folder measured");
        add_quick(verb, options.quick);
        add_cache(verb, options.cache);
      });
  add_verb<BenchErrorTimeOptions>(
      bench, invocation, "error-time", "Measure run time and error of every technique on every still scene",
      "dermis bench error-time --size 640x360 --json build/error_time.json --html build/error_time.html",
      bench_error_time,
      [](CLI::App& verb, BenchErrorTimeOptions& options) {
        add_size(verb, options.size);
        add_report_files(verb, options.json, &options.csv, options.html,
                         "Write an HTML page with plots and images to this file");
        add_head(verb, options.head);
        verb.add_flag("--study", options.study, "Also measure the framings that study one head");
        add_only(verb, "scenes", options.scenes);
        add_only(verb, "techniques", options.techniques);
        verb.add_option("--file", options.file,
                        "Description of the benchmark [tests/benchmark/error_time.json]")
            ->type_name("FILE");
        add_quick(verb, options.quick, {"--size"});
        add_cache(verb, options.cache);
      },
      true);
  add_verb<BenchBudgetOptions>(
      bench, invocation, "budget", "Measure how well frames keep a budget, and at what error",
      "dermis bench budget --json build/budget.json", bench_budget,
      [](CLI::App& verb, BenchBudgetOptions& options) {
        add_size(verb, options.size);
        verb.add_option("--graph", options.graph, "Graph with choices by budget [configs/graphs/skin.json]")
            ->type_name("FILE");
        add_pass_types(verb, options.pass_types);
        verb.add_option("--calibration", options.calibration, "What dermis calibrate wrote for this device")
            ->type_name("FILE");
        repeat(verb.add_option("--scenes", options.scenes, "Scenes of configs/scenes, separated by commas")
                   ->type_name("NAME")
                   ->delimiter(','));
        verb.add_option("--frames", options.frames, "Judged frames per run [32]")
            ->check(CLI::Range(4u, max_frames));
        verb.add_option("--repetitions", options.repetitions,
                        "Timed runs per budget; results are medians [3]")
            ->check(CLI::Range(1u, 100u));
        add_head(verb, options.head);
        add_quick(verb, options.quick, {"--size", "--frames", "--scenes", "--repetitions"});
        add_report_files(verb, options.json, nullptr, options.html,
                         "Write an HTML page with the rows to this file");
        add_cache(verb, options.cache);
      },
      true);
  add_verb<BenchStabilityOptions>(
      bench, invocation, "stability", "Test every technique with damaged and extreme inputs",
      "dermis bench stability --json build/stability.json", bench_stability,
      [](CLI::App& verb, BenchStabilityOptions& options) {
        verb.add_option("--file", options.file, "Techniques [tests/benchmark/stability.json]")
            ->type_name("FILE");
        add_only(verb, "cases", options.cases);
        repeat(verb.add_option("--techniques", options.techniques,
                               "Only these techniques or formula, separated by commas")
                   ->type_name("NAME")
                   ->delimiter(','));
        verb.add_option("--updates", options.updates, "Updates of moving averages in half floats [1000000]")
            ->check(CLI::Range(uint64_t{1000}, uint64_t{1} << 40));
        add_quick(verb, options.quick, {"--updates"});
        add_report_files(verb, options.json, nullptr, options.html,
                         "Write an HTML page with the rows to this file");
      },
      true);
  add_verb<BenchSkipOptions>(
      bench, invocation, "skip", "Measure frames that do not need all of a graph",
      "dermis bench skip --json build/skip.json", bench_skip,
      [](CLI::App& verb, BenchSkipOptions& options) {
        add_size(verb, options.size);
        verb.add_option("--graph", options.graph, "Graph file [configs/graphs/skin.json]")->type_name("FILE");
        add_pass_types(verb, options.pass_types);
        verb.add_option("--profile", options.profile, "Profile of the plane [configs/profiles/skin.json]")
            ->type_name("FILE");
        verb.add_option("--repetitions", options.repetitions, "Timed frames per case [31]")
            ->check(CLI::Range(1u, max_sequence_frames));
        add_quick(verb, options.quick, {"--size", "--repetitions"});
        add_report_files(verb, options.json, nullptr, options.html,
                         "Write an HTML page with the rows to this file");
      },
      true);
  add_verb<BenchReferenceOptions>(
      bench, invocation, "truth", "Compare every technique with known results",
      "dermis bench truth --json build/truth.json", bench_reference,
      [](CLI::App& verb, BenchReferenceOptions& options) {
        add_report_files(verb, options.json, &options.csv, options.html,
                         "Write an HTML page with the rows to this file");
        verb.add_option("--file", options.file, "Techniques and tolerances [tests/benchmark/truth.json]")
            ->type_name("FILE");
        add_quick(verb, options.quick);
      },
      true);
  add_verb<BenchDynamicOptions>(
      bench, invocation, "dynamic",
      "Measure samples, time, error and flicker with changing light, camera or objects",
      "dermis bench dynamic --json build/dynamic.json --html build/dynamic.html", bench_dynamic,
      [](CLI::App& verb, BenchDynamicOptions& options) {
        add_size(verb, options.size);
        verb.add_option("--frames", options.frames, "Frames per sequence [as in the file]")
            ->check(CLI::Range(1u, max_sequence_frames));
        add_report_files(verb, options.json, &options.csv, options.html,
                         "Write an HTML page with plots to this file");
        verb.add_option("--head", options.head, "Folder of the head scan, which replaces the bust")
            ->type_name("DIR");
        add_only(verb, "scenes", options.scenes);
        add_only(verb, "framings", options.framings);
        add_only(verb, "techniques", options.techniques);
        verb.add_option("--file", options.file, "Description of the benchmark [tests/benchmark/dynamic.json]")
            ->type_name("FILE");
        add_quick(verb, options.quick, {"--size", "--frames"});
        add_cache(verb, options.cache);
      },
      true);
  add_verb<BenchRestirOptions>(
      bench, invocation, "restir",
      "Compare ray-traced light with every reuse and shift of the graph, and screen-space techniques. Needs "
      "ray queries. Ratios at equal time are mean square error times device time, relative to no reuse, "
      "since the error of independent samples is inversely proportional to their number",
      "dermis bench restir --json build/restir.json --html build/restir.html", bench_restir,
      [](CLI::App& verb, BenchRestirOptions& options) {
        add_size(verb, options.size);
        add_report_files(verb, options.json, &options.csv, options.html,
                         "Write an HTML page with the rows and images to this file");
        add_head(verb, options.head);
        add_only(verb, "scenes", options.scenes);
        add_only(verb, "shifts", options.shifts);
        verb.add_option("--file", options.file, "Description of the benchmark [tests/benchmark/restir.json]")
            ->type_name("FILE");
        add_quick(verb, options.quick, {"--size"});
        add_cache(verb, options.cache);
      },
      true);
  add_verb<BenchSupplementOptions>(
      bench, invocation, "supplement",
      "Reproduce table 1 of the supplement on control variates from many runs",
      "dermis bench supplement --json build/supplement.json", bench_supplement,
      [](CLI::App& verb, BenchSupplementOptions& options) {
        verb.add_option("--runs", options.runs, "Runs of 100 frames [4096]")
            ->check(CLI::Range(16u, max_supplement_runs));
        add_report_files(verb, options.json, nullptr, options.html,
                         "Write an HTML page with the rows to this file");
      },
      true);
}

} // namespace dermis::tools
