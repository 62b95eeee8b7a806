#pragma once
// Image files as textures.

#include "integration/examples/demo_engine/render/scene_gpu.hpp"

#include <span>
#include <string>

namespace demo {

// Maximum side of a map in texels.
inline constexpr int max_texels_per_side = 8192;

// Returns an image file in any allowed format of stb_image, as RGBA. Errors: input (unreadable, not
// an image, too large).
Result<Texture> load_texture(const std::string& path);
// Decodes an image file in memory; `name` is for messages.
Result<Texture> decode_texture(const std::string& name, std::span<const std::byte> bytes);

// Flips the rows: maps in separate files count v upwards, as drawing programs do, while glTF counts
// v downwards.
void flip_rows(Texture& texture);

} // namespace demo
