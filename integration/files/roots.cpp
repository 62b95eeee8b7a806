#include "integration/files/roots.hpp"

#include "framegraph/text/limits.hpp"
#include "integration/files/bytes.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <system_error>

namespace dermis::tools {

namespace fs = std::filesystem;

namespace {

bool is_below(const fs::path& path, const fs::path& root) {
  return std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first == root.end();
}

FileText open_file(const std::vector<fs::path>& roots, std::string_view name) {
  FileText out;
  std::string looked_in;
  for (const fs::path& root : roots) {
    const fs::path shown = (root / fs::path(name)).lexically_normal();
    std::error_code code;
    const fs::path real_root = fs::canonical(root.empty() ? fs::path(".") : root, code);
    const fs::path real = code ? fs::path() : fs::canonical(shown, code);
    looked_in += fmt::format("{}'{}'", looked_in.empty() ? "" : ", ", root.empty() ? "." : root.string());
    if (code || !fs::is_regular_file(real, code)) continue;
    out.name = shown.string();
    if (!is_below(real, real_root)) {
      out.problem = fmt::format("'{}' leads out of '{}'", out.name, root.string());
      return out;
    }
    const auto bytes = read_bytes(real, limits::file_bytes, out.problem);
    if (bytes) out.text.assign(bytes->begin(), bytes->end());
    return out;
  }
  out.problem = looked_in.empty()
                    ? std::string("no folder to read it from is declared; --root declares one")
                    : fmt::format("there is no such file in {}; --root declares further folders", looked_in);
  return out;
}

} // namespace

OpenFile open_below(std::vector<fs::path> roots) {
  return [roots = std::move(roots)](std::string_view name) { return open_file(roots, name); };
}

} // namespace dermis::tools
