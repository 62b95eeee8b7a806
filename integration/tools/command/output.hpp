#pragma once
// Writes a verb's output atomically.

#include <string>
#include <string_view>

namespace dermis::tools {

// Writes `text` atomically to the file `path`, or to standard output for "-". Returns the problem,
// or "".
std::string deliver_text(const std::string& path, std::string_view text);
// As deliver_text; creates the page's folder if necessary.
std::string deliver_page(const std::string& path, std::string_view text);

// A folder for output images, created if necessary. The destructor removes a folder that was
// created here and is still empty, so that a failed verb leaves no folder.
class OutputFolder {
public:
  OutputFolder() = default;
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  // Creates the folder and checks that it is writable. Returns the problem, or "".
  std::string open(const std::string& path);
  // Creates the folder of a file and checks that it is writable, before minutes are spent on what
  // the file is to hold. Standard output ("-"), devices and pipes need no folder. Returns the
  // problem, or "".
  std::string open_for(const std::string& file);
  // Creates a subfolder. Returns the problem, or "".
  std::string open_below(const std::string& name);
  std::string path_of(std::string_view name) const;
  // Removes a file that an earlier run wrote and this run does not; does nothing if there is none.
  void remove(std::string_view name) const;

private:
  std::string path_;
  std::string first_made_; // outermost folder created here; "" if none
};

} // namespace dermis::tools
