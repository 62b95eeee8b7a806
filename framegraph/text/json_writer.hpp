#pragma once
// Writes JSON whose bytes only depend on the values: keys in call order, two spaces of indentation,
// and the shortest numbers that read back exactly.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dermis {

// Calls must nest: key() before each value inside an object, no key() inside an array. An object or
// array opened as `compact` is written on one line, with all its contents.
class JsonWriter {
public:
  JsonWriter& open_object(bool compact = false) { return open('{', compact); }
  JsonWriter& open_array(bool compact = false) { return open('[', compact); }
  JsonWriter& close(); // closes the innermost object or array
  JsonWriter& key(std::string_view name);

  // Escapes control characters, '"' and '\', and replaces bytes that are not UTF-8.
  JsonWriter& value(std::string_view text);
  JsonWriter& value(const char* text) { return value(std::string_view(text)); }
  JsonWriter& value(bool flag) { return raw(flag ? "true" : "false"); }
  JsonWriter& value(double number); // null if not finite
  JsonWriter& value(int64_t number);
  JsonWriter& value(uint64_t number);
  JsonWriter& value(int32_t number) { return value(static_cast<int64_t>(number)); }
  JsonWriter& value(uint32_t number) { return value(static_cast<uint64_t>(number)); }
  JsonWriter& null() { return raw("null"); }
  // a whole value that already is JSON
  JsonWriter& json(std::string_view text) { return raw(text); }

  template <class T> JsonWriter& member(std::string_view name, const T& what) {
    return key(name).value(what);
  }

  // Returns the written text, with a newline at the end.
  std::string finish() &&;

private:
  struct Level {
    char closing;
    bool compact;
    bool empty = true;
  };
  JsonWriter& open(char bracket, bool compact);
  JsonWriter& raw(std::string_view text);
  void separate(); // comma, line break and indentation before the next key or element
  void quote(std::string_view text);

  std::string text_;
  std::vector<Level> levels_;
  bool after_key_ = false;
};

} // namespace dermis
