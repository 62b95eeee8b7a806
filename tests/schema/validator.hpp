#pragma once
// An independent judge: draft-07 validation by another's code.

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace dermis::testing {

class SchemaFile {
public:
  explicit SchemaFile(const std::string& path); // from the repository's root
  ~SchemaFile();
  bool accepts(const nlohmann::json& document) const;
  std::string first_problem(const nlohmann::json& document) const; // "" when it accepts

private:
  struct Parsed;
  std::unique_ptr<Parsed> parsed_;
};

} // namespace dermis::testing
