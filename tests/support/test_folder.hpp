#pragma once
// A temporary folder of a test, removed afterwards.

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace dermis::test {

class TestFolder {
public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "dermis_test_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr)
      throw std::runtime_error("no folder '" + name + "' can be made");
    place = name;
  }
  ~TestFolder() {
    std::error_code ignored; // A failing test reports the error itself.
    std::filesystem::remove_all(place, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  const std::filesystem::path& path() const { return place; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return place / name; }

private:
  std::filesystem::path place;
};

} // namespace dermis::test
