#pragma once
// Writing what a verb made: whole or not at all.

#include <string>
#include <string_view>

namespace dermis::tools {

// Writes `text` to the file `path`, whole or not at all, or for "-" to standard output. Returns what went
// wrong, "" for nothing.
std::string deliver_text(const std::string& path, std::string_view text);
// The same for a page, whose folder is made where there is none.
std::string deliver_page(const std::string& path, std::string_view text);

// A folder that pictures are written to. Made if it is not there; removed again at the end if it was made
// here and is still empty, so that a verb that failed leaves nothing behind.
class OutputFolder {
public:
  OutputFolder() = default;
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Makes the folder and tries to write there. Returns what went wrong, "" for nothing.
  std::string open(const std::string& path);
  // Makes a folder below. The same answer.
  std::string open_below(const std::string& name);
  std::string path_of(std::string_view name) const;

private:
  std::string path_;
  std::string first_made_; // outermost folder that was made here; "" for none
};

} // namespace dermis::tools
