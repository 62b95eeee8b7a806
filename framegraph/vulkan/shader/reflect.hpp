#pragma once
// Reads the bindings, constants and workgroup size of a SPIR-V compute module. The input is
// untrusted: every word read is checked against the end of the module.

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
  Numeric numeric = Numeric::none; // images: component type of a texel read
  uint32_t image_format = 0;       // storage images: SPIR-V Image Format; 0: without format
  bool array = false;              // array of descriptors
  bool coherent = false;           // writes are made visible to other workgroups
  // buffers: size of the block, without a run-time array at its end
  uint64_t bytes = 0;
  std::string name; // name of the variable or of its block
};

struct PushMember {
  uint32_t offset = 0;
  Numeric numeric = Numeric::none; // none: not a 32-bit scalar
  std::string name;
};

struct SpecialisationConstant {
  uint32_t id = 0;                 // constant_id
  Numeric numeric = Numeric::none; // none: a boolean
  uint64_t bytes = 4;              // size of a value for it
  std::string name;
};

struct Reflection {
  std::vector<ShaderBinding> bindings; // by set and binding
  bool has_push_constants = false;
  std::vector<PushMember> push_members;          // in block order
  std::vector<SpecialisationConstant> constants; // by id
  std::array<uint32_t, 3> local_size{1, 1, 1};
};

// Returns the reflection, or nullopt with `error` set: not SPIR-V, cut off, or without a compute
// entry point "main". Free-threaded.
std::optional<Reflection> reflect(std::span<const uint32_t> spirv, std::string& error);

const char* binding_type_name(BindingType type); // GLSL spelling; static string
const char* numeric_name(Numeric numeric);       // static string

} // namespace dermis::vulkan
