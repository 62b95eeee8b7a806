#pragma once
// Resolves the path of an edit: "/passes/scatter/set/samples". Steps follow JSON pointers (RFC
// 6901), except in arrays: a pass is identified by its name, a string by its text, and anything
// else by its index from 0.

#include "framegraph/compose/tree.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dermis {

// Returns the steps, unescaped; empty if `path` does not begin with '/'.
std::vector<std::string> split_path(std::string_view path);

// Returns the position of the child of an array or object that one step of a path leads to, or -1.
int find_step(const EditTree& tree, ItemId parent, std::string_view step);

// Returns the valid steps into `parent`, for suggestions.
std::vector<std::string_view> steps_into(const EditTree& tree, ItemId parent);

// Returns the position of a pass in a list of passes; -1 if no pass has that name.
int find_pass(const EditTree& tree, ItemId passes, std::string_view name);

// Returns the names of the resources that a pass writes.
std::vector<std::string> written_by(const EditTree& tree, ItemId pass);

// Returns the names of the resources that a pass writes because of `item`, to which a path with
// these steps leads: a pass, its "write", or one port of that.
std::vector<std::string> written_at(const EditTree& tree, const std::vector<std::string>& steps,
                                    ItemId item);

} // namespace dermis
