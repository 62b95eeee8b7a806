#pragma once
// Scene files: docs/scenes.md describes the format. Strict: every key is known, typed and in range.

#include "framegraph/text/diagnostic.hpp"
#include "integration/examples/demo_engine/scene/scene.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace demo {

// Profile files are looked for beside the scene file, as it names them, below its home (dermis::home_of) or
// one of `roots`. All problems of the file are reported in one run, with their places. Any thread.
std::optional<Scene> read_scene(const std::string& path, dermis::Diagnostics& diagnostics,
                                std::span<const std::string> roots = {});

// The same for a text; `name` stands for its path.
std::optional<Scene> parse_scene(const std::string& name, std::string text, dermis::Diagnostics& diagnostics,
                                 std::span<const std::string> roots = {});

} // namespace demo
