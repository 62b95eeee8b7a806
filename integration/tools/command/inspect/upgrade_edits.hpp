#pragma once
// Edits of a JSON text that keep its comments and lines. Places come from the parsed document.

#include "framegraph/text/document.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

// Edits apply together, in result(); only removed members may be neighbours. `source` and `json`
// must outlive it.
class TextEdits {
public:
  TextEdits(const Document& source, std::string_view json);

  std::string result();

  bool is_array(NodeId node) const;
  // Returns the string at a key; invalid if there is none or `object` is none.
  NodeId string_at(NodeId object, std::string_view key) const;
  // Returns the resource at a port of a pass; "" without the port. `side`: "read" or "write".
  std::string_view at_port(NodeId pass, std::string_view side, std::string_view port) const;

  void replace(size_t begin, size_t end, std::string text);
  // Do nothing for an empty text.
  void rename(NodeId string, std::string_view text);
  void rename_key(NodeId value, std::string_view text);
  // Adds `member`, "name": value, at the begin of an object.
  void add_member(NodeId object, std::string_view member);
  // Replaces the key and the value of a member.
  void replace_member(NodeId value, std::string member);
  // Removes a member and one of the commas around it. Empty lines take the place of its lines.
  void remove_member(NodeId value);

  const Document& document;
  const std::string_view text;

private:
  struct Edit {
    size_t begin, end; // byte range of the old text
    std::string text;
  };

  // Replaces a part of the text by its line breaks.
  void remove(size_t begin, size_t end);
  // Removes the comma before the member at `begin`, or before the removed members in front of it.
  void remove_comma_before(size_t begin);
  size_t next_token(size_t at) const; // skips blanks and comments
  // Returns the comma before the member or comma at `begin`; the brace before the first member.
  size_t separator_before(size_t begin) const;
  size_t key_begin(NodeId value) const;
  size_t end_of_string(size_t begin) const;
  size_t end_of_value(NodeId value) const;

  std::vector<size_t> line_begins_;
  std::vector<Edit> edits_;
  std::vector<size_t> removed_last_; // begins of removed members that no comma follows
};

} // namespace dermis::tools
