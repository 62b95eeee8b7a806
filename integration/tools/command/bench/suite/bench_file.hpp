#pragma once
// Reads the files that describe what a suite measures (tests/benchmark).

#include "framegraph/text/reader.hpp"
#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/verbs.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

// A technique at one setting.
struct TechniqueRequest {
  std::string technique, setting;         // names in the report
  std::string graph;                      // file
  std::vector<NamedValue> set;            // values of the graph's settings
  bool heat_map = false;                  // include an error map in the report
  std::vector<std::string> overlays = {}; // files, in order
};

inline constexpr size_t max_bench_entries = 256;
inline constexpr double min_d_px = 0.05, max_d_px = 64; // limits of a projected d

// An object of a bench file. Getters leave the value unchanged if an optional key is absent.
struct BenchObject {
  const Document& document;
  Diagnostics& diagnostics;
  ObjectReader reader;

  BenchObject(const Document& from, NodeId node, std::string what, Diagnostics& reported)
      : document(from), diagnostics(reported), reader(from, node, std::move(what), reported) {}

  void name(std::string_view key, std::string& value);
  void text(std::string_view key, std::string& value);
  void file(std::string_view key, std::string& value, Need need = Need::required); // may be shipped
  void flag(std::string_view key, bool& value);                                    // optional
  void count(std::string_view key, uint32_t& value, int64_t minimum, int64_t maximum,
             Need need = Need::required);
  void camera(std::optional<demo::CameraPlace>& place); // optional
  // Reads the keys technique, setting, graph, overlays, set and heat_map.
  void technique(TechniqueRequest& request);

  // Calls read(BenchObject&) for the object `key` if there is one.
  template <class Read> void object(std::string_view key, Need need, Read read) {
    const NodeId node = reader.object(key, need);
    if (!node.valid()) return;
    BenchObject inner(document, node, fmt::format("'{}' of {}", key, reader.what()), diagnostics);
    read(inner);
    inner.reader.finish();
  }
  // Calls read(BenchObject&) for each object of a list.
  template <class Read>
  void entries(std::string_view key, std::string_view what, size_t minimum, Read read) {
    const NodeId list = reader.array(key, minimum, max_bench_entries);
    if (!list.valid()) return;
    size_t number = 0;
    for (const NodeId node : children(document, list)) {
      BenchObject entry(document, node, fmt::format("{} {}", what, number++), diagnostics);
      read(entry);
      entry.reader.finish();
    }
  }
};

// Reads a bench file with read(BenchObject& root, File&). Returns nullopt with located errors.
template <class File, class Read>
std::optional<File> read_bench_file(const std::string& path, Diagnostics& diagnostics, Read read) {
  const auto document = read_document(path, diagnostics);
  if (!document || !check_version(*document, "dermis_benchmark", 1, diagnostics))
    return std::nullopt;
  File file;
  BenchObject root(*document, document->root(), "the bench file", diagnostics);
  root.reader.integer("dermis_benchmark", 1, 1);
  read(root, file);
  root.reader.finish();
  if (diagnostics.has_errors()) return std::nullopt;
  return file;
}

} // namespace dermis::tools
