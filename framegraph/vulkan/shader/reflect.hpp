#pragma once
// Reads from a SPIR-V compute module what it binds, pushes and how big its workgroups are. Input is not
// trusted: every word read is checked against the end of the module.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::vulkan {

enum class BindingType : uint8_t {
  sampled_image,  // texture2D
  storage_image,  // image2D
  combined_image, // sampler2D
  sampler,
  uniform_buffer,
  storage_buffer,
  acceleration_structure, // accelerationStructureEXT
  other
};
enum class Numeric : uint8_t { none, real, signed_integer, unsigned_integer };

struct ShaderBinding {
  uint32_t set = 0, binding = 0;
  BindingType type = BindingType::other;
  Numeric numeric = Numeric::none; // images: what a texel reads as
  uint32_t image_format = 0;       // storage images: SPIR-V Image Format; 0: without format
  bool array = false;              // an array of descriptors
  uint64_t bytes = 0;              // buffers: size of the block, a run-time array counted as empty
  std::string name;                // of the variable, or of its block
};

struct PushMember {
  uint32_t offset = 0;
  Numeric numeric = Numeric::none; // of a 32-bit scalar; none: anything else
  std::string name;
};

struct Reflection {
  std::vector<ShaderBinding> bindings; // by set and binding
  bool has_push_constants = false;
  std::vector<PushMember> push_members; // in the order of the block
  std::array<uint32_t, 3> local_size{1, 1, 1};
};

// nullopt with `error` saying what is wrong: not SPIR-V, cut off, without a compute entry point "main".
// Free-threaded.
std::optional<Reflection> reflect(std::span<const uint32_t> spirv, std::string& error);

const char* binding_type_name(BindingType type); // as written in GLSL; static string
const char* numeric_name(Numeric numeric);       // static string

} // namespace dermis::vulkan
