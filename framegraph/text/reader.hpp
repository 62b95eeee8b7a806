#pragma once
// Reads objects of a document strictly: every key is requested by name and type, and any other key
// is an error. Used for graphs, profiles, scenes and captures.
//
//   ObjectReader object(document, node, "profile", diagnostics);
//   const auto name = object.string("name");
//   const auto eta = object.number("eta", 1.0, 3.0, Need::optional);
//   if (!object.finish()) return std::nullopt;

#include "framegraph/text/document.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {

enum class Need : uint8_t { required, optional };

// Each getter returns the value. It returns nullopt with an error if the value has the wrong type
// or range, or is absent and required. It returns nullopt without an error if the value is absent
// and optional. Ranges are inclusive. `what` names the object in messages ("pass 'scatter'"). A key
// "note" (a string) is allowed in every object, "$schema" in the root. The reader must not outlive
// document and diagnostics; string views point into the document.
class ObjectReader {
public:
  ObjectReader(const Document& document, NodeId node, std::string what, Diagnostics& diagnostics);

  bool has(std::string_view key); // marks the key as requested
  std::optional<std::string_view> string(std::string_view key, Need need = Need::required);
  // Reads [A-Za-z_][A-Za-z0-9_]*, at most limits::name_bytes: a name that other parts of a file
  // refer to.
  std::optional<std::string_view> name(std::string_view key, Need need = Need::required);
  std::optional<bool> boolean(std::string_view key, Need need = Need::required);
  std::optional<int64_t> integer(std::string_view key, int64_t minimum, int64_t maximum,
                                 Need need = Need::required);
  std::optional<double> number(std::string_view key, double minimum, double maximum,
                               Need need = Need::required);
  // Reads exactly out.size() numbers. Returns false, with `out` unchanged, where other getters
  // return nullopt.
  bool numbers(std::string_view key, std::span<double> out, double minimum, double maximum,
               Need need = Need::required);
  // Returns the index into `words`.
  std::optional<uint32_t> word(std::string_view key, std::span<const std::string_view> words,
                               Need need = Need::required);
  // Return the node for further reading; invalid where other getters return nullopt.
  NodeId object(std::string_view key, Need need = Need::required);
  NodeId array(std::string_view key, size_t minimum, size_t maximum, Need need = Need::required);
  NodeId any(std::string_view key, Need need = Need::required);

  // Reports keys that were not requested. A misspelt required key replaces the message that the key
  // is missing. Returns true if this object had no error at all.
  bool finish();

  bool ok() const { return ok_; }
  NodeId node() const { return node_; }
  const std::string& what() const { return what_; }

private:
  NodeId find(std::string_view key, Need need);
  NodeId find(std::string_view key, Need need, NodeKind kind);
  std::string describe(std::string_view key) const;

  const Document& document_;
  Diagnostics& diagnostics_;
  NodeId node_;
  std::string what_;
  struct Missing {
    std::string_view key;
    size_t diagnostic; // index into Diagnostics::list
  };
  std::vector<std::string_view> requested_;
  std::vector<Missing> missing_;
  bool ok_ = true;
};

// Read single values; `what` names the value in messages ("'size' of import 'depth'").
std::optional<std::string_view> read_string(const Document&, NodeId, std::string_view what,
                                            Diagnostics&);
std::optional<std::string_view> read_name(const Document&, NodeId, std::string_view what,
                                          Diagnostics&);
std::optional<bool> read_boolean(const Document&, NodeId, std::string_view what, Diagnostics&);
std::optional<int64_t> read_integer(const Document&, NodeId, std::string_view what, int64_t minimum,
                                    int64_t maximum, Diagnostics&);
std::optional<double> read_number(const Document&, NodeId, std::string_view what, double minimum,
                                  double maximum, Diagnostics&);
std::optional<uint32_t> read_word(const Document&, NodeId, std::string_view what,
                                  std::span<const std::string_view> words, Diagnostics&);
bool read_numbers(const Document&, NodeId, std::string_view what, std::span<double> out,
                  double minimum, double maximum, Diagnostics&);
bool expect_kind(const Document&, NodeId, std::string_view what, NodeKind kind, Diagnostics&);

// Returns whether `name` is [A-Za-z_][A-Za-z0-9_]* with at most limits::name_bytes; else reports an
// error at `where`.
bool check_name(std::string_view name, std::string_view what, const SourceLocation& where,
                Diagnostics&);

// Returns the first member of `object` whose key resembles `key`; invalid if there is none.
NodeId find_misspelt(const Document&, NodeId object, std::string_view key);

// Returns the children in text order.
std::vector<NodeId> children(const Document&, NodeId);

// Checks the version key of a root object (`"dermis": 2`). An absent, mistyped or not `supported`
// version is an error.
bool check_version(const Document&, std::string_view key, int64_t supported, Diagnostics&);

} // namespace dermis
