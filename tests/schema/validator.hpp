#pragma once
// Independent validation against draft-07 by a third-party library.

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace dermis::testing {

class SchemaFile {
public:
  explicit SchemaFile(const nlohmann::json& text);
  ~SchemaFile();
  bool accepts(const nlohmann::json& document) const;
  // Returns "" if the schema accepts the document.
  std::string first_problem(const nlohmann::json& document) const;

private:
  struct Parsed;
  std::unique_ptr<Parsed> parsed_;
};

// Reads a schema; `path` is relative to the root of the sources.
SchemaFile schema_in(const std::string& path);

} // namespace dermis::testing
