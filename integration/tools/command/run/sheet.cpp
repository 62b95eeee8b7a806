// dermis sheet: renders one image of a scene with every technique or budget (rows) and every
// material (columns), for visual inspection.

#include "framegraph/text/json_writer.hpp"
#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/run/budget_input.hpp"
#include "integration/tools/command/run/host_passes.hpp"
#include "integration/tools/command/verbs.hpp"
#include "integration/tools/files/png.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace dermis::tools {
namespace {

constexpr uint32_t gap = 4;              // pixels between images
constexpr uint32_t longest_side = 16384; // of the sheet, pixels
// Frames within a budget before the one that is shown: switches and fades are over.
constexpr uint32_t frames_of_budget = 24;

std::vector<std::string> all_shipped(std::string_view folder,
                                     std::initializer_list<std::string_view> names) {
  std::vector<std::string> files;
  for (const std::string_view name : names)
    files.push_back(shipped(folder, name));
  return files;
}

std::vector<std::string> stems(const std::vector<std::string>& files) {
  std::vector<std::string> names;
  for (const std::string& file : files)
    names.push_back(std::filesystem::path(file).stem().string());
  return names;
}

struct Row {
  std::string graph; // file; "": no technique
  double budget_ms = 0;
  std::string name;
};

std::vector<Row> rows_of(const std::vector<std::string>& graphs,
                         const std::vector<double>& budgets) {
  std::vector<Row> rows{{"", 0, "none"}};
  for (const std::string& graph : graphs) {
    const std::string name = std::filesystem::path(graph).stem().string();
    for (const double ms : budgets)
      rows.push_back({graph, ms, fmt::format("{} within {:g} ms", name, ms)});
    if (budgets.empty()) rows.push_back({graph, 0, name});
  }
  return rows;
}

// Adds the configuration that runs in the row's last frame, if the graph has a choice.
void add_configuration(Row& row, const demo::FrameOutputs& frame) {
  if (row.budget_ms <= 0 || !frame.choice || frame.choice->configurations < 2) return;
  const std::string text = fmt::format(" ({})", frame.choice->configuration);
  if (row.name.find(text) == std::string::npos) row.name += text;
}

std::vector<std::string> names_of(const std::vector<Row>& rows) {
  std::vector<std::string> names;
  for (const Row& row : rows)
    names.push_back(row.name);
  return names;
}

struct Sheet {
  Size one;
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgb; // black between images

  Sheet(Size size, size_t rows, size_t columns) : one(size) {
    width = static_cast<uint32_t>(columns) * (size.width + gap) - gap;
    height = static_cast<uint32_t>(rows) * (size.height + gap) - gap;
    rgb.resize(size_t{3} * width * height);
  }
  void put(size_t row, size_t column, const std::vector<uint8_t>& picture) {
    for (size_t y = 0; y < one.height; ++y) {
      const size_t at = (row * (one.height + gap) + y) * width + column * (one.width + gap);
      std::copy_n(picture.begin() + static_cast<std::ptrdiff_t>(3 * y * one.width),
                  3 * size_t{one.width}, rgb.begin() + static_cast<std::ptrdiff_t>(3 * at));
    }
  }
};

} // namespace

ExitCode sheet(const Session& session, const SheetOptions& options) {
  const std::vector<std::string> profiles =
      options.profiles.empty()
          ? all_shipped("profiles", {"skin", "jade", "marble", "wax", "ketchup", "milk"})
          : shipped_files("profiles", options.profiles);
  const std::vector<std::string> graphs =
      !options.graphs.empty()    ? shipped_files("graphs", options.graphs)
      : !options.budgets.empty() ? all_shipped("graphs", {"skin"})
                                 : all_shipped("graphs", {"separable_jimenez", "separable",
                                                          "pyramid", "fixed", "burley", "sap"});
  std::vector<Row> list = rows_of(graphs, options.budgets);
  const size_t rows = list.size(), columns = profiles.size();
  if (columns * (options.size.width + gap) > longest_side ||
      rows * (options.size.height + gap) > longest_side)
    return fail(session, ExitCode::usage,
                fmt::format("the sheet exceeds {} pixels along a side; use a smaller --size",
                            longest_side));
  OutputFolder folder;
  if (const std::string problem = folder.open_for(options.out); !problem.empty())
    return fail(session, ExitCode::environment, problem);
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> known = load_pass_types(options.pass_types, diagnostics);
  if (!known)
    return fail(session, ExitCode::problems, "the pass types cannot be used", &diagnostics);
  auto calibration = read_named(options.calibration);
  if (!calibration) return fail(session, calibration.error());
  Sheet sheet(options.size, rows, columns);
  Progress progress(progress_style(session.quiet, session.json), "sheet", "picture",
                    static_cast<uint32_t>(rows * columns));
  std::vector<uint8_t> without; // without a technique, the image is equal for all materials
  for (size_t row = 0; row < rows; ++row)
    for (size_t column = 0; column < columns; ++column) {
      if (row == 0 && column > 0) {
        sheet.put(row, column, without);
        continue;
      }
      HostPasses host_passes(known->host_pass_types);
      demo::RenderOptions engine;
      engine.hooks = host_passes.hooks();
      engine.scene = options.scene;
      engine.roots = options.roots;
      engine.width = options.size.width;
      engine.height = options.size.height;
      engine.graph = list[row].graph;
      engine.profile = profiles[column];
      if (list[row].budget_ms > 0) {
        engine.budget.ms = list[row].budget_ms;
        engine.budget.deterministic = true;
        engine.budget.calibration = *calibration;
        engine.frames = frames_of_budget;
      } else if (!options.budgets.empty()) {
        engine.first_frame = frames_of_budget - 1; // the frame that the other rows show
      }
      demo::RenderCallbacks callbacks;
      callbacks.on_frame = [&](const demo::FrameOutputs& frame) -> demo::Result<> {
        sheet.put(row, column, frame.display);
        if (row == 0) without = frame.display;
        if (frame.frame + 1 == engine.frames) add_configuration(list[row], frame);
        return demo::success();
      };
      const auto summary = demo::render(engine, callbacks);
      if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
      if (!summary) return fail(session, summary.error());
      progress.update(static_cast<uint32_t>(row * columns + column + 1));
    }
  std::string problem;
  if (!write_png(options.out, sheet.width, sheet.height, sheet.rgb, problem))
    return fail(session, ExitCode::environment, problem);
  const std::vector<std::string> names = names_of(list);
  say(session, fmt::format("{}\nrows from the top: {}\ncolumns from the left: {}\n", options.out,
                           fmt::join(names, ", "), fmt::join(stems(profiles), ", ")));
  if (session.json) {
    JsonWriter answer;
    answer.open_object().member("ok", true).member("out", options.out);
    answer.member("width", sheet.width).member("height", sheet.height);
    answer.key("rows").open_array();
    for (const std::string& name : names)
      answer.value(name);
    answer.close().key("columns").open_array();
    for (const std::string& name : stems(profiles))
      answer.value(name);
    answer.close().close();
    print(std::move(answer).finish());
  }
  return ExitCode::ok;
}

} // namespace dermis::tools
