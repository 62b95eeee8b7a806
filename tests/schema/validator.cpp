#include "tests/schema/validator.hpp"

#include <fstream>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

namespace dermis::testing {

using Adapter = valijson::adapters::NlohmannJsonAdapter;

struct SchemaFile::Parsed {
  valijson::Schema schema;
};

SchemaFile::SchemaFile(const nlohmann::json& text) : parsed_(std::make_unique<Parsed>()) {
  valijson::SchemaParser parser(valijson::SchemaParser::kDraft7);
  parser.populateSchema(Adapter(text), parsed_->schema);
}

SchemaFile::~SchemaFile() = default;

SchemaFile schema_in(const std::string& path) {
  std::ifstream stream(std::string(DERMIS_SOURCE_DIR) + "/" + path);
  return SchemaFile(nlohmann::json::parse(stream));
}

bool SchemaFile::accepts(const nlohmann::json& document) const {
  return valijson::Validator(valijson::Validator::kStrongTypes)
      .validate(parsed_->schema, Adapter(document), nullptr);
}

std::string SchemaFile::first_problem(const nlohmann::json& document) const {
  valijson::ValidationResults results;
  valijson::Validator(valijson::Validator::kStrongTypes)
      .validate(parsed_->schema, Adapter(document), &results);
  std::string text;
  valijson::ValidationResults::Error error;
  while (results.popError(error)) {
    for (const std::string& step : error.context)
      text += step;
    text += ": " + error.description + "\n";
  }
  return text;
}

} // namespace dermis::testing
