// Enforces the include rule of the architecture on all #include lines: a folder includes only
// folders before it.

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {
namespace {

// Folders in include order. A file belongs to the folder with the longest matching prefix.
constexpr std::string_view folders[] = {"framegraph/", "framegraph/vulkan/", "passes/",
                                        "integration/", "tests/"};

// Returns an index into `folders`, or -1 for other files (system headers, shaders).
int folder_of(std::string_view path) {
  int best = -1;
  for (int i = 0; i < static_cast<int>(std::size(folders)); ++i) {
    const std::string_view folder = folders[i];
    if (path.substr(0, folder.size()) == folder &&
        (best < 0 || folder.size() > folders[best].size()))
      best = i;
  }
  return best;
}

// Returns the path between the quotes or brackets of an #include line, or an empty view for any
// other line.
std::string included(std::string_view line) {
  const auto skip = [&](std::string_view characters) {
    line.remove_prefix(std::min(line.find_first_not_of(characters), line.size()));
  };
  skip(" \t");
  if (line.empty() || line.front() != '#') return {};
  line.remove_prefix(1);
  skip(" \t");
  constexpr std::string_view word = "include";
  if (line.substr(0, word.size()) != word) return {};
  line.remove_prefix(word.size());
  skip(" \t\"<");
  return std::string(line.substr(0, line.find_first_of("\">")));
}

// Returns the error if `path` (from the repository root) must not include `target`, else "".
std::string violation(const std::string& path, const std::string& target) {
  const int from = folder_of(path), to = folder_of(target);
  if (from < 0) return {};
  if (to > from) return path + " includes " + target + ", which is below it in the architecture";
  const bool vulkan_header =
      target.rfind("vulkan/", 0) == 0 || target.rfind("vk_", 0) == 0 || target == "volk.h";
  if (from == 0 && vulkan_header)
    return path + " includes " + target + ", but the graph itself knows no device";
  return {};
}

// The include order of the folders below one root.
struct Order {
  std::string_view root;
  std::vector<std::string_view> folders;
};
const Order orders[] = {
    {"framegraph/",
     {"text", "compose", "model", "schema", "compile", "verify", "serialize", "explain", "vulkan"}},
    {"integration/tools/command/",
     {"expect", "run", "bench", "plan", "inspect", "capture", "watch", "arguments"}},
    {"integration/",
     {"include", "abi", "tools/references", "tools/files", "tools/null_device",
      "examples/demo_engine", "tools/viewer", "tools/command"}},
};
constexpr std::string_view techniques[] = {"separable", "burley", "sap", "afis", "restir"};

// Returns the index of the folder of `path` in `order`, or -1 for another root and for files of the
// root itself.
int place_of(const Order& order, std::string_view path) {
  if (!path.starts_with(order.root)) return -1;
  path.remove_prefix(order.root.size());
  for (size_t i = 0; i < order.folders.size(); ++i)
    if (path.starts_with(order.folders[i]) && path.substr(order.folders[i].size()).starts_with('/'))
      return static_cast<int>(i);
  return -1;
}

std::string_view technique_of(std::string_view path) {
  for (const std::string_view technique : techniques)
    if (path.starts_with("passes/" + std::string(technique) + "/")) return technique;
  return {};
}

// Returns the error if `path` must not include `target` within one root, else "".
std::string violation_within(const std::string& path, const std::string& target) {
  for (const Order& order : orders) {
    const int from = place_of(order, path), to = place_of(order, target);
    const bool base = from < 0 && path.starts_with(order.root) &&
                      order.root.ends_with("command/") && !path.ends_with("main.cpp");
    if (to > from && (from >= 0 || base))
      return path + " includes " + target + ", whose folder comes later";
  }
  const std::string_view from = technique_of(path), to = technique_of(target);
  if (!from.empty() && !to.empty() && from != to)
    return path + " includes " + target + ", which is another technique's";
  if (path.starts_with("passes/choice/") && !to.empty())
    return path + " includes " + target + ", but the choice knows no technique";
  if (path.ends_with("abi/compiled_graph.hpp") && target.ends_with("abi/chooser.hpp"))
    return path + " includes the chooser, which reads programs";
  return {};
}

TEST(IncludeRule, NoFileIncludesALaterFolder) {
  const std::filesystem::path root = DERMIS_SOURCE_DIR;
  size_t files = 0, includes = 0;
  for (const char* folder : {"framegraph", "passes", "integration"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".hpp" && extension != ".cpp" && extension != ".h" && extension != ".c" &&
          extension != ".def")
        continue;
      ++files;
      const std::string path = std::filesystem::relative(entry.path(), root).generic_string();
      std::ifstream stream(entry.path());
      for (std::string line; std::getline(stream, line);) {
        const std::string target = included(line);
        if (target.empty()) continue;
        ++includes;
        EXPECT_EQ(violation(path, target), "");
        EXPECT_EQ(violation_within(path, target), "");
      }
    }
  }
  // Fails if the scan finds too few files.
  EXPECT_GT(files, 10u);
  EXPECT_GT(includes, files);
}

TEST(IncludeRule, ForbiddenIncludesAreFound) {
  EXPECT_EQ(included("  # include \"framegraph/text/document.hpp\" // x"),
            "framegraph/text/document.hpp");
  EXPECT_EQ(included("#include <vulkan/vulkan.h>"), "vulkan/vulkan.h");
  EXPECT_EQ(included("// #include \"passes/x.hpp\""), "");
  EXPECT_NE(violation("framegraph/compile/packer.cpp", "passes/x.hpp"), "");
  EXPECT_NE(violation("framegraph/compile/packer.cpp", "framegraph/vulkan/device.hpp"), "");
  EXPECT_NE(violation("framegraph/model/graph.hpp", "vulkan/vulkan.h"), "");
  EXPECT_NE(violation("framegraph/vulkan/device.hpp", "integration/abi/x.hpp"), "");
  EXPECT_NE(violation("passes/common/x.cpp", "integration/tools/files/exr.hpp"), "");
  EXPECT_NE(violation("integration/tools/command/main.cpp", "tests/x.hpp"), "");
  EXPECT_EQ(violation("framegraph/vulkan/device.hpp", "vulkan/vulkan.h"), "");
  EXPECT_EQ(violation("passes/common/x.cpp", "framegraph/vulkan/device.hpp"), "");
}

TEST(IncludeRule, FoldersIncludeOnlyEarlierFolders) {
  EXPECT_NE(violation_within("framegraph/text/diagnostic.hpp", "framegraph/model/ids.hpp"), "");
  EXPECT_NE(violation_within("integration/tools/command/expect/a.cpp",
                             "integration/tools/command/inspect/b.hpp"),
            "");
  EXPECT_NE(violation_within("integration/tools/command/run/a.cpp",
                             "integration/tools/command/bench/b.hpp"),
            "");
  EXPECT_NE(violation_within("integration/tools/command/session.hpp",
                             "integration/tools/command/run/b.hpp"),
            "");
  EXPECT_NE(violation_within("integration/abi/compiled_graph.hpp", "integration/abi/chooser.hpp"),
            "");
  EXPECT_NE(violation_within("integration/abi/a.cpp", "integration/tools/files/exr.hpp"), "");
  EXPECT_NE(violation_within("passes/sap/a.cpp", "passes/separable/b.hpp"), "");
  EXPECT_NE(violation_within("passes/choice/a.cpp", "passes/sap/b.hpp"), "");
  EXPECT_EQ(violation_within("passes/papers/a.cpp", "passes/separable/b.hpp"), "");
  EXPECT_EQ(violation_within("framegraph/model/graph.hpp", "framegraph/text/index.hpp"), "");
  EXPECT_EQ(violation_within("integration/tools/command/main.cpp",
                             "integration/tools/command/arguments/b.hpp"),
            "");
}

} // namespace
} // namespace dermis
