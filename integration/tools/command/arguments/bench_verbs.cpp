// Verbs that measure.
#include "integration/tools/command/arguments/add_verb.hpp"

namespace dermis::tools {
namespace {

constexpr uint32_t max_sequence_frames = 3600, max_supplement_runs = 1u << 20;

// Adds options for a bench's output files; `csv` may be null.
void add_report_files(CLI::App& verb, std::string& json, std::string* csv, std::string& html,
                      const char* page) {
  verb.add_option("--json", json, "File for the rows, - for standard output")->type_name("FILE");
  if (csv != nullptr)
    verb.add_option("--csv", *csv, "File for the rows as a table, - for standard output")->type_name("FILE");
  verb.add_option("--html", html, page)->type_name("FILE");
}

void add_quick(CLI::App& verb, bool& quick, const std::vector<const char*>& instead_of = {}) {
  CLI::Option* flag = verb.add_flag("--quick", quick,
                                    "Small pictures and few repetitions, scenes or techniques: to see that "
                                    "it runs; its figures say nothing");
  for (const char* option : instead_of)
    flag->excludes(option);
}

void add_cache(CLI::App& verb, std::string& cache) {
  verb.add_option("--cache", cache, "Folder that keeps references [build/bench_truth]")->type_name("DIR");
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
      bench, invocation, "compile", "Time and memory of compiling drawn graphs, or those of a folder",
      "dermis bench compile --json build/bench_compile.json", bench_compile,
      [](CLI::App& verb, BenchCompileOptions& options) {
        verb.add_option("--shapes", options.shapes, "What is drawn [tests/benchmark/shapes.json]")
            ->type_name("FILE");
        verb.add_option("--graphs", options.graphs, "Measure the graph files of a folder instead")
            ->type_name("DIR");
        add_pass_types(verb, options.pass_types);
        verb.add_flag("--optimize", options.optimize, "Also the packing level that takes seconds a graph");
        add_quick(verb, options.quick);
        add_report_files(verb, options.json, nullptr, options.html, "File for a page with the rows");
      },
      true);
  add_verb<BenchRecordOptions>(
      bench, invocation, "record", "Time and allocations of recording graphs, on a device that only counts",
      "dermis bench record --json build/bench_record.json", bench_record,
      [](CLI::App& verb, BenchRecordOptions& options) {
        verb.add_option("--graphs", options.graphs, "Folder of graph files [configs/graphs]")
            ->type_name("DIR");
        add_pass_types(verb, options.pass_types);
        verb.add_option("--profile", options.profile, "Profile of id 1 [configs/profiles/skin.json]")
            ->type_name("FILE");
        add_size(verb, options.size);
        add_report_files(verb, options.json, nullptr, options.html, "File for a page with the rows");
      },
      true);
  add_verb<BenchAllOptions>(
      bench, invocation, "all",
      "Every suite, with pages and an index of them; a run that was stopped goes on",
      "dermis bench all --out build/bench", bench_all,
      [&invocation](CLI::App& verb, BenchAllOptions& options) {
        verb.add_option("--out,-o", options.out, "Folder for pages and rows")->required()->type_name("DIR");
        const CLI::Option* suites = repeat(verb.add_option("--suites", options.suites,
                                                           fmt::format("Only these, separated by commas: {}",
                                                                       format_list(bench_suite_names())))
                                               ->type_name("NAME")
                                               ->delimiter(','));
        invocation.offered[suites] = bench_suite_names();
        verb.add_option("--head", options.head, "Folder of the head scan, for the suites that can show it")
            ->type_name("DIR");
        verb.add_flag("--again", options.again,
                      "Measure also what an earlier run into this folder has measured");
        add_quick(verb, options.quick);
        add_cache(verb, options.cache);
      });
  add_verb<BenchErrorTimeOptions>(
      bench, invocation, "error-time", "Run time against error of every technique at every still scene",
      "dermis bench error-time --size 640x360 --json build/error_time.json --html build/error_time.html",
      bench_error_time,
      [](CLI::App& verb, BenchErrorTimeOptions& options) {
        add_size(verb, options.size);
        add_report_files(verb, options.json, &options.csv, options.html,
                         "File for a page with plots and pictures");
        add_head(verb, options.head);
        verb.add_flag("--study", options.study, "Also the framings that study one head");
        add_only(verb, "scenes", options.scenes);
        add_only(verb, "techniques", options.techniques);
        verb.add_option("--file", options.file, "What is measured [tests/benchmark/error_time.json]")
            ->type_name("FILE");
        add_quick(verb, options.quick, {"--size"});
        add_cache(verb, options.cache);
      },
      true);
  add_verb<BenchBudgetOptions>(
      bench, invocation, "budget", "How well frames keep to a budget, and what error that costs",
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
        verb.add_option("--frames", options.frames, "Judged frames of each run [32]")
            ->check(CLI::Range(4u, max_frames));
        verb.add_option("--repetitions", options.repetitions,
                        "Timed runs of each budget; the median counts [3]")
            ->check(CLI::Range(1u, 100u));
        add_head(verb, options.head);
        add_quick(verb, options.quick, {"--size", "--frames", "--scenes", "--repetitions"});
        add_report_files(verb, options.json, nullptr, options.html, "File for a page with the rows");
        add_cache(verb, options.cache);
      },
      true);
  add_verb<BenchStabilityOptions>(
      bench, invocation, "stability",
      "Every technique under everything that is known to break such techniques",
      "dermis bench stability --json build/stability.json", bench_stability,
      [](CLI::App& verb, BenchStabilityOptions& options) {
        verb.add_option("--file", options.file, "Techniques [tests/benchmark/stability.json]")
            ->type_name("FILE");
        add_only(verb, "cases", options.cases);
        repeat(verb.add_option("--techniques", options.techniques,
                               "Only these techniques, or formula; separated by commas")
                   ->type_name("NAME")
                   ->delimiter(','));
        verb.add_option("--updates", options.updates,
                        "Updates of moving values that are kept in half floats [1000000]")
            ->check(CLI::Range(uint64_t{1000}, uint64_t{1} << 40));
        add_quick(verb, options.quick, {"--updates"});
        add_report_files(verb, options.json, nullptr, options.html, "File for a page with the rows");
      },
      true);
  add_verb<BenchSkipOptions>(
      bench, invocation, "skip", "What frames cost that do not need all of a graph",
      "dermis bench skip --json build/skip.json", bench_skip,
      [](CLI::App& verb, BenchSkipOptions& options) {
        add_size(verb, options.size);
        verb.add_option("--graph", options.graph, "Graph file [configs/graphs/skin.json]")->type_name("FILE");
        add_pass_types(verb, options.pass_types);
        verb.add_option("--profile", options.profile, "Profile of the plane [configs/profiles/skin.json]")
            ->type_name("FILE");
        verb.add_option("--repetitions", options.repetitions, "Timed frames of each case [31]")
            ->check(CLI::Range(1u, max_sequence_frames));
        add_quick(verb, options.quick, {"--size", "--repetitions"});
        add_report_files(verb, options.json, nullptr, options.html, "File for a page with the rows");
      },
      true);
  add_verb<BenchReferenceOptions>(
      bench, invocation, "truth", "Laws with known answers, beside what every technique makes of them",
      "dermis bench truth --json build/truth.json", bench_reference,
      [](CLI::App& verb, BenchReferenceOptions& options) {
        add_report_files(verb, options.json, &options.csv, options.html, "File for a page with the rows");
        verb.add_option("--file", options.file, "Techniques and tolerances [tests/benchmark/truth.json]")
            ->type_name("FILE");
        add_quick(verb, options.quick);
      },
      true);
  add_verb<BenchDynamicOptions>(
      bench, invocation, "dynamic", "Samples, time, error and flicker while light, camera or things change",
      "dermis bench dynamic --json build/dynamic.json --html build/dynamic.html", bench_dynamic,
      [](CLI::App& verb, BenchDynamicOptions& options) {
        add_size(verb, options.size);
        verb.add_option("--frames", options.frames, "Frames of each sequence [as the file says]")
            ->check(CLI::Range(1u, max_sequence_frames));
        add_report_files(verb, options.json, &options.csv, options.html, "File for a page with plots");
        verb.add_option("--head", options.head, "Folder of the head scan, which takes the bust's place")
            ->type_name("DIR");
        add_only(verb, "scenes", options.scenes);
        add_only(verb, "framings", options.framings);
        add_only(verb, "techniques", options.techniques);
        verb.add_option("--file", options.file, "What is measured [tests/benchmark/dynamic.json]")
            ->type_name("FILE");
        add_quick(verb, options.quick, {"--size", "--frames"});
        add_cache(verb, options.cache);
      },
      true);
  add_verb<BenchRestirOptions>(
      bench, invocation, "restir",
      "Light by rays with every reuse and shift that the graph offers, and what screen space misses; needs "
      "ray "
      "queries. Equal time: mean square error times device time, over the same without reuse, since the "
      "error of "
      "independent samples falls as one over their number",
      "dermis bench restir --json build/restir.json --html build/restir.html", bench_restir,
      [](CLI::App& verb, BenchRestirOptions& options) {
        add_size(verb, options.size);
        add_report_files(verb, options.json, &options.csv, options.html,
                         "File for a page with the rows and pictures");
        add_head(verb, options.head);
        add_only(verb, "scenes", options.scenes);
        add_only(verb, "shifts", options.shifts);
        verb.add_option("--file", options.file, "What is measured [tests/benchmark/restir.json]")
            ->type_name("FILE");
        add_quick(verb, options.quick, {"--size"});
        add_cache(verb, options.cache);
      },
      true);
  add_verb<BenchSupplementOptions>(
      bench, invocation, "supplement", "Table 1 of the supplement on control variates, from many runs",
      "dermis bench supplement --json build/supplement.json", bench_supplement,
      [](CLI::App& verb, BenchSupplementOptions& options) {
        verb.add_option("--runs", options.runs, "Runs of 100 frames [4096]")
            ->check(CLI::Range(16u, max_supplement_runs));
        add_report_files(verb, options.json, nullptr, options.html, "File for a page with the rows");
      },
      true);
}

} // namespace dermis::tools
