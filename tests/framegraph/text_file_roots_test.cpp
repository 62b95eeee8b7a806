// Tests which paths a file may use to name other files.

#include "framegraph/text/file_roots.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/test_folder.hpp"

#include <filesystem>
#include <fstream>
#include <vector>

namespace dermis {
namespace {

namespace fs = std::filesystem;

struct FileRoots : ::testing::Test {
  const dermis::test::TestFolder temporary;
  const fs::path top = fs::canonical(temporary.path());
  void SetUp() override {
    fs::create_directories(top / "root/in");
    fs::create_directories(top / "root_beside");
    std::ofstream(top / "root/in/file") << "x";
    std::ofstream(top / "root_beside/file") << "x";
    fs::create_directory_symlink(top / "root_beside", top / "root/out");
    fs::create_directory_symlink(top / "root/in", top / "root/inner");
    fs::create_symlink(top / "root/loop", top / "root/loop");
    fs::create_directory_symlink(top / "root", top / "entrance");
  }
  std::string problem(const fs::path& folder, const std::string& name, const fs::path& root) const {
    return place_file(folder, name, std::vector<fs::path>{root}).problem;
  }
};

TEST_F(FileRoots, PathBelowARoot_IsAccepted) {
  const fs::path root = top / "root";
  for (const char* name : {"in/file", "in/absent", "inner/file", "in/../in/file", "./in/./file"})
    EXPECT_EQ(problem(root, name, root), "") << name;
  EXPECT_EQ(problem(root / "in", "../other", root), "");
  EXPECT_EQ(problem(root, (root / "in/file").string(), root), "");
  EXPECT_EQ(problem(top / "entrance", "in/file", root), "")
      << "a root that is reached through a link";
  EXPECT_EQ(problem(root, "in/file", top / "entrance"), "");
  EXPECT_EQ(problem(root, "in/file", (root / "").string()), "") << "with a trailing slash";
  EXPECT_EQ(place_file(root, "inner/file", std::vector<fs::path>{root}).real, root / "in/file");
}

TEST_F(FileRoots, PathOutsideTheRoots_IsRejected) {
  const fs::path root = top / "root";
  for (const std::string& name :
       {std::string("../root_beside/file"), std::string("out/file"), std::string("out"),
        std::string("in/../../root_beside/absent"), std::string("/etc/passwd"),
        (top / "root_beside/file").string(), std::string("..")})
    EXPECT_THAT(problem(root, name, root),
                HasSubstr("outside the readable folders '" + root.string() + "'"))
        << name;
  EXPECT_THAT(problem("", "../x", ""), HasSubstr("'.'"));
}

TEST_F(FileRoots, NonPortableName_IsRejected) {
  const fs::path root = top / "root";
  EXPECT_EQ(problem(root, "", root), "it is not a file name");
  EXPECT_EQ(problem(root, std::string("in/file\0.json", 13), root), "it is not a file name");
  EXPECT_NE(problem(root, std::string(300, 'n'), root), "");
  EXPECT_NE(problem(root, std::string(100000, '/') + std::string(5000, 'n'), root), "");
  EXPECT_NE(problem(root, "loop/file", root), "");
}

TEST_F(FileRoots, HomeIsTheFolderOrTheProject) {
  EXPECT_EQ(home_of("a/b/scene.json"), fs::path("a/b"));
  EXPECT_EQ(home_of("configs/scenes/bust.json"), fs::path("configs/"));
  EXPECT_EQ(home_of("/x/profiles/skin.json"), fs::path("/x/"));
  EXPECT_EQ(home_of("scenes/bust.json"), fs::path("."));
  EXPECT_EQ(home_of("my_scenes/bust.json"), fs::path("my_scenes"));
  const fs::path before = fs::current_path();
  fs::create_directories(top / "project/scenes");
  fs::current_path(top / "project/scenes");
  EXPECT_EQ(home_of("bust.json"), fs::path("..")); // The path is relative to the current directory.
  fs::current_path(before);
}

} // namespace
} // namespace dermis
