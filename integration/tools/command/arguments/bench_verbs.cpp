// Verbs that measure: one per suite, and `bench all`.
#include "integration/tools/command/arguments/add_verb.hpp"
#include "integration/tools/command/bench/suite/suites.hpp"

namespace dermis::tools {
namespace {

constexpr const char* quick_help = "Smoke test with small images and few repetitions, scenes or "
                                   "techniques; figures are meaningless";

// Returns the default for the help text, or "".
std::string default_of(const OptionValue& value) {
  if (const auto* number = std::get_if<uint64_t>(&value)) return fmt::format(" [{}]", *number);
  if (const auto* text = std::get_if<std::string>(&value); text != nullptr && !text->empty())
    return fmt::format(" [{}]", *text);
  const auto* list = std::get_if<std::vector<std::string>>(&value);
  return list != nullptr && !list->empty() ? fmt::format(" [{}]", fmt::join(*list, ",")) : "";
}

CLI::Option* add_suite_option(CLI::App& verb, const SuiteOption& option, OptionValue& value) {
  const std::string name = "--" + option.name, help = option.help + default_of(option.value);
  if (auto* flag = std::get_if<bool>(&value)) return verb.add_flag(name, *flag, help);
  if (auto* size = std::get_if<Size>(&value)) return add_size(verb, *size);
  if (auto* number = std::get_if<uint64_t>(&value))
    return verb.add_option(name, *number, help)->check(CLI::Range(option.minimum, option.maximum));
  if (auto* text = std::get_if<std::string>(&value))
    return verb.add_option(name, *text, help)->type_name(option.type);
  CLI::Option* list = repeat(verb.add_option(name, std::get<std::vector<std::string>>(value), help)
                                 ->type_name(option.type));
  return option.type == "NAME" ? list->delimiter(',') : list;
}

void add_file(CLI::App& verb, const char* name, std::string& file, const char* help) {
  verb.add_option(name, file, help)->type_name("FILE");
}

void add_suite(CLI::App& bench, Invocation& invocation, const Suite& suite) {
  const std::string example =
      fmt::format("dermis bench {0} --json build/{0}.json --html build/{0}.html", suite.name);
  add_verb<SuiteRequest>(
      bench, invocation, suite.name, suite.what, example,
      [suite](const Session& session, const SuiteRequest& request) {
        return run_suite(session, suite, request);
      },
      [&suite](CLI::App& verb, SuiteRequest& request) {
        request = default_request(suite);
        CLI::Option* quick = verb.add_flag("--quick", request.quick, quick_help);
        for (const SuiteOption& option : suite.options) {
          CLI::Option* added = add_suite_option(verb, option, request.options.at(option.name));
          if (option.quick) quick->excludes(added);
        }
        for (const SuiteOption& option : suite.options)
          if (!option.excludes.empty())
            verb.get_option("--" + option.name)->excludes("--" + option.excludes);
        add_file(verb, "--json", request.json,
                 "Write the rows as JSON to this file, - for standard output");
        add_file(verb, "--csv", request.csv,
                 "Write the rows as CSV to this file, - for standard output");
        add_file(verb, "--html", request.html,
                 "Write a page with the rows, plots and images to this file");
      },
      true);
}

} // namespace

void add_bench_verbs(CLI::App& app, Invocation& invocation) {
  CLI::App& bench = add_group(app, "bench", "Measure the library on this machine",
                              "dermis bench record --html bench_record.html");
  for (const Suite& suite : bench_suites())
    add_suite(bench, invocation, suite);
  add_verb<BenchAllOptions>(
      bench, invocation, "all",
      "Run every suite and write pages with an index; continues an interrupted run",
      "dermis bench all --out build/bench", bench_all,
      [&invocation](CLI::App& verb, BenchAllOptions& options) {
        verb.add_option("--out,-o", options.out, "Folder for pages and rows")
            ->required()
            ->type_name("DIR");
        const CLI::Option* suites =
            repeat(verb.add_option("--suites", options.suites,
                                   fmt::format("Only these, separated by commas: {}",
                                               format_list(bench_suite_names())))
                       ->type_name("NAME")
                       ->delimiter(','));
        invocation.offered[suites] = bench_suite_names();
        verb.add_option("--head", options.head,
                        "Folder of the head scan, for suites that support it")
            ->type_name("DIR");
        verb.add_flag("--again", options.again,
                      "Repeat suites that an earlier run into this folder measured");
        verb.add_flag("--quick", options.quick, quick_help);
        verb.add_option("--cache", options.cache, "Folder of cached references [build/bench_truth]")
            ->type_name("DIR");
      });
}

} // namespace dermis::tools
