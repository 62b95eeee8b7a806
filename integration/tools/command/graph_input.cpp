#include "integration/tools/command/graph_input.hpp"

#include "framegraph/model/read_graph.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/reader.hpp"
#include "framegraph/text/suggest.hpp"
#include "integration/tools/command/shipped.hpp"
#include "integration/tools/files/roots.hpp"
#include "passes/common/pass_types.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdio>

namespace dermis::tools {
namespace {

// Reads at most one byte more than a file may hold, so that the parser reports a file that is too
// large.
std::string read_standard_input() {
  std::string text;
  char block[65536];
  for (size_t got = 1; got > 0 && text.size() <= limits::file_bytes;) {
    got = std::fread(block, 1, sizeof block, stdin);
    text.append(block, got);
  }
  return text;
}

// Returns the text of standard input, which can be read only once but may be parsed again.
const std::string& standard_input() {
  static const std::string text = read_standard_input();
  return text;
}

std::string_view without_quotes(std::string_view text) {
  return text.size() >= 2 && text.front() == '"' && text.back() == '"'
             ? text.substr(1, text.size() - 2)
             : text;
}

template <class Number> bool parse_number(std::string_view text, Number& value) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

// Parses `text` as a value of `setting`. Returns the problem, or "" after setting `value`.
std::string parse_setting(const SettingDeclaration& setting, std::string_view text,
                          SettingValue& value) {
  const auto out_of_range = [&] {
    return fmt::format("setting '{}': {} is outside {} .. {}", setting.name, text, setting.minimum,
                       setting.maximum);
  };
  value.type = setting.type;
  switch (setting.type) {
  case SettingType::boolean:
    if (text != "true" && text != "false")
      return fmt::format("setting '{}': expected true or false, found '{}'", setting.name, text);
    value.integer = text == "true" ? 1 : 0;
    return "";
  case SettingType::integer:
    if (!parse_number(text, value.integer))
      return fmt::format("setting '{}': expected an integer, found '{}'", setting.name, text);
    return static_cast<double>(value.integer) < setting.minimum ||
                   static_cast<double>(value.integer) > setting.maximum
               ? out_of_range()
               : "";
  case SettingType::real:
    if (!parse_number(text, value.real))
      return fmt::format("setting '{}': expected a number, found '{}'", setting.name, text);
    return !(value.real >= setting.minimum && value.real <= setting.maximum) ? out_of_range() : "";
  case SettingType::enumeration:
  case SettingType::choice:
    break;
  }
  const std::string_view word = without_quotes(text);
  for (size_t i = 0; i < setting.options.size(); ++i) {
    if (setting.options[i] != word) continue;
    value.integer = static_cast<int64_t>(i);
    return "";
  }
  const std::vector<std::string_view> words(setting.options.begin(), setting.options.end());
  return fmt::format("setting '{}': expected {}, found '{}'", setting.name, list_words(words),
                     word);
}

template <class Declarations> int find_by_name(const Declarations& all, std::string_view name) {
  for (size_t i = 0; i < all.size(); ++i)
    if (all[i].name == name) return static_cast<int>(i);
  return -1;
}

template <class Declarations>
std::string unknown(std::string_view what, std::string_view name, const Declarations& all) {
  std::vector<std::string_view> names;
  for (const auto& one : all)
    names.push_back(one.name);
  const std::string suggestion = did_you_mean(name, names);
  if (names.empty()) return fmt::format("the graph has no {}", what);
  return fmt::format("the graph has no {} '{}'; {}", what, name,
                     suggestion.empty() ? "it has " + list_words(names) : suggestion);
}

std::optional<LoadedGraph> read_composed(std::optional<Composition> composed,
                                         std::span<const std::string> pass_type_files,
                                         Diagnostics& diagnostics) {
  if (!composed) return std::nullopt;
  std::optional<LoadedGraph> known = load_pass_types(pass_type_files, diagnostics);
  if (!known) return std::nullopt;
  LoadedGraph& loaded = *known;
  loaded.changes = std::move(composed->changes);
  const size_t reported = diagnostics.list.size();
  std::optional<Graph> graph = read_graph(composed->document, loaded.pass_types, diagnostics);
  relate_to_removals(loaded.changes, reported, diagnostics);
  if (!graph) return std::nullopt;
  loaded.graph = std::move(*graph);
  return known;
}

// Returns the place of the name of a pass type in a file of pass types.
SourceLocation where_declared(const Document& document, std::string_view pass_type) {
  if (const NodeId list = document.find(document.root(), "pass_types"); list.valid())
    for (const NodeId node : children(document, list))
      if (const NodeId name = document.find(node, "name");
          name.valid() && document.text(name) == pass_type)
        return document.where(name);
  return document.where(document.root());
}

} // namespace

std::optional<LoadedGraph> load_pass_types(std::span<const std::string> files,
                                           Diagnostics& diagnostics) {
  LoadedGraph loaded{subsurface::make_pass_types(), nullptr, {}, {}, {}, {}};
  const auto host = std::make_shared<HostPassTypes>();
  const uint64_t errors = diagnostics.errors();
  for (const std::string& file : files) {
    const std::optional<Document> document = read_document(file, diagnostics);
    auto pass_types = document ? read_host_pass_types(*document, diagnostics) : std::nullopt;
    if (!pass_types) continue;
    for (HostPassTypeDeclaration& type : *pass_types) {
      const std::string name = type.name;
      if (!host->add(std::move(type), loaded.pass_types).valid())
        diagnostics.add(DiagnosticId::duplicate_name, where_declared(*document, name),
                        fmt::format("there is a pass type '{}' already", name));
    }
  }
  loaded.host_pass_types = host;
  return diagnostics.errors() == errors ? std::optional(std::move(loaded)) : std::nullopt;
}

std::optional<Document> read_input(const std::string& path, Diagnostics& diagnostics) {
  return path == "-" ? parse_document("<stdin>", standard_input(), diagnostics)
                     : read_document(path, diagnostics);
}

OpenFile open_included(const std::string& path, const std::vector<std::string>& roots) {
  std::vector<std::filesystem::path> folders(roots.begin(), roots.end());
  if (path != "-") folders.insert(folders.begin(), std::filesystem::path(path).parent_path());
  return open_below(std::move(folders));
}

std::function<std::optional<demo::NamedText>(const std::string& name)> for_engine(OpenFile open) {
  return [open = std::move(open)](const std::string& name) -> std::optional<demo::NamedText> {
    const FileText file = open(name);
    return file.problem.empty() ? std::optional(demo::NamedText{file.name, file.text})
                                : std::nullopt;
  };
}

std::optional<std::vector<Document>> read_overlays(const std::vector<std::string>& paths,
                                                   Diagnostics& diagnostics) {
  std::vector<Document> read;
  for (const std::string& path : paths)
    if (auto one = read_document(path, diagnostics)) read.push_back(std::move(*one));
  return read.size() == paths.size() ? std::optional(std::move(read)) : std::nullopt;
}

std::optional<Document> read_graph_file(const std::string& path, Diagnostics& diagnostics) {
  std::optional<Document> document = read_input(path, diagnostics);
  std::error_code error;
  if (!document && path != "-" && !std::filesystem::exists(path, error))
    for (Diagnostic& one : diagnostics.list)
      if (one.id == DiagnosticId::file_unreadable) one.suggestion = did_you_mean_graph(path);
  return document;
}

std::optional<LoadedGraph> load_graph(const std::string& path, const GraphInputs& inputs,
                                      Diagnostics& diagnostics) {
  std::optional<Document> document = read_graph_file(path, diagnostics);
  auto overlays = read_overlays(inputs.overlays, diagnostics);
  if (!document || !overlays) return std::nullopt;
  return load_graph(std::move(*document), std::move(*overlays), open_included(path, inputs.roots),
                    diagnostics, inputs.pass_types);
}

std::optional<LoadedGraph> load_graph(Document document, std::vector<Document> overlays,
                                      const OpenFile& open, Diagnostics& diagnostics,
                                      std::span<const std::string> pass_type_files) {
  const std::string text = diagnostics.files[document.file.value].text;
  std::vector<demo::NamedText> texts;
  for (const Document& overlay : overlays) {
    const SourceFile& file = diagnostics.files[overlay.file.value];
    texts.push_back({file.name, file.text});
  }
  auto loaded = read_composed(compose(std::move(document), std::move(overlays), open, diagnostics),
                              pass_type_files, diagnostics);
  if (!loaded) return std::nullopt;
  loaded->text = text;
  loaded->overlays = std::move(texts);
  return loaded;
}

std::optional<LoadedGraph> load_fragment(Document document, const OpenFile& open,
                                         Diagnostics& diagnostics,
                                         std::span<const std::string> pass_type_files) {
  return read_composed(compose_fragment(std::move(document), open, diagnostics), pass_type_files,
                       diagnostics);
}

CompileChoices read_choices(const Graph& graph, std::span<const NamedValue> settings,
                            std::span<const std::string> unbound) {
  CompileChoices choices;
  for (const SettingDeclaration& setting : graph.settings)
    choices.settings.push_back(setting.default_value);
  for (const auto& [name, text] : settings) {
    const int index = find_by_name(graph.settings, name);
    choices.problem = index < 0 ? unknown("setting", name, graph.settings)
                                : parse_setting(graph.settings[static_cast<size_t>(index)], text,
                                                choices.settings[static_cast<size_t>(index)]);
    if (!choices.problem.empty()) return choices;
  }
  choices.bound.assign(graph.resources.size(), true);
  for (const std::string& name : unbound) {
    const int index = find_by_name(graph.resources, name);
    if (index < 0) {
      choices.problem = unknown("resource", name, graph.resources);
      return choices;
    }
    if (!graph.resources[static_cast<size_t>(index)].optional) {
      choices.problem = fmt::format("'{}' is not optional: it cannot be left unbound", name);
      return choices;
    }
    choices.bound[static_cast<size_t>(index)] = false;
  }
  return choices;
}

std::vector<NamedValue> settings_as_json(const Graph& graph, std::span<const NamedValue> settings) {
  std::vector<NamedValue> all;
  for (const auto& [name, text] : settings) {
    const int index = find_by_name(graph.settings, name);
    SettingValue value;
    std::string json = text;
    if (index >= 0 &&
        parse_setting(graph.settings[static_cast<size_t>(index)], text, value).empty())
      json = value.type == SettingType::integer   ? fmt::to_string(value.integer)
             : value.type == SettingType::real    ? fmt::to_string(value.real)
             : value.type == SettingType::boolean ? text
                                                  : fmt::format("\"{}\"", without_quotes(text));
    all.emplace_back(name, std::move(json));
  }
  return all;
}

CompileInput compile_input(const LoadedGraph& loaded, const DeviceProfile& device, const Size& size,
                           const CompileChoices& choices) {
  CompileInput input;
  input.graph = &loaded.graph;
  input.pass_types = &loaded.pass_types;
  input.device = &device;
  input.view_width = size.width;
  input.view_height = size.height;
  input.pixel_grid = choices.pixel_grid;
  input.settings = choices.settings;
  input.bound = choices.bound;
  input.single_queue = !choices.two_queues;
  return input;
}

std::optional<CompiledPlan> compile_loaded(const LoadedGraph& loaded, const CompileInput& input,
                                           Diagnostics& diagnostics) {
  const size_t reported = diagnostics.list.size();
  auto compiled = compile(input, diagnostics);
  relate_to_removals(loaded.changes, reported, diagnostics);
  return compiled;
}

std::optional<CompiledPlan> compile_generic(const LoadedGraph& loaded, const Size& size,
                                            const CompileChoices& choices,
                                            Diagnostics& diagnostics) {
  const DeviceProfile device = generic_profile();
  return compile_loaded(loaded, compile_input(loaded, device, size, choices), diagnostics);
}

ExitCode fail_graph(const Session& session, const std::string& path,
                    const Diagnostics& diagnostics) {
  const uint64_t errors = diagnostics.errors();
  return fail(
      session, ExitCode::problems,
      fmt::format("{}: {} error{}; it cannot be used", path, errors, errors == 1 ? "" : "s"),
      &diagnostics);
}

} // namespace dermis::tools
