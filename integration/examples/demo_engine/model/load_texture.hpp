#pragma once
// Image files as textures.

#include "integration/examples/demo_engine/render/scene_gpu.hpp"

#include <span>
#include <string>

namespace demo {

// Largest side of a map, in texels.
inline constexpr int max_texels_per_side = 8192;

// Whatever stb_image reads, as RGBA. Errors: input (unreadable, not an image, too large).
Result<Texture> load_texture(const std::string& path);
// The same for an image file in memory; `name` is for messages.
Result<Texture> decode_texture(const std::string& name, std::span<const std::byte> bytes);

// Turns the rows upside down: maps that come beside a model count v upwards, as drawing programs do, while
// glTF counts it downwards.
void flip_rows(Texture& texture);

} // namespace demo
