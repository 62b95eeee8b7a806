#pragma once
// Holds the formats that a resource declares, in order of preference. Stored inline, because
// compiling reads the list of every resource.

#include "framegraph/model/vocabulary.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>

namespace dermis {

class FormatList {
public:
  FormatList() = default;
  FormatList(std::initializer_list<Format> formats) {
    for (const Format format : formats)
      push_back(format);
  }

  // Appends the format. A format that is already listed keeps its position.
  void push_back(Format format) {
    if (std::find(begin(), end(), format) == end()) formats_[count_++] = format;
  }
  void clear() { count_ = 0; }

  const Format* begin() const { return formats_.data(); }
  const Format* end() const { return formats_.data() + count_; }
  size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  Format front() const { return formats_.front(); }
  bool operator==(const FormatList& other) const {
    return std::equal(begin(), end(), other.begin(), other.end());
  }

private:
  std::array<Format, static_cast<size_t>(Format::count)> formats_{};
  uint8_t count_ = 0;
};

} // namespace dermis
