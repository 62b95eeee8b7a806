#pragma once
// Reading objects of a document strictly: every key is asked for by name and type, whatever else is there is
// an error. Used by graphs, profiles, scenes and captures alike.
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

// Each getter returns the value, or nullopt with an error when it has the wrong type or range, or is absent
// and required; absent and optional: nullopt without an error. Ranges are inclusive. `what` names the object
// in messages ("pass 'scatter'"). A key "note" (a string) is allowed in every object, "$schema" in the root.
// The reader must not outlive document and diagnostics; string views point into the document.
class ObjectReader {
public:
  ObjectReader(const Document& document, NodeId node, std::string what, Diagnostics& diagnostics);

  bool has(std::string_view key); // counts as asking for it
  std::optional<std::string_view> string(std::string_view key, Need need = Need::required);
  // [A-Za-z_][A-Za-z0-9_]*, at most limits::name_bytes: what other parts of a file refer to.
  std::optional<std::string_view> name(std::string_view key, Need need = Need::required);
  std::optional<bool> boolean(std::string_view key, Need need = Need::required);
  std::optional<int64_t> integer(std::string_view key, int64_t minimum, int64_t maximum,
                                 Need need = Need::required);
  std::optional<double> number(std::string_view key, double minimum, double maximum,
                               Need need = Need::required);
  // Exactly out.size() numbers; false and `out` untouched where a getter would return nullopt.
  bool numbers(std::string_view key, std::span<double> out, double minimum, double maximum,
               Need need = Need::required);
  // Index into `words`.
  std::optional<uint32_t> word(std::string_view key, std::span<const std::string_view> words,
                               Need need = Need::required);
  // The node, for whoever reads it further; invalid where another getter would return nullopt.
  NodeId object(std::string_view key, Need need = Need::required);
  NodeId array(std::string_view key, size_t minimum, size_t maximum, Need need = Need::required);
  NodeId any(std::string_view key, Need need = Need::required);

  // Reports keys that nobody asked for; one that is a misspelt required key takes the place of the message
  // that the key is missing. True when this object had no error at all, here or before.
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

// Single values; `what` names the value in messages ("'size' of import 'depth'").
std::optional<std::string_view> read_string(const Document&, NodeId, std::string_view what, Diagnostics&);
std::optional<std::string_view> read_name(const Document&, NodeId, std::string_view what, Diagnostics&);
std::optional<bool> read_boolean(const Document&, NodeId, std::string_view what, Diagnostics&);
std::optional<int64_t> read_integer(const Document&, NodeId, std::string_view what, int64_t minimum,
                                    int64_t maximum, Diagnostics&);
std::optional<double> read_number(const Document&, NodeId, std::string_view what, double minimum,
                                  double maximum, Diagnostics&);
std::optional<uint32_t> read_word(const Document&, NodeId, std::string_view what,
                                  std::span<const std::string_view> words, Diagnostics&);
bool read_numbers(const Document&, NodeId, std::string_view what, std::span<double> out, double minimum,
                  double maximum, Diagnostics&);
bool expect_kind(const Document&, NodeId, std::string_view what, NodeKind kind, Diagnostics&);

// Is it [A-Za-z_][A-Za-z0-9_]* of at most limits::name_bytes? Else an error at `where`.
bool check_name(std::string_view name, std::string_view what, const SourceLocation& where, Diagnostics&);

// The first member of `object` whose key is a slip of the pen away from `key`; invalid when there is none.
NodeId find_misspelt(const Document&, NodeId object, std::string_view key);

// Children in the order of the text.
std::vector<NodeId> children(const Document&, NodeId);

// The version key of a root object (`"dermis": 2`): absent, mistyped or not `supported` is an error.
bool check_version(const Document&, std::string_view key, int64_t supported, Diagnostics&);

} // namespace dermis
