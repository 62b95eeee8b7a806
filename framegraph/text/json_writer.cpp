#include "framegraph/text/json_writer.hpp"

#include "framegraph/text/utf8.hpp"

#include <fmt/format.h>

#include <cmath>

namespace dermis {

JsonWriter& JsonWriter::open(char bracket, bool compact) {
  separate();
  text_ += bracket;
  const bool inherited = !levels_.empty() && levels_.back().compact;
  levels_.push_back({bracket == '{' ? '}' : ']', compact || inherited});
  return *this;
}

JsonWriter& JsonWriter::close() {
  const Level level = levels_.back();
  levels_.pop_back();
  if (!level.empty && !level.compact) {
    text_ += '\n';
    text_.append(2 * levels_.size(), ' ');
  } else if (!level.empty && level.closing == '}') {
    text_ += ' ';
  }
  text_ += level.closing;
  return *this;
}

JsonWriter& JsonWriter::key(std::string_view name) {
  separate();
  quote(name);
  text_ += ": ";
  after_key_ = true;
  return *this;
}

void JsonWriter::separate() {
  if (after_key_) {
    after_key_ = false;
    return;
  }
  if (levels_.empty()) return;
  Level& level = levels_.back();
  if (!level.empty) text_ += level.compact ? ", " : ",";
  if (!level.compact) {
    text_ += '\n';
    text_.append(2 * levels_.size(), ' ');
  } else if (level.empty && level.closing == '}') {
    text_ += ' ';
  }
  level.empty = false;
}

JsonWriter& JsonWriter::raw(std::string_view text) {
  separate();
  text_ += text;
  return *this;
}

void JsonWriter::quote(std::string_view text) {
  text_ += '"';
  for (size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    const size_t bytes = utf8_sequence_bytes(text.substr(at, 4));
    if (bytes != 1) { // a byte that is not UTF-8 becomes U+FFFD
      text_ += bytes == 0 ? std::string_view("\xef\xbf\xbd") : text.substr(at, bytes);
      at += bytes == 0 ? 0 : bytes - 1;
      continue;
    }
    switch (c) {
    case '"':
      text_ += "\\\"";
      break;
    case '\\':
      text_ += "\\\\";
      break;
    case '\n':
      text_ += "\\n";
      break;
    case '\t':
      text_ += "\\t";
      break;
    case '\r':
      text_ += "\\r";
      break;
    default:
      if (static_cast<unsigned char>(c) < 0x20)
        text_ += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
      else
        text_ += c;
    }
  }
  text_ += '"';
}

JsonWriter& JsonWriter::value(std::string_view text) {
  separate();
  quote(text);
  return *this;
}

JsonWriter& JsonWriter::value(double number) {
  return std::isfinite(number) ? raw(fmt::format("{}", number)) : null();
}

JsonWriter& JsonWriter::value(int64_t number) {
  return raw(fmt::format("{}", number));
}

JsonWriter& JsonWriter::value(uint64_t number) {
  return raw(fmt::format("{}", number));
}

std::string JsonWriter::finish() && {
  text_ += '\n';
  return std::move(text_);
}

} // namespace dermis
