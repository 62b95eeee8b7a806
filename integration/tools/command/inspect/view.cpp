#include "integration/tools/command/inspect/view.hpp"

#include "framegraph/explain/plan_json.hpp"
#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/reader.hpp"
#include "integration/tools/command/bench/report/html.hpp"
#include "integration/tools/files/zlib.hpp"
#include "integration/tools/viewer/viewer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace dermis::tools {
namespace {

// Returns the values that the page offers for a setting, or an empty list.
std::vector<std::string> values_of(const SettingDeclaration& setting) {
  if (setting.type == SettingType::boolean) return {"false", "true"};
  return setting.options;
}

std::string value_text(const SettingDeclaration& setting, const SettingValue& value) {
  const std::vector<std::string> names = values_of(setting);
  if (!names.empty()) return names[static_cast<size_t>(value.integer)];
  return setting.type == SettingType::real ? fmt::format("{}", value.real)
                                           : fmt::format("{}", value.integer);
}

std::vector<uint32_t> switched_settings(const Graph& graph) {
  std::vector<uint32_t> switched;
  size_t configurations = 1;
  for (const bool by_budget : {true, false})
    for (uint32_t i = 0; i < graph.settings.size(); ++i) {
      const size_t values = values_of(graph.settings[i]).size();
      if (graph.settings[i].by_budget != by_budget || values < 2 ||
          configurations * values > max_view_configurations)
        continue;
      configurations *= values;
      switched.push_back(i);
    }
  return switched;
}

// Stores plans as runs of lines of one table, since plans of one graph share most lines.
class LineTable {
public:
  void add(JsonWriter& out, std::string_view text) {
    out.open_array(true);
    uint32_t first = 0, count = 0;
    while (!text.empty()) {
      const size_t end = std::min(text.find('\n'), text.size());
      const auto [at, is_new] =
          numbers_.try_emplace(std::string(text.substr(0, end)), numbers_.size());
      if (is_new) lines_.push_back(&at->first);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (count > 0 && at->second == first + count) {
        ++count;
        continue;
      }
      if (count > 0) out.value(first).value(count);
      first = static_cast<uint32_t>(at->second);
      count = 1;
    }
    if (count > 0) out.value(first).value(count);
    out.close();
  }
  void write(JsonWriter& out) const {
    out.open_array();
    for (const std::string* line : lines_)
      out.value(std::string_view(*line));
    out.close();
  }

private:
  std::map<std::string, size_t> numbers_;
  std::vector<const std::string*> lines_;
};

// Writes `id` and its children in the writer's layout, without comments.
void copy_json(JsonWriter& out, const Document& document, NodeId id) {
  const Node& node = document[id];
  switch (node.kind) {
  case NodeKind::null:
    out.null();
    return;
  case NodeKind::boolean:
    out.value(node.integer != 0);
    return;
  case NodeKind::integer:
    out.value(node.integer);
    return;
  case NodeKind::real:
    out.value(node.real);
    return;
  case NodeKind::string:
    out.value(document.text(id));
    return;
  case NodeKind::array:
  case NodeKind::object:
    break;
  }
  const bool object = node.kind == NodeKind::object;
  object ? out.open_object(true) : out.open_array(true);
  for (NodeId child = node.first_child; child.valid(); child = document[child].next) {
    if (object) out.key(document.key(child));
    copy_json(out, document, child);
  }
  out.close();
}

// Returns whether the report has the passes and times that the page shows.
bool check_report(const Document& report, Diagnostics& diagnostics) {
  const NodeId passes = report.find(report.root(), "passes");
  bool whole = passes.valid() && report[passes].kind == NodeKind::array;
  if (whole)
    for (NodeId pass = report[passes].first_child; pass.valid() && whole;
         pass = report[pass].next) {
      const NodeId name = report.find(pass, "pass"), time = report.find(pass, "milliseconds");
      whole = name.valid() && report[name].kind == NodeKind::string && time.valid() &&
              (report[time].kind == NodeKind::real || report[time].kind == NodeKind::integer);
    }
  if (!whole)
    diagnostics.add(DiagnosticId::wrong_type, report.where(passes.valid() ? passes : report.root()),
                    "expected the output of 'dermis render --json': \"passes\", each with \"pass\" "
                    "and \"milliseconds\"");
  return whole;
}

// Returns " ('FILE')", the graph's file as the report names it, or "".
std::string graph_of(const Document& report) {
  const NodeId graph = report.find(report.root(), "graph");
  return graph.valid() && report[graph].kind == NodeKind::string
             ? fmt::format(" ('{}')", report.text(graph))
             : "";
}

// Returns whether the graph has all passes of the report.
bool has_passes(const Graph& graph, const Document& report, Diagnostics& diagnostics) {
  for (const NodeId pass : children(report, report.find(report.root(), "passes"))) {
    const NodeId name = report.find(pass, "pass");
    if (std::ranges::find(graph.passes, report.text(name), &PassDeclaration::name) !=
        graph.passes.end())
      continue;
    diagnostics.add(DiagnosticId::unknown_pass, report.where(name),
                    fmt::format("the report is of another graph{}: '{}' has no pass '{}'",
                                graph_of(report), graph.name, report.text(name)));
    return false;
  }
  return true;
}

// Names the size of the report if the page shows plans of another size.
std::string other_size(const Document& report, const ViewOptions& options) {
  const NodeId width = report.find(report.root(), "width"),
               height = report.find(report.root(), "height");
  if (!width.valid() || !height.valid() ||
      (report[width].integer == options.size.width &&
       report[height].integer == options.size.height))
    return "";
  return fmt::format("{}: the report is of {}x{} pixels, the page shows plans for {}x{}; "
                     "--size {}x{} shows those of the report",
                     options.frame, report[width].integer, report[height].integer,
                     options.size.width, options.size.height, report[width].integer,
                     report[height].integer);
}

struct View {
  const LoadedGraph& loaded;
  const ViewOptions& options;
  Diagnostics& diagnostics;
  std::vector<uint32_t> switched;
  JsonWriter out = {};

  // Writes the location of a declaration, for the page's list of files.
  void write_location(const SourceLocation& where) {
    out.key("file");
    where.file.valid() ? out.value(where.file.value) : out.null();
    out.member("line", where.line);
  }

  void write_declarations() {
    const Graph& graph = loaded.graph;
    out.key("files").open_array();
    for (const SourceFile& file : diagnostics.files)
      out.open_object(true).member("name", file.name).member("text", file.text).close();
    out.close().key("passes").open_array();
    for (const PassDeclaration& pass : graph.passes) {
      out.open_object(true)
          .member("name", pass.name)
          .member("kind", loaded.pass_types[pass.type].name);
      write_location(pass.where);
      out.member("note", pass.note).close();
    }
    out.close().key("resources").open_array();
    for (const ResourceDeclaration& resource : graph.resources) {
      out.open_object(true).member("name", resource.name);
      write_location(resource.where);
      out.member("note", resource.note).close();
    }
    out.close().key("settings").open_array();
    for (uint32_t i = 0; i < graph.settings.size(); ++i) {
      const SettingDeclaration& setting = graph.settings[i];
      const auto at = std::find(switched.begin(), switched.end(), i);
      out.open_object(true).member("name", setting.name).member("by_budget", setting.by_budget);
      out.member("note", setting.note)
          .member("value", value_text(setting, options.chosen.settings[i]));
      out.key("switched");
      at == switched.end() ? out.null() : out.value(static_cast<uint32_t>(at - switched.begin()));
      out.key("values").open_array(true);
      for (const std::string& value : values_of(setting))
        out.value(value);
      out.close().close();
    }
    out.close();
  }

  // Advances to the next combination, with the last setting fastest. Returns false after the last
  // combination.
  bool next(CompileChoices& choices) const {
    for (size_t i = switched.size(); i-- > 0;) {
      SettingValue& value = choices.settings[switched[i]];
      const auto values =
          static_cast<int64_t>(values_of(loaded.graph.settings[switched[i]]).size());
      value.integer = (value.integer + 1) % values;
      if (value.integer != options.chosen.settings[switched[i]].integer) return true;
    }
    return false;
  }

  // Writes all configurations, the chosen one first. Returns false with errors if the chosen one
  // has no plan.
  bool plans() {
    LineTable lines;
    JsonWriter runs, list;
    runs.open_array();
    list.open_array();
    CompileChoices choices = options.chosen;
    uint32_t count = 0;
    do {
      Diagnostics found; // of this configuration; errors of the first are errors of the page
      const auto compiled =
          compile_generic(loaded, options.size, choices, count == 0 ? diagnostics : found);
      if (!compiled && list_is_empty_) return false;
      list_is_empty_ = false;
      list.open_object(true).key("values").open_array(true);
      for (const uint32_t setting : switched)
        list.value(choices.settings[setting].integer);
      list.close().key("plan");
      if (compiled) {
        list.value(count++);
        lines.add(runs, plan_json(loaded.graph, loaded.pass_types, *compiled,
                                  {loaded.changes, diagnostics.files}));
      } else {
        list.null().member("problem", found.list.empty() ? "" : found.list.front().text);
      }
      list.close();
    } while (next(choices));
    runs.close();
    list.close();
    lines.write(out.key("lines"));
    out.key("plans")
        .json(std::move(runs).finish())
        .key("configurations")
        .json(std::move(list).finish());
    return true;
  }

  bool list_is_empty_ = true;
};

} // namespace

ViewAnswer make_view(const LoadedGraph& loaded, const ViewOptions& options,
                     Diagnostics& diagnostics) {
  const ViewerPage page = viewer_page();
  if (!page.missing.empty())
    return {"", fmt::format(
                    "this program has no viewer: {}; configure and build it again with nodejs, npm "
                    "and a network, or use --dot",
                    page.missing)};

  std::optional<Document> report;
  const size_t files = diagnostics.files.size(); // the report is not a file of the graph
  if (!options.frame.empty()) {
    report = read_document(options.frame, diagnostics);
    if (!report || !check_report(*report, diagnostics) ||
        !has_passes(loaded.graph, *report, diagnostics))
      return {"", "", options.frame};
  }
  const std::vector<SourceFile> all = diagnostics.files;
  diagnostics.files.resize(files);
  View view{loaded, options, diagnostics, switched_settings(loaded.graph)};
  view.out.open_object().member("dermis_view", 1).member("graph", loaded.graph.name);
  view.out.member("command", options.command);
  view.write_declarations();
  const bool compiled = view.plans();
  diagnostics.files = all;
  if (!compiled) return {};
  view.out.key("frame");
  report ? copy_json(view.out, *report, report->root()) : void(view.out.null());
  view.out.close();

  const std::string text = std::move(view.out).finish();
  const std::vector<uint8_t> packed =
      zlib_deflate({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  if (packed.empty()) return {"", "out of memory"};
  ViewAnswer answer;
  if (report) answer.warning = other_size(*report, options);
  for (const std::string_view piece : page.before)
    answer.page += piece;
  answer.page += base64(packed);
  for (const std::string_view piece : page.after)
    answer.page += piece;
  return answer;
}

} // namespace dermis::tools
