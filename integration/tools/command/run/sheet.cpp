// dermis sheet: renders one image of a scene with every technique (rows) and every material
// (columns), for visual inspection.

#include "framegraph/text/json_writer.hpp"
#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/output.hpp"
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
      options.graphs.empty() ? all_shipped("graphs", {"separable_jimenez", "separable", "pyramid",
                                                      "fixed", "burley", "sap"})
                             : shipped_files("graphs", options.graphs);
  const size_t rows = graphs.size() + 1, columns = profiles.size();
  if (columns * (options.size.width + gap) > longest_side ||
      rows * (options.size.height + gap) > longest_side)
    return fail(session, ExitCode::usage,
                fmt::format("the sheet exceeds {} pixels along a side; use a smaller --size",
                            longest_side));
  Diagnostics diagnostics;
  const std::optional<LoadedGraph> known = load_pass_types(options.pass_types, diagnostics);
  if (!known)
    return fail(session, ExitCode::problems, "the pass types cannot be used", &diagnostics);
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
      engine.graph = row == 0 ? "" : graphs[row - 1];
      engine.profile = profiles[column];
      demo::RenderCallbacks callbacks;
      callbacks.on_frame = [&](const demo::FrameOutputs& frame) -> demo::Result<> {
        sheet.put(row, column, frame.display);
        if (row == 0) without = frame.display;
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
  say(session,
      fmt::format("{}\nrows from the top: none, {}\ncolumns from the left: {}\n", options.out,
                  fmt::join(stems(graphs), ", "), fmt::join(stems(profiles), ", ")));
  if (session.json) {
    JsonWriter answer;
    answer.open_object().member("ok", true).member("out", options.out);
    answer.member("width", sheet.width).member("height", sheet.height);
    answer.key("rows").open_array().value("none");
    for (const std::string& name : stems(graphs))
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
