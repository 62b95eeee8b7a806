#pragma once
// Where an edit applies: "/passes/scatter/set/samples". Steps are those of a JSON pointer (RFC 6901), but in
// an array a pass goes by its name, a string by its text and anything else by its index from 0.

#include "framegraph/compose/tree.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dermis {

// Steps unescaped; empty when `path` does not begin with '/'.
std::vector<std::string> split_path(std::string_view path);

// A child of an array or object by one step of a path: its position among the children, or -1.
int find_step(const EditTree& tree, ItemId parent, std::string_view step);

// What a step into `parent` may be, for suggestions.
std::vector<std::string_view> steps_into(const EditTree& tree, ItemId parent);

// Position of a pass in a list of passes; -1 when there is none of that name.
int find_pass(const EditTree& tree, ItemId passes, std::string_view name);

} // namespace dermis
