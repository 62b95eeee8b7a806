#include "integration/tools/files/roots.hpp"

#include "framegraph/text/file_roots.hpp"
#include "framegraph/text/limits.hpp"
#include "integration/tools/files/bytes.hpp"

#include <fmt/format.h>
#include <span>
#include <system_error>

namespace dermis::tools {

namespace fs = std::filesystem;

namespace {

FileText open_file(const std::vector<fs::path>& roots, std::string_view name) {
  FileText out;
  std::string searched;
  for (const fs::path& root : roots) {
    const PlacedFile placed = place_file(root, name, std::span(&root, 1));
    searched +=
        fmt::format("{}'{}'", searched.empty() ? "" : ", ", root.empty() ? "." : root.string());
    std::error_code code;
    if (!fs::exists(placed.real, code)) continue;
    out.name = placed.path.string();
    if (!placed.problem.empty()) {
      out.problem = placed.problem;
      return out;
    }
    if (!fs::is_regular_file(placed.real, code)) continue;
    const auto bytes = read_bytes(placed.real, limits::file_bytes, out.problem);
    if (bytes) out.text.assign(bytes->begin(), bytes->end());
    return out;
  }
  out.problem = searched.empty()
                    ? std::string("no folder to read from is declared; add one with --root")
                    : fmt::format("there is no such file in {}; add folders with --root", searched);
  return out;
}

} // namespace

OpenFile open_below(std::vector<fs::path> roots) {
  return [roots = std::move(roots)](std::string_view name) { return open_file(roots, name); };
}

} // namespace dermis::tools
