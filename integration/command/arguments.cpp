#include "integration/command/arguments.hpp"

#include "framegraph/text/suggest.hpp"
#include "integration/command/inspect/schemas.hpp"
#include "integration/command/verbs.hpp"

#include <CLI/CLI.hpp>
#include <dermis/dermis.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <memory>

namespace dermis::tools {
namespace {

constexpr uint32_t max_side = 16384; // pixels; dermis.h, dermis_graph_desc
constexpr uint32_t max_frames = 100000;
constexpr uint32_t max_repeat = 10000;
constexpr uint32_t max_subset = 1u << 24u; // pixels

std::string check_size(const std::string& text) {
  uint32_t width = 0, height = 0;
  return parse_size(text, width, height);
}

std::string check_named_value(const std::string& text) {
  const size_t equals = text.find('=');
  return equals == std::string::npos || equals == 0 || equals + 1 == text.size()
             ? fmt::format("'{}' is not name=value", text)
             : "";
}

CLI::Option* add_size(CLI::App& verb, Size& size, const char* name = "--size") {
  return verb
      .add_option_function<std::string>(
          name, [&size](const std::string& text) { parse_size(text, size.width, size.height); },
          fmt::format("Pixels, WIDTHxHEIGHT, each 1..{}{}", max_side,
                      size.width == 0 ? "" : fmt::format(" [{}x{}]", size.width, size.height)))
      ->check(CLI::Validator(check_size, "WxH"));
}

void add_settings(CLI::App& verb, std::vector<NamedValue>& settings, const char* name = "--set") {
  verb.add_option_function<std::vector<std::string>>(
          name,
          [&settings](const std::vector<std::string>& all) {
            for (const std::string& one : all) {
              const size_t equals = one.find('=');
              settings.emplace_back(one.substr(0, equals), one.substr(equals + 1));
            }
          },
          "Value of a setting of the graph; may be repeated")
      ->check(CLI::Validator(check_named_value, "NAME=VALUE"))
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_root(CLI::App& verb, std::vector<std::string>& roots, const char* what) {
  verb.add_option("--root", roots, what)
      ->type_name("DIR")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_parts(CLI::App& verb, GraphParts& parts) {
  verb.add_option("--overlay", parts.overlays, "Overlay to apply to the graph; may be repeated, in order")
      ->type_name("FILE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_root(verb, parts.roots,
           "Folder that included files are read from, beside the graph's own; may be repeated");
}

void add_two_queues(CLI::App& verb, bool& two_queues) {
  verb.add_flag("--two-queues", two_queues, "Passes declared async get a queue of their own where they can");
}

void add_common(CLI::App& verb, Session& session, bool json_is_file = false) {
  static const std::map<std::string, ColorMode> modes{
      {"auto", ColorMode::automatic}, {"always", ColorMode::always}, {"never", ColorMode::never}};
  const char* group = "Common options";
  if (!json_is_file)
    verb.add_flag("--json", session.json, "One JSON document on standard output, for programs")->group(group);
  verb.add_flag("--quiet,-q", session.quiet, "Errors only")->group(group);
  verb.add_option("--color", session.color, "Colour: auto, always or never [auto]")
      ->transform(CLI::CheckedTransformer(modes).description("MODE"))
      ->group(group);
}

// The verb's options live as long as the function that runs it.
template <class Options, class Declare>
void add_verb(CLI::App& app, Invocation& invocation, const char* name, const char* what, const char* example,
              ExitCode (*work)(const Session&, const Options&), Declare declare, bool json_is_file = false) {
  CLI::App& verb = *app.add_subcommand(name, what);
  verb.footer(fmt::format("Example:\n  {}", example));
  auto options = std::make_shared<Options>();
  add_common(verb, invocation.session, json_is_file);
  declare(verb, *options);
  verb.callback([&invocation, options, work] {
    invocation.run = [options, work](const Session& session) { return work(session, *options); };
  });
}

void add_text_verbs(CLI::App& app, Invocation& invocation) {
  add_verb<ValidateOptions>(
      app, invocation, "validate", "Check graphs, profiles, scenes, expectations and captures",
      "dermis validate configs/graphs/burley.json\n  dermis validate capture/ --sarif results.sarif",
      validate, [](CLI::App& verb, ValidateOptions& options) {
        verb.add_option("files", options.files,
                        "Files to check; a folder stands for the captured frames in it")
            ->required()
            ->type_name("FILE");
        verb.add_option("--profiles", options.profiles,
                        "Folder of profiles that captures name [configs/profiles]")
            ->type_name("DIR");
        add_parts(verb, options.parts);
        verb.add_option("--sarif", options.sarif,
                        "File for the messages as SARIF 2.1.0, - for standard output")
            ->type_name("FILE");
      });
  add_verb<UpgradeOptions>(
      app, invocation, "upgrade", "Bring files to the newest version of their format",
      "dermis upgrade configs/graphs/burley.json\n  dermis upgrade --check configs/graphs/*.json", upgrade,
      [](CLI::App& verb, UpgradeOptions& options) {
        verb.add_option("files", options.files, "Files to upgrade in place")->required()->type_name("FILE");
        verb.add_flag("--check", options.check, "Write nothing; fail if a file is not of the newest version");
      });
  add_verb<ExplainOptions>(
      app, invocation, "explain", "Show the plan of a graph with the reason for each decision",
      "dermis explain configs/graphs/burley.json --size 1920x1080\n  dermis explain D0103", explain,
      [](CLI::App& verb, ExplainOptions& options) {
        verb.add_option("graph", options.graph, "Graph file, or the code of a message")
            ->required()
            ->type_name("FILE");
        add_size(verb, options.size);
        add_settings(verb, options.settings);
        verb.add_option("--unbound", options.unbound, "Optional slots that the host leaves out")
            ->type_name("NAME")
            ->delimiter(',');
        add_two_queues(verb, options.two_queues);
        add_parts(verb, options.parts);
        verb.add_option("--out,-o", options.out, "File to write, - for standard output [-]")
            ->type_name("FILE");
      });
  add_verb<GraphOptions>(
      app, invocation, "graph", "Write the graph and its plan as DOT (or JSON with --json)",
      "dermis graph configs/graphs/burley.json | dot -Tsvg > burley.svg", graph,
      [](CLI::App& verb, GraphOptions& options) {
        verb.add_option("graph", options.graph, "Graph file")->required()->type_name("FILE");
        verb.add_flag_callback(
                "--dot", [] {}, "DOT for Graphviz; the default")
            ->excludes("--json");
        add_size(verb, options.size);
        add_settings(verb, options.settings);
        add_parts(verb, options.parts);
        verb.add_option("--out,-o", options.out, "File to write, - for standard output [-]")
            ->type_name("FILE");
      });
  add_verb<TestOptions>(
      app, invocation, "test", "Compare graphs with the expectations that stand beside them",
      "dermis test configs/\n  dermis test configs/ --junit results.xml", test,
      [](CLI::App& verb, TestOptions& options) {
        verb.add_option("paths", options.paths, "Expectation files (NAME.expect.json), or folders of them")
            ->required()
            ->type_name("PATH");
        verb.add_flag("--update", options.update,
                      "State what is found now, in the files; review the change before you commit it");
        add_root(verb, options.roots,
                 "Folder of included files and of overlays that cases name, beside the graph's own and the "
                 "folders given; may be repeated");
        verb.add_option("--junit", options.junit, "File for the results as JUnit XML")->type_name("FILE");
      });
}

void add_unbound(CLI::App& verb, std::vector<std::string>& unbound, const char* name = "--unbound") {
  verb.add_option(name, unbound, "Optional slots that the host leaves out")
      ->type_name("NAME")
      ->delimiter(',');
}

void add_plan_verbs(CLI::App& app, Invocation& invocation) {
  CLI::App& plan = *app.add_subcommand("plan", "Save plans, verify saved ones, compare two");
  plan.require_subcommand(1);
  add_verb<PlanDiffOptions>(
      plan, invocation, "diff",
      "What differs between the plans of two graphs, of one graph, or two saved plans",
      "dermis plan diff configs/graphs/burley.json configs/graphs/sap.json\n"
      "  dermis plan diff configs/graphs/burley.json --b-size 960x540 --b-unbound velocity\n"
      "  dermis plan diff before.plan configs/graphs/burley.json --exit-code",
      plan_diff, [](CLI::App& verb, PlanDiffOptions& options) {
        verb.add_option(
                "files", options.files,
                "Two graphs or saved plans, A and B; one graph stands for both, told apart by --b-...")
            ->required()
            ->expected(1, 2)
            ->type_name("FILE");
        add_parts(verb, options.parts);
        add_size(verb, options.size);
        add_settings(verb, options.settings);
        add_unbound(verb, options.unbound);
        verb.add_flag("--exit-code", options.exit_code, "Exit with 1 where the plans differ");
        const char* group = "Of B alone, after what both have in common";
        add_size(verb, options.b_size, "--b-size")->group(group);
        add_settings(verb, options.b_settings, "--b-set");
        verb.get_option("--b-set")->group(group);
        add_unbound(verb, options.b_unbound, "--b-unbound");
        verb.get_option("--b-unbound")->group(group);
        verb.add_option("--b-overlay", options.b_overlays, "Overlay to apply to the graph; may be repeated")
            ->type_name("FILE")
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
            ->group(group);
      });
  add_verb<PlanSaveOptions>(
      plan, invocation, "save", "Compile a graph and write its plan to a file",
      "dermis plan save configs/graphs/burley.json --size 1280x720 --out burley.plan", plan_save,
      [](CLI::App& verb, PlanSaveOptions& options) {
        verb.add_option("graph", options.graph, "Graph file")->required()->type_name("FILE");
        add_parts(verb, options.parts);
        add_size(verb, options.size);
        add_settings(verb, options.settings);
        add_two_queues(verb, options.two_queues);
        add_unbound(verb, options.unbound);
        verb.add_option("--out,-o", options.out, "File to write")->required()->type_name("FILE");
      });
  add_verb<PlanVerifyOptions>(
      plan, invocation, "verify", "Prove saved plans free of hazards, from nothing but the file",
      "dermis plan verify burley.plan", plan_verify, [](CLI::App& verb, PlanVerifyOptions& options) {
        verb.add_option("files", options.files, "Saved plans")->required()->type_name("FILE");
      });
}

void add_schema_verb(CLI::App& app, Invocation& invocation) {
  add_verb<SchemaOptions>(
      app, invocation, "schema", "Write the JSON Schemas of the file formats, for editors",
      "dermis schema graph\n  dermis schema --out configs/schema", schema,
      [](CLI::App& verb, SchemaOptions& options) {
        verb.add_option("name", options.name, fmt::format("One of {}; without one: all", schema_names()))
            ->type_name("NAME");
        verb.add_option("--out,-o", options.out,
                        "File to write, - for standard output [-]; a folder where all are written")
            ->type_name("PATH");
      });
}

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
        verb.add_option("--subset", options.subset,
                        "Pixels of the last frame compared with the truth; 0: none [4096]")
            ->check(CLI::Range(0u, max_subset));
        add_settings(verb, options.settings);
        add_parts(verb, options.parts);
        const char* group = "Model, for scenes that show one";
        verb.add_option("--model", options.model.model, "glTF file")->type_name("FILE")->group(group);
        verb.add_option("--albedo", options.model.albedo, "Picture, sRGB")->type_name("FILE")->group(group);
        verb.add_option("--normal", options.model.normal, "Tangent-space normal map")
            ->type_name("FILE")
            ->group(group);
        verb.add_option("--specular", options.model.specular, "Picture, linear")
            ->type_name("FILE")
            ->group(group);
        verb.add_option("--height", options.model.height, "Height in metres that the model is scaled to")
            ->check(CLI::Range(1e-3, 1e3))
            ->group(group);
      });
  add_verb<SheetOptions>(
      app, invocation, "sheet", "Render a scene with every technique and material into one picture",
      "dermis sheet --out out/sheet.png", sheet, [](CLI::App& verb, SheetOptions& options) {
        verb.add_option("scene", options.scene, "Scene file [configs/scenes/bust.json]")->type_name("FILE");
        verb.add_option("--out,-o", options.out, "Picture, PNG")->required()->type_name("FILE");
        verb.add_option("--graphs", options.graphs,
                        "Graph files, one row each, below one without a graph [those that ship]")
            ->delimiter(',')
            ->type_name("FILE ...");
        verb.add_option(
                "--profiles", options.profiles,
                "Profile files, one column each, for all objects that scatter [skin, jade, marble, wax, "
                "ketchup, milk]")
            ->delimiter(',')
            ->type_name("FILE ...");
        add_size(verb, options.size);
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
      });
}

constexpr uint32_t most_sequence_frames = 3600, most_supplement_runs = 1u << 20;

void add_bench_verbs(CLI::App& app, Invocation& invocation) {
  CLI::App& bench = *app.add_subcommand("bench", "Measure the library on this machine");
  bench.require_subcommand(1);
  add_verb<BenchCompileOptions>(
      bench, invocation, "compile", "Time and memory of compiling drawn graphs, or those of a folder",
      "dermis bench compile --json build/bench_compile.json", bench_compile,
      [](CLI::App& verb, BenchCompileOptions& options) {
        verb.add_option("--shapes", options.shapes, "What is drawn [tests/benchmark/shapes.json]")
            ->type_name("FILE");
        verb.add_option("--graphs", options.graphs, "Measure the graph files of a folder instead")
            ->type_name("DIR");
        verb.add_flag("--optimize", options.optimize, "Also the packing level that takes seconds a graph");
        verb.add_option("--json", options.json, "File for the rows, - for standard output")
            ->type_name("FILE");
      },
      true);
  add_verb<BenchRecordOptions>(
      bench, invocation, "record", "Time and allocations of recording graphs, on a device that only counts",
      "dermis bench record --json build/bench_record.json", bench_record,
      [](CLI::App& verb, BenchRecordOptions& options) {
        verb.add_option("--graphs", options.graphs, "Folder of graph files [configs/graphs]")
            ->type_name("DIR");
        verb.add_option("--profile", options.profile, "Profile of id 1 [configs/profiles/skin.json]")
            ->type_name("FILE");
        add_size(verb, options.size);
        verb.add_option("--json", options.json, "File for the rows, - for standard output")
            ->type_name("FILE");
      },
      true);
  add_verb<BenchErrorTimeOptions>(
      bench, invocation, "error-time", "Run time against error of every technique at every still scene",
      "dermis bench error-time --size 640x360 --json build/error_time.json --html build/error_time.html",
      bench_error_time,
      [](CLI::App& verb, BenchErrorTimeOptions& options) {
        add_size(verb, options.size);
        verb.add_option("--json", options.json, "File for the rows, - for standard output")
            ->type_name("FILE");
        verb.add_option("--csv", options.csv, "File for the rows as a table, - for standard output")
            ->type_name("FILE");
        verb.add_option("--html", options.html, "File for a page with plots and pictures")->type_name("FILE");
        verb.add_option("--head", options.head, "Folder of the head scan (LeePerrySmith.glb and its maps)")
            ->type_name("DIR");
        verb.add_flag("--study", options.study, "Also the framings that study one head");
        verb.add_option("--scenes", options.scenes, "Only these scenes, separated by commas")
            ->type_name("NAME")
            ->delimiter(',');
        verb.add_option("--techniques", options.techniques, "Only these techniques, separated by commas")
            ->type_name("NAME")
            ->delimiter(',');
        verb.add_option("--file", options.file, "What is measured [tests/benchmark/error_time.json]")
            ->type_name("FILE");
        verb.add_option("--cache", options.cache, "Folder that keeps references [build/bench_truth]")
            ->type_name("DIR");
      },
      true);
  add_verb<BenchTruthOptions>(
      bench, invocation, "truth", "Laws with known answers, beside what every technique makes of them",
      "dermis bench truth --json build/truth.json", bench_truth,
      [](CLI::App& verb, BenchTruthOptions& options) {
        verb.add_option("--json", options.json, "File for the rows, - for standard output")
            ->type_name("FILE");
        verb.add_option("--csv", options.csv, "File for the rows as a table, - for standard output")
            ->type_name("FILE");
        verb.add_option("--html", options.html, "File for a page with the rows")->type_name("FILE");
        verb.add_option("--file", options.file, "Techniques and tolerances [tests/benchmark/truth.json]")
            ->type_name("FILE");
      },
      true);
  add_verb<BenchDynamicOptions>(
      bench, invocation, "dynamic", "Samples, time, error and flicker while light, camera or things change",
      "dermis bench dynamic --json build/dynamic.json --html build/dynamic.html", bench_dynamic,
      [](CLI::App& verb, BenchDynamicOptions& options) {
        add_size(verb, options.size);
        verb.add_option("--frames", options.frames, "Frames of each sequence [as the file says]")
            ->check(CLI::Range(1u, most_sequence_frames));
        verb.add_option("--json", options.json, "File for the rows, - for standard output")
            ->type_name("FILE");
        verb.add_option("--csv", options.csv, "File for the rows as a table, - for standard output")
            ->type_name("FILE");
        verb.add_option("--html", options.html, "File for a page with plots")->type_name("FILE");
        verb.add_option("--head", options.head, "Folder of the head scan, which takes the bust's place")
            ->type_name("DIR");
        verb.add_option("--scenes", options.scenes, "Only these scenes, separated by commas")
            ->type_name("NAME")
            ->delimiter(',');
        verb.add_option("--framings", options.framings, "Only these framings, separated by commas")
            ->type_name("NAME")
            ->delimiter(',');
        verb.add_option("--techniques", options.techniques, "Only these techniques, separated by commas")
            ->type_name("NAME")
            ->delimiter(',');
        verb.add_option("--file", options.file, "What is measured [tests/benchmark/dynamic.json]")
            ->type_name("FILE");
        verb.add_option("--cache", options.cache, "Folder that keeps references [build/bench_truth]")
            ->type_name("DIR");
      },
      true);
  add_verb<BenchSupplementOptions>(
      bench, invocation, "supplement", "Table 1 of the supplement on control variates, from many runs",
      "dermis bench supplement --json build/supplement.json", bench_supplement,
      [](CLI::App& verb, BenchSupplementOptions& options) {
        verb.add_option("--runs", options.runs, "Runs of 100 frames [4096]")
            ->check(CLI::Range(16u, most_supplement_runs));
        verb.add_option("--json", options.json, "File for the rows, - for standard output")
            ->type_name("FILE");
        verb.add_option("--html", options.html, "File for a page with the rows")->type_name("FILE");
      },
      true);
}

std::string_view name_part(std::string_view argument) {
  return argument.substr(0, argument.find('='));
}

// A misspelt verb or option, said before CLI11 complains of what else is missing; "" when all are known.
std::string find_misspelling(CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2) return "";
  const std::string first = argv[1];
  if (first.starts_with("-")) return "";
  const std::vector<CLI::App*> verbs = app.get_subcommands([](CLI::App*) { return true; });
  const auto found =
      std::find_if(verbs.begin(), verbs.end(), [&](const CLI::App* one) { return one->get_name() == first; });
  std::vector<std::string> names;
  if (found == verbs.end()) {
    for (const CLI::App* one : verbs)
      names.push_back(one->get_name());
    const std::vector<std::string_view> words(names.begin(), names.end());
    const std::string suggestion = did_you_mean(first, words);
    return fmt::format("there is no verb '{}'; {}", first,
                       suggestion.empty() ? "verbs: " + list_words(words) : suggestion);
  }
  CLI::App* verb = *found;
  int options_from = 2;
  if (argc > 2)
    for (CLI::App* inner : verb->get_subcommands([](CLI::App*) { return true; }))
      if (inner->get_name() == argv[2]) {
        verb = inner;
        options_from = 3;
      }
  for (int i = options_from; i < argc && std::string_view(argv[i]) != "--"; ++i) {
    const std::string name(name_part(argv[i]));
    if (!name.starts_with("--") || verb->get_option_no_throw(name) != nullptr) continue;
    for (const CLI::Option* one : verb->get_options())
      for (const std::string& known : one->get_lnames())
        names.push_back("--" + known);
    const std::vector<std::string_view> words(names.begin(), names.end());
    const std::string suggestion = did_you_mean(name, words);
    return fmt::format("'{}' has no option '{}'; {}", first, name,
                       suggestion.empty() ? fmt::format("'dermis {} --help' lists them", first) : suggestion);
  }
  return "";
}

} // namespace

std::string parse_size(const std::string& text, uint32_t& width, uint32_t& height) {
  const std::string expected =
      fmt::format("expected WIDTHxHEIGHT such as 640x360, each 1..{}, found '{}'", max_side, text);
  const char* end = text.data() + text.size();
  uint32_t sides[2] = {};
  const auto first = std::from_chars(text.data(), end, sides[0]);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != 'x') return expected;
  const auto second = std::from_chars(first.ptr + 1, end, sides[1]);
  if (second.ec != std::errc() || second.ptr != end) return expected;
  for (const uint32_t side : sides)
    if (side < 1 || side > max_side) return expected;
  width = sides[0];
  height = sides[1];
  return "";
}

Invocation read_arguments(int argc, const char* const* argv) {
  Invocation invocation;
  CLI::App app("Frame graphs that scatter light under the skin.\n", "dermis");
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("dermis {}.{}.{}", DERMIS_VERSION_MAJOR, DERMIS_VERSION_MINOR,
                                                DERMIS_VERSION_PATCH));
  app.footer("Exit codes: 0 done; 1 the input has problems; 2 bad option or value; 3 no driver, unwritable "
             "output or\n"
             "missing package; 4 a defect of the program.");
  add_text_verbs(app, invocation);
  add_plan_verbs(app, invocation);
  add_schema_verb(app, invocation);
  add_picture_verbs(app, invocation);
  add_bench_verbs(app, invocation);

  for (int i = 0; i < argc; ++i)
    invocation.session.command += (i == 0 ? "" : " ") + std::string(argv[i]);

  // Also a line that cannot be read is answered in the way it asks for.
  invocation.session.json = std::count(argv, argv + argc, std::string_view("--json")) > 0;
  invocation.message = find_misspelling(app, argc, argv);
  if (!invocation.message.empty()) return invocation;
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    const CLI::App* chosen = &app;
    while (!chosen->get_subcommands().empty())
      chosen = chosen->get_subcommands().front();
    invocation.help = chosen->help();
  } catch (const CLI::CallForVersion& version) {
    invocation.help = std::string(version.what()) + "\n";
  } catch (const CLI::ParseError& error) {
    invocation.message = error.what();
    invocation.run = nullptr;
  }
  return invocation;
}

} // namespace dermis::tools
