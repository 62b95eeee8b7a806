// File names and height of the head scan.

#include "integration/tools/command/bench/subject.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace dermis::tools {
namespace {

constexpr double head_height = 0.426; // metres; 0.24 m from chin to crown
constexpr const char* mesh_name = "LeePerrySmith.glb";

} // namespace

demo::ModelOptions head_model(const std::string& folder) {
  if (folder.empty()) return {};
  const std::filesystem::path head = folder;
  return {(head / mesh_name).string(), (head / "Map-COL.jpg").string(),
          (head / "Infinite-Level_02_Tangent_SmoothUV.jpg").string(),
          (head / "Map-SPEC.jpg").string(), head_height};
}

std::string why_no_head(const std::string& folder) {
  if (folder.empty()) return "no model is given (--head FOLDER)";
  const std::string mesh = (std::filesystem::path(folder) / mesh_name).string();
  return std::filesystem::exists(mesh) ? "" : fmt::format("'{}' does not exist", mesh);
}

} // namespace dermis::tools
