#include "integration/tools/command/arguments/add_verb.hpp"

#include <charconv>
#include <filesystem>
#include <map>

namespace dermis::tools {
namespace {

std::string check_size(const std::string& text) {
  uint32_t width = 0, height = 0;
  return parse_size(text, width, height);
}

std::string check_named_value(const std::string& text) {
  const size_t equals = text.find('=');
  return equals == std::string::npos || equals == 0 || equals + 1 == text.size()
             ? fmt::format("expected NAME=VALUE such as samples=16, found '{}'", text)
             : "";
}

} // namespace

CLI::Validator in_range(double minimum, double maximum) {
  const auto check = [=](const std::string& text) {
    double value = 0;
    return CLI::detail::lexical_cast(text, value) && value >= minimum && value <= maximum
               ? std::string()
               : fmt::format("Value {} not in range {} to {}", text, minimum, maximum);
  };
  return {check, fmt::format("FLOAT in [{} - {}]", minimum, maximum)};
}

CLI::Validator folder_exists() {
  const auto check = [](const std::string& path) {
    std::error_code ignored;
    return std::filesystem::is_directory(path, ignored)
               ? std::string()
               : fmt::format("there is no folder '{}'", path);
  };
  return {check, ""};
}

CLI::Option* repeat(CLI::Option* option) {
  return option->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->allow_extra_args(false);
}

CLI::Option* add_size(CLI::App& verb, Size& size, const char* name) {
  return verb
      .add_option_function<std::string>(
          name, [&size](const std::string& text) { parse_size(text, size.width, size.height); },
          fmt::format("Pixels, WIDTHxHEIGHT, each 1..{}{}", max_side,
                      size.width == 0 ? "" : fmt::format(" [{}x{}]", size.width, size.height)))
      ->check(CLI::Validator(check_size, "WxH"));
}

void add_pixel_aspect(CLI::App& verb, double& aspect, const char* what) {
  verb.add_option("--pixel-aspect", aspect, what)->check(in_range(0.125, 8.0))->type_name("RATIO");
}

void add_settings(CLI::App& verb, std::vector<NamedValue>& settings, const char* name) {
  repeat(verb.add_option_function<std::vector<std::string>>(
                 name,
                 [&settings](const std::vector<std::string>& all) {
                   for (const std::string& one : all) {
                     const size_t equals = one.find('=');
                     settings.emplace_back(one.substr(0, equals), one.substr(equals + 1));
                   }
                 },
                 "Value of a setting of the graph; may be repeated")
             ->check(CLI::Validator(check_named_value, "NAME=VALUE")));
}

void add_unbound(CLI::App& verb, std::vector<std::string>& unbound, const char* name) {
  repeat(verb.add_option(name, unbound, "Optional slots that the host does not bind")
             ->type_name("NAME")
             ->delimiter(','));
}

void add_root(CLI::App& verb, std::vector<std::string>& roots, const char* what) {
  repeat(verb.add_option("--root", roots, what)->type_name("DIR")->check(folder_exists()));
}

void add_graph_inputs(CLI::App& verb, GraphInputs& inputs) {
  repeat(verb.add_option("--overlay", inputs.overlays,
                         "Overlay to apply to the graph; may be repeated, applied in order")
             ->type_name("FILE"));
  add_root(verb, inputs.roots,
           "Additional folder that graph, scene, model or capture may read from; may be repeated");
  add_pass_types(verb, inputs.pass_types);
}

void add_pass_types(CLI::App& verb, std::vector<std::string>& pass_types) {
  repeat(
      verb.add_option("--pass-types", pass_types,
                      "File of the host's pass types (dermis_export_pass_types); may be repeated")
          ->type_name("FILE"));
}

void add_common(CLI::App& verb, Session& session, bool json_is_file) {
  static const std::map<std::string, ColorMode> modes{
      {"auto", ColorMode::automatic}, {"always", ColorMode::always}, {"never", ColorMode::never}};
  const char* group = "Common options";
  if (!json_is_file)
    verb.add_flag("--json", session.json, "Print one JSON document to standard output")
        ->group(group);
  verb.add_flag("--quiet,-q", session.quiet, "Print only errors")->group(group);
  add_choice(verb, "--color", session.color, modes, "Colour: auto, always or never [auto]")
      ->type_name("MODE")
      ->group(group);
}

CLI::App& add_group(CLI::App& app, const char* name, const char* what, const char* example) {
  CLI::App& group = *app.add_subcommand(name, what);
  group.require_subcommand(1);
  group.footer(fmt::format("Example:\n  {}", example));
  return group;
}

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

std::vector<CLI::Option*> add_budget(CLI::App& verb, BudgetArguments& budget) {
  const char* group = "The choice";
  constexpr double min_percentile = 0.5, max_percentile = 0.99;
  static const std::map<std::string, demo::Trials> trials{{"always", demo::Trials::always},
                                                          {"cuts", demo::Trials::cuts},
                                                          {"never", demo::Trials::never}};
  std::vector<CLI::Option*> of_frame{
      verb.add_option("--budget", budget.ms,
                      "Device time per frame, ms, for settings with \"by\": \"budget\"")
          ->check(in_range(0.0, max_budget_ms))
          ->type_name("MS"),
      verb.add_option("--budget-percentile", budget.percentile,
                      "Fraction of frames that stay within the budget [0.95]")
          ->check(in_range(min_percentile, max_percentile))
          ->type_name("FRACTION"),
      add_choice(verb, "--trials", budget.trials, trials,
                 "When a technique may run only to measure its time: always, in cuts, or never "
                 "[always]")
          ->type_name("WHEN"),
      verb.add_flag("--deterministic", budget.deterministic,
                    "Judge times only by the calibration, for choices that do not depend on the "
                    "machine's speed")};
  of_frame[1]->needs(of_frame[0]);
  of_frame[2]->needs(of_frame[0]);
  for (CLI::Option* option : of_frame)
    option->group(group);
  add_path(verb, "--calibration", budget.calibration, "Costs of passes (dermis calibrate)")
      ->group(group);
  add_path(verb, "--errors", budget.errors,
           "Error table to use instead of the built-in configs/choice/errors.json")
      ->group(group);
  return of_frame;
}

} // namespace dermis::tools
