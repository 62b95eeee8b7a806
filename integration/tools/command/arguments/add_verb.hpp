#pragma once
// Options common to several verbs, and the registration of a verb. Internal to arguments/.

#include "integration/tools/command/arguments/arguments.hpp"
#include "integration/tools/command/verbs.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dermis::tools {

inline constexpr uint32_t max_side = 16384; // pixels; limit of dermis_graph_desc in dermis.h
inline constexpr uint32_t max_frames = 100000;

// Allows repetition with one value each time, so that a positional may follow.
CLI::Option* repeat(CLI::Option* option);

// Accepts finite numbers of a range. CLI::Range accepts nan.
inline constexpr double max_budget_ms = 1e6;
CLI::Validator in_range(double minimum, double maximum);
// Accepts folders that exist.
CLI::Validator folder_exists();

// Adds an option whose value is the path of a file or, by `type`, of a folder.
template <class Value>
CLI::Option* add_path(CLI::App& verb, const char* name, Value& value, const char* what,
                      const char* type = "FILE") {
  return verb.add_option(name, value, what)->type_name(type);
}

// Adds --frames,-n.
inline CLI::Option* add_frames(CLI::App& verb, uint32_t& frames, const char* what,
                               uint32_t minimum = 1) {
  return verb.add_option("--frames,-n", frames, what)->check(CLI::Range(minimum, max_frames));
}

CLI::Option* add_size(CLI::App& verb, Size& size, const char* name = "--size");
void add_pixel_aspect(CLI::App& verb, double& aspect, const char* what);
void add_settings(CLI::App& verb, std::vector<NamedValue>& settings, const char* name = "--set");
void add_unbound(CLI::App& verb, std::vector<std::string>& unbound, const char* name = "--unbound");
void add_root(CLI::App& verb, std::vector<std::string>& roots, const char* what);
void add_graph_inputs(CLI::App& verb, GraphInputs& inputs);
// Adds the options of the choice by budget. Returns those that only a frame uses.
std::vector<CLI::Option*> add_budget(CLI::App& verb, BudgetArguments& budget);
// Adds only --pass-types, for verbs without other graph inputs; add_graph_inputs() includes it.
void add_pass_types(CLI::App& verb, std::vector<std::string>& pass_types);
void add_common(CLI::App& verb, Session& session, bool json_is_file);

// Adds an option whose value is one of `names`.
template <class Value>
CLI::Option* add_choice(CLI::App& verb, const char* option, Value& value,
                        const std::map<std::string, Value>& names, const char* what) {
  return verb
      .add_option_function<std::string>(
          option, [&value, names](const std::string& name) { value = names.at(name); }, what)
      ->check(CLI::IsMember(names));
}

// Adds a verb that has subcommands.
CLI::App& add_group(CLI::App& app, const char* name, const char* what, const char* example);

// The callback owns the verb's options and runs work(session, options).
template <class Options, class Work, class Declare>
void add_verb(CLI::App& app, Invocation& invocation, const std::string& name,
              const std::string& what, const std::string& example, Work work, Declare declare,
              bool json_is_file = false) {
  CLI::App& verb = *app.add_subcommand(name, what);
  verb.footer(fmt::format("Example:\n  {}", example));
  auto options = std::make_shared<Options>();
  add_common(verb, invocation.session, json_is_file);
  declare(verb, *options);
  verb.callback([&invocation, options, work] {
    invocation.run = [options, work](const Session& session) { return work(session, *options); };
  });
}

// Each function adds one group of verbs.
void add_text_verbs(CLI::App& app, Invocation& invocation);
void add_plan_verbs(CLI::App& app, Invocation& invocation);
void add_schema_verb(CLI::App& app, Invocation& invocation);
void add_docs_verb(CLI::App& app, Invocation& invocation);
void add_kernels_verb(CLI::App& app, Invocation& invocation);
void add_doctor_verb(CLI::App& app, Invocation& invocation);
void add_picture_verbs(CLI::App& app, Invocation& invocation);
void add_bench_verbs(CLI::App& app, Invocation& invocation);
void add_shell_verbs(CLI::App& app, Invocation& invocation);

} // namespace dermis::tools
