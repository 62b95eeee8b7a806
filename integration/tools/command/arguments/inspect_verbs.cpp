// Verbs that need no device.
#include "integration/tools/command/arguments/add_verb.hpp"
#include "integration/tools/command/inspect/schemas.hpp"

namespace dermis::tools {
namespace {

CLI::Option* add_two_queues(CLI::App& verb, bool& two_queues) {
  return verb.add_flag("--two-queues", two_queues,
                       "Use a second queue for async passes where possible");
}

} // namespace

void add_text_verbs(CLI::App& app, Invocation& invocation) {
  add_verb<ValidateOptions>(
      app, invocation, "validate",
      "Check graphs, profiles, scenes, captures, tables and saved plans",
      "dermis validate configs/graphs/burley.json\n  dermis validate capture/ --sarif "
      "results.sarif",
      validate, [](CLI::App& verb, ValidateOptions& options) {
        add_path(verb, "files", options.files,
                 "Files to check; a folder means the captured frames in it")
            ->required();
        add_path(verb, "--profiles", options.profiles,
                 "Folder of the captures' profiles [configs/profiles]", "DIR");
        verb.add_flag("--diagnose", options.diagnose,
                      "Report usual integration mistakes in captured frames; fail if one is found");
        add_graph_inputs(verb, options.inputs);
        add_path(verb, "--sarif", options.sarif,
                 "Write the messages as SARIF 2.1.0 to this file, - for standard output");
      });
  add_verb<UpgradeOptions>(
      app, invocation, "upgrade", "Convert files to the newest version of their format",
      "dermis upgrade configs/graphs/burley.json\n  dermis upgrade --check configs/graphs/*.json",
      upgrade, [](CLI::App& verb, UpgradeOptions& options) {
        add_path(verb, "files", options.files, "Files to upgrade in place")->required();
        verb.add_flag("--check", options.check, "Write nothing; fail if a file needs an upgrade");
      });
  add_verb<ExplainOptions>(
      app, invocation, "explain", "Show the plan of a graph with the reason for each decision",
      "dermis explain configs/graphs/burley.json --size 1920x1080\n  dermis explain D0103", explain,
      [&invocation](CLI::App& verb, ExplainOptions& options) {
        const CLI::Option* graph =
            add_path(verb, "graph", options.graph, "Graph file, or the code of a message")
                ->required();
        for (const DiagnosticInfo& info : all_diagnostic_infos())
          invocation.offered[graph].emplace_back(info.code);
        add_size(verb, options.size);
        add_pixel_aspect(verb, options.pixel_aspect,
                         "Width of a pixel over its height [1, or the scene's]");
        add_settings(verb, options.settings);
        add_unbound(verb, options.unbound);
        CLI::Option* two_queues = add_two_queues(verb, options.two_queues);
        add_graph_inputs(verb, options.inputs);
        CLI::Option* frame =
            verb.add_flag("--frame", options.frame,
                          "Explain the library's choices for a frame instead of the plan")
                ->excludes(two_queues);
        add_path(verb, "--scene", options.scene, "Scene of the frame [configs/scenes/bust.json]")
            ->needs(frame);
        for (CLI::Option* option : add_budget(verb, options.budget))
          option->needs(frame);
        verb.add_flag("--choices", options.choices,
                      "List the configurations of a choice by budget with time, error and the "
                      "budgets that select each, instead of the plan")
            ->excludes(frame);
        add_path(verb, "--out,-o", options.out, "File to write, - for standard output [-]");
      });
  add_verb<GraphOptions>(
      app, invocation, "graph", "Write the graph and its plan as an HTML page, DOT or JSON",
      "dermis graph configs/graphs/skin.json --html skin.html\n"
      "  dermis graph configs/graphs/burley.json | dot -Tsvg > burley.svg",
      graph, [](CLI::App& verb, GraphOptions& options) {
        add_path(verb, "graph", options.graph, "Graph file")->required();
        verb.add_flag_callback(
                "--dot", [] {}, "Write DOT for Graphviz (default)")
            ->excludes("--json");
        CLI::Option* html =
            add_path(verb, "--html", options.html,
                     "Write a self-contained HTML page with graph, lifetimes, memory, "
                     "barriers and the plans of up to 64 combinations of choices")
                ->excludes("--json")
                ->excludes("--dot");
        add_path(verb, "--frame", options.frame,
                 "Output of render --json; adds times and tiles to the page")
            ->needs(html);
        add_size(verb, options.size);
        add_settings(verb, options.settings);
        add_unbound(verb, options.unbound);
        add_two_queues(verb, options.two_queues);
        add_graph_inputs(verb, options.inputs);
        add_path(verb, "--out,-o", options.out, "File to write, - for standard output [-]")
            ->excludes(html);
      });
  add_verb<TestOptions>(
      app, invocation, "test", "Compare graphs with the expectation files next to them",
      "dermis test configs/\n  dermis test configs/ --junit results.xml", test,
      [](CLI::App& verb, TestOptions& options) {
        add_path(verb, "paths", options.paths,
                 "Expectation files (NAME.expect.json), or folders of them", "PATH")
            ->required();
        verb.add_flag(
            "--update", options.update,
            "Write the observed results to the files; review the changes before you commit them");
        add_root(verb, options.roots,
                 "Additional folder of included files and overlays; may be repeated");
        add_pass_types(verb, options.pass_types);
        add_path(verb, "--junit", options.junit, "Write the results as JUnit XML to this file");
      });
}

void add_plan_verbs(CLI::App& app, Invocation& invocation) {
  CLI::App& plan = add_group(app, "plan", "Save, verify and compare plans",
                             "dermis plan diff configs/graphs/burley.json configs/graphs/sap.json");
  add_verb<PlanDiffOptions>(
      plan, invocation, "diff",
      "Compare two plans: of two graphs, of one graph with different options, or saved plans",
      "dermis plan diff configs/graphs/burley.json configs/graphs/sap.json\n"
      "  dermis plan diff configs/graphs/burley.json --b-size 960x540 --b-unbound albedo\n"
      "  dermis plan diff before.plan configs/graphs/burley.json --exit-code",
      plan_diff, [](CLI::App& verb, PlanDiffOptions& options) {
        add_path(
            verb, "files", options.files,
            "Two graphs or saved plans, A and B; or one graph for both, with --b-... options for B")
            ->required()
            ->expected(1, 2);
        add_graph_inputs(verb, options.inputs);
        add_size(verb, options.size);
        add_settings(verb, options.settings);
        add_unbound(verb, options.unbound);
        verb.add_flag("--exit-code", options.exit_code, "Exit with 1 if the plans differ");
        const char* group = "Options of B, added to the common options";
        add_size(verb, options.b_size, "--b-size")->group(group);
        add_settings(verb, options.b_settings, "--b-set");
        verb.get_option("--b-set")->group(group);
        add_unbound(verb, options.b_unbound, "--b-unbound");
        verb.get_option("--b-unbound")->group(group);
        repeat(add_path(verb, "--b-overlay", options.b_overlays,
                        "Overlay to apply to the graph; may be repeated"))
            ->group(group);
      });
  add_verb<PlanSaveOptions>(
      plan, invocation, "save", "Compile a graph and write its plan to a file",
      "dermis plan save configs/graphs/burley.json --size 1280x720 --out burley.plan", plan_save,
      [](CLI::App& verb, PlanSaveOptions& options) {
        add_path(verb, "graph", options.graph, "Graph file")->required();
        add_graph_inputs(verb, options.inputs);
        add_size(verb, options.size);
        add_settings(verb, options.settings);
        add_two_queues(verb, options.two_queues);
        add_unbound(verb, options.unbound);
        add_path(verb, "--out,-o", options.out, "File to write")->required();
      });
  add_verb<PlanVerifyOptions>(plan, invocation, "verify",
                              "Verify that saved plans are free of hazards, without their graphs",
                              "dermis plan verify burley.plan", plan_verify,
                              [](CLI::App& verb, PlanVerifyOptions& options) {
                                add_path(verb, "files", options.files, "Saved plans")->required();
                              });
}

void add_schema_verb(CLI::App& app, Invocation& invocation) {
  add_verb<SchemaOptions>(
      app, invocation, "schema", "Write the JSON Schemas of the file formats, for editors",
      "dermis schema graph\n  dermis schema graph --pass-types studio.json --out "
      "graph.schema.json\n"
      "  dermis schema --out build/docs/schema",
      schema, [&invocation](CLI::App& verb, SchemaOptions& options) {
        const CLI::Option* name =
            verb.add_option("name", options.name,
                            fmt::format("One of {}; without it --out is a folder for all",
                                        format_list(schema_names())))
                ->type_name("NAME");
        invocation.offered[name] = schema_names();
        add_path(verb, "--out,-o", options.out,
                 "File to write, - for standard output [-]; a folder if all are written", "PATH");
        add_pass_types(verb, options.pass_types);
      });
}

void add_docs_verb(CLI::App& app, Invocation& invocation) {
  add_verb<DocsOptions>(
      app, invocation, "docs",
      "Write the documentation generated from schemas, pass types and graphs",
      "dermis docs --out build/docs", docs, [](CLI::App& verb, DocsOptions& options) {
        add_path(verb, "--out,-o", options.out, "Folder of the pages [build/docs]", "DIR");
        add_path(verb, "--graphs", options.graphs, "Folder of graph files [configs/graphs]", "DIR")
            ->check(folder_exists());
      });
}

void add_kernels_verb(CLI::App& app, Invocation& invocation) {
  add_verb<KernelsOptions>(
      app, invocation, "kernels",
      "Show compiler statistics (registers, spills, occupancy) of graphs' kernels",
      "dermis kernels\n"
      "  dermis kernels sap --unbound scattered_light --limits limits.json\n\n"
      "Compiles the pipelines of the graphs' plans on a device and prints the driver's "
      "statistics.\n"
      "Creates no memory, no image and no command, so drivers without hardware work, too\n"
      "(RADV_FORCE_FAMILY=navi21 with Mesa's radeon driver).\n\n"
      "Plans: the default settings, all combinations of choices, and each value of other "
      "switches.\n"
      "Dispatches, barrier calls and bytes are those of the default settings.\n\n"
      "Bytes: each texel of an image and each element of a list counts once per pass and port, "
      "with\n"
      "the size of its format. Passes over a list access the covered pixels, others the whole "
      "view;\n"
      "images of second layers count with the flagged fractions. The sum is divided by the "
      "covered\n"
      "pixels. Not counted: tables, counters, indirect arguments, passes of the host, and passes\n"
      "that only run if nothing scatters.\n\n"
      "A limits file names values by device, driver and kernel; docs/tools.md describes the "
      "format.",
      kernels, [](CLI::App& verb, KernelsOptions& options) {
        verb.add_option("graphs", options.graphs, "Graph files, or names of shipped graphs [all]")
            ->type_name("GRAPH");
        add_size(verb, options.size);
        add_settings(verb, options.settings);
        add_unbound(verb, options.unbound);
        add_graph_inputs(verb, options.inputs);
        verb.add_option("--device", options.device,
                        "Part of the device's name [the first discrete GPU]")
            ->type_name("NAME");
        verb.add_flag("--small-groups", options.small_groups,
                      "Use no group of more than 128 invocations, as on devices that allow no "
                      "larger one");
        verb.add_option("--limits", options.limits,
                        "Check the values against this file; exit with 1 if a limit is exceeded")
            ->type_name("FILE");
        verb.add_option("--covered", options.assumptions.covered,
                        "Fraction of the view with subsurface [0.5]")
            ->check(in_range(0.001, 1.0))
            ->type_name("FRACTION");
        verb.add_option("--flagged", options.assumptions.flagged,
                        "Fraction of texels that have a second layer [0.5]")
            ->check(in_range(0.0, 1.0))
            ->type_name("FRACTION");
        verb.add_option("--flagged-fine", options.assumptions.flagged_fine,
                        "The same at half the view's resolution and finer [0.1]")
            ->check(in_range(0.0, 1.0))
            ->type_name("FRACTION");
        verb.add_option("--assembly", options.assembly,
                        "Write the kernels' assembly to this folder")
            ->type_name("DIR");
        verb.add_option("--shaders", options.shaders,
                        "Folder of shaders that replace the built-in ones")
            ->type_name("DIR")
            ->check(folder_exists());
      });
}

void add_doctor_verb(CLI::App& app, Invocation& invocation) {
  add_verb<DoctorOptions>(
      app, invocation, "doctor", "Check this machine against the requirements of Dermis",
      "dermis doctor\n  dermis doctor --json", doctor, [](CLI::App&, DoctorOptions&) {});
}

} // namespace dermis::tools
