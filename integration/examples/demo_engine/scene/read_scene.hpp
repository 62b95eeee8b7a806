#pragma once
// Reads scene files; docs/scenes.md describes the format. Strict: every key is known, typed and in
// range.

#include "framegraph/text/diagnostic.hpp"
#include "integration/examples/demo_engine/scene/scene.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace demo {

// Reads a scene. Profile files are searched next to the scene file, below its home
// (dermis::home_of) or one of `roots`. All problems of the file are reported in one run, with their
// places. Thread: any.
std::optional<Scene> read_scene(const std::string& path, dermis::Diagnostics& diagnostics,
                                std::span<const std::string> roots = {});

// Reads a scene from a text; `name` takes the role of the path.
std::optional<Scene> parse_scene(const std::string& name, std::string text,
                                 dermis::Diagnostics& diagnostics,
                                 std::span<const std::string> roots = {});

} // namespace demo
