#include "integration/tools/command/kernels/report.hpp"

#include "framegraph/text/json_writer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dermis::tools {
namespace {

std::string value_cell(const std::optional<double>& value) {
  return value ? fmt::format("{:g}", *value) : "-";
}

// Prints small numbers exactly and large ones without an exponent.
std::string bytes_cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.0f}", *value) : "-";
}

std::string pair_cell(const KernelRow& row, KernelValue first, KernelValue second) {
  if (!row.value(first) && !row.value(second)) return "-";
  return value_cell(row.value(first)) + "/" + value_cell(row.value(second));
}

Table kernel_table(const KernelSurvey& survey) {
  Table table;
  table.columns = {{"kernel"}};
  for (const char* title : {"VGPR/SGPR", "spilled", "scratch B", "shared B", "occupancy",
                            "subgroup", "code B", "instructions"})
    table.columns.push_back({title, true});
  table.columns.push_back({"graphs"});
  table.columns.push_back({"constants"});
  for (const KernelRow& row : survey.kernels) {
    const std::string name = row.program.empty() ? row.kernel : row.kernel + " " + row.program;
    table.rows.push_back(
        {name, pair_cell(row, KernelValue::vgprs, KernelValue::sgprs),
         pair_cell(row, KernelValue::spilled_vgprs, KernelValue::spilled_sgprs),
         bytes_cell(row.value(KernelValue::scratch_bytes)),
         bytes_cell(row.value(KernelValue::shared_bytes)),
         value_cell(row.value(KernelValue::occupancy)),
         value_cell(row.value(KernelValue::subgroup_size)),
         bytes_cell(row.value(KernelValue::code_bytes)),
         bytes_cell(row.value(KernelValue::instructions)),
         row.graphs.size() > 1 ? format_count(row.graphs.size(), "graph") : row.graphs.front(),
         row.constants});
  }
  return table;
}

Table graph_table(const KernelSurvey& survey) {
  Table table;
  table.columns = {{"graph"}};
  for (const char* title : {"configurations", "pipelines", "dispatches", "barrier calls", "B read",
                            "B written", "B/pixel"})
    table.columns.push_back({title, true});
  for (const GraphCounts& graph : survey.graphs)
    table.rows.push_back({graph.graph, std::to_string(graph.configurations),
                          std::to_string(graph.pipelines), std::to_string(graph.dispatches),
                          std::to_string(graph.barriers), fmt::format("{:.1f}", graph.read_bytes),
                          fmt::format("{:.1f}", graph.written_bytes),
                          fmt::format("{:.1f}", graph.read_bytes + graph.written_bytes)});
  return table;
}

std::string place_of_limit(const Limit& limit, const Diagnostics& files) {
  return fmt::format("{}:{}", files.files[limit.where.file.value].name, limit.where.line);
}

void write_kernels(const KernelSurvey& survey, JsonWriter& json) {
  json.key("kernels").open_array();
  for (const KernelRow& row : survey.kernels) {
    json.open_object().member("kernel", row.kernel);
    if (!row.constants.empty()) json.member("constants", row.constants);
    if (!row.program.empty()) json.member("program", row.program);
    if (!row.assembly_file.empty()) json.member("assembly", row.assembly_file);
    json.key("graphs").open_array(true);
    for (const std::string& graph : row.graphs)
      json.value(graph);
    json.close().key("values").open_object(true);
    for (size_t v = 0; v < kernel_value_count; ++v)
      if (row.values[v]) json.member(kernel_values()[v].key, *row.values[v]);
    json.close().key("statistics").open_object(true);
    for (const vulkan::PipelineStatistic& statistic : row.statistics)
      json.member(statistic.name, statistic.value);
    json.close().close();
  }
  json.close();
}

void write_graphs(const KernelSurvey& survey, JsonWriter& json) {
  json.key("graphs").open_array();
  for (const GraphCounts& graph : survey.graphs) {
    json.open_object().member("graph", graph.graph).member("configurations", graph.configurations);
    json.member("pipelines", graph.pipelines).member("dispatches", graph.dispatches);
    json.member("barriers", graph.barriers)
        .member("bytes_per_pixel", graph.read_bytes + graph.written_bytes);
    json.member("read_bytes_per_pixel", graph.read_bytes);
    json.member("written_bytes_per_pixel", graph.written_bytes).key("passes").open_array();
    for (const PassCounts& pass : graph.passes) {
      json.open_object(true).member("pass", pass.pass).member("kernel", pass.kernel);
      if (!pass.constants.empty()) json.member("constants", pass.constants);
      json.member("read", pass.traffic.read).member("written", pass.traffic.written).close();
    }
    json.close().close();
  }
  json.close();
}

std::string_view name_of(choice::PassLoad::Groups groups) {
  using Groups = choice::PassLoad::Groups;
  switch (groups) {
  case Groups::rectangle:
    return "rectangle";
  case Groups::listed_tiles:
    return "listed_tiles";
  case Groups::copied_tiles:
    return "copied_tiles";
  case Groups::sample_units:
    return "sample_units";
  case Groups::selected_tiles:
    return "selected_tiles";
  case Groups::fixed:
    break;
  }
  return "fixed";
}

void write_works(const KernelSurvey& survey, JsonWriter& json) {
  json.key("works").open_array();
  for (const WorkRow& row : survey.works) {
    json.open_object(true).member("work", row.work).member("kernel", row.kernel);
    json.member("per", name_of(row.load.groups));
    if (row.groups > 0) json.member("groups", row.groups);
    if (row.load.level >= 0) json.member("level", static_cast<int64_t>(row.load.level));
    json.member("read", row.traffic.read).member("written", row.traffic.written).close();
  }
  json.close();
}

void write_findings(std::string_view key, const std::vector<LimitFinding>& findings,
                    const Diagnostics& files, JsonWriter& json) {
  json.key(key).open_array();
  for (const LimitFinding& finding : findings) {
    json.open_object(true).member("subject", finding.subject).member("value", finding.key);
    json.key("found");
    if (finding.value)
      json.value(*finding.value);
    else
      json.null();
    json.member("limit", finding.limit.now).member("goal", finding.limit.goal);
    json.member("minimum", finding.limit.minimum)
        .member("place", place_of_limit(finding.limit, files))
        .close();
  }
  json.close();
}

} // namespace

std::string kernels_as_text(const KernelSurvey& survey, const KernelsOptions& options) {
  std::string text =
      fmt::format("{}, {}\n\n{}", survey.device, survey.driver, format_table(kernel_table(survey)));
  if (!survey.statistics)
    text += "The driver has no VK_KHR_pipeline_executable_properties: values of kernels are not "
            "known.\n";
  text += fmt::format(
      "\nper frame at {}x{}; bytes per covered pixel, with {:g} of the view covered and {:g} "
      "of the texels flagged ({:g} at half the view's resolution)\n\n{}",
      options.size.width, options.size.height, options.assumptions.covered,
      options.assumptions.flagged, options.assumptions.flagged_fine,
      format_table(graph_table(survey)));
  for (const SkippedGraph& skipped : survey.skipped)
    text += fmt::format("{}: skipped, {}\n", skipped.graph, skipped.why);
  return text;
}

std::string findings_as_text(const std::vector<LimitFinding>& findings, const Diagnostics& files) {
  std::string text;
  for (const LimitFinding& finding : findings)
    text += fmt::format("{}  {}  ({})", text.empty() ? "" : "\n", finding.text(),
                        place_of_limit(finding.limit, files));
  return text;
}

std::string limits_as_text(const LimitsCheck& check, const Diagnostics& files) {
  std::string text =
      fmt::format("\n{} checked: {} exceeded, {} not yet at their goal\n",
                  format_count(check.checked, "limit"), check.exceeded.size(), check.open.size());
  if (!check.loose.empty())
    text += fmt::format("can be tightened:\n{}\n", findings_as_text(check.loose, files));
  return text;
}

std::string kernels_as_json(const KernelSurvey& survey, const KernelsOptions& options,
                            const std::optional<LimitsCheck>& check, const Diagnostics& files) {
  JsonWriter json;
  json.open_object().member("ok", !check || check->is_good());
  json.member("device", survey.device).member("driver", survey.driver);
  json.member("statistics", survey.statistics);
  json.member("width", options.size.width).member("height", options.size.height);
  json.member("covered", options.assumptions.covered)
      .member("flagged", options.assumptions.flagged)
      .member("flagged_fine", options.assumptions.flagged_fine);
  write_kernels(survey, json);
  write_graphs(survey, json);
  write_works(survey, json);
  json.key("skipped").open_array();
  for (const SkippedGraph& skipped : survey.skipped)
    json.open_object(true).member("graph", skipped.graph).member("why", skipped.why).close();
  json.close();
  if (check) {
    json.key("limits").open_object().member("file", options.limits);
    json.member("device_known", check->device_known)
        .member("checked", static_cast<uint64_t>(check->checked));
    write_findings("exceeded", check->exceeded, files, json);
    write_findings("open", check->open, files, json);
    write_findings("loose", check->loose, files, json);
    json.close();
  }
  json.close();
  return std::move(json).finish();
}

} // namespace dermis::tools
