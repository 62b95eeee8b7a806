#pragma once
// The formats that a resource declares, in order of preference. Held in place, without memory of its own:
// compiling looks at the list of every resource.

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

  // A format that is there already keeps its place.
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
