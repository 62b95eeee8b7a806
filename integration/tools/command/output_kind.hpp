#pragma once
// The files that each verb writes: their names, and how to recognise a file of an earlier run.

#include <set>
#include <string>
#include <string_view>

namespace dermis::tools {

// Returns the usage error if the verb's option --`option` names a folder in place of a file, or if
// the verb would replace a file that it does not write; else "". `verb`: its words, such as "bench
// all"; "schema NAME" writes one file, "bench all SUITE.json" and ".html" those of one suite.
std::string check_output(std::string_view verb, std::string_view option, const std::string& path);
// Same for a file of CSV rows, whose first column has this key.
std::string check_csv(std::string_view option, const std::string& path,
                      std::string_view first_column);

// Returns whether the verb writes a file of this name (a path relative to the folder) into the
// folder of its option --out.
bool is_name_of_output(std::string_view verb, std::string_view name);

// Returns a warning if the folder of the verb's option --out has files of an earlier run next to
// those of this run; else "". `written`: names of this run's files, relative to the folder.
std::string earlier_outputs(std::string_view verb, const std::string& folder,
                            const std::set<std::string>& written);

} // namespace dermis::tools
