#pragma once
// Lists the SPIR-V 1.6 constants that reflect.cpp and swiftshader.cpp need (SPIR-V
// specification, section 3).

#include <cstdint>

namespace dermis::vulkan::spirv {

inline constexpr uint32_t magic = 0x07230203;
inline constexpr uint32_t header_words = 5;
// a quarter of the universal limit; kernels have a few thousand ids
inline constexpr uint32_t max_id_bound = 1u << 20;

enum Op : uint32_t {
  op_name = 5,
  op_member_name = 6,
  op_entry_point = 15,
  op_execution_mode = 16,
  op_type_int = 21,
  op_type_float = 22,
  op_type_vector = 23,
  op_type_matrix = 24,
  op_type_image = 25,
  op_type_sampler = 26,
  op_type_sampled_image = 27,
  op_type_array = 28,
  op_type_runtime_array = 29,
  op_type_struct = 30,
  op_type_pointer = 32,
  op_constant = 43,
  op_constant_composite = 44,
  op_spec_constant_true = 48,
  op_spec_constant_false = 49,
  op_spec_constant = 50,
  op_spec_constant_composite = 51,
  op_spec_constant_op = 52,
  op_function = 54,
  op_variable = 59,
  op_decorate = 71,
  op_member_decorate = 72,
  op_logical_not = 168,
  op_phi = 245,
  op_loop_merge = 246,
  op_selection_merge = 247,
  op_label = 248,
  op_branch = 249,
  op_branch_conditional = 250,
  op_execution_mode_id = 331,
  op_type_acceleration_structure = 5341 // SPV_KHR_ray_query
};

enum Decoration : uint32_t {
  decoration_spec_id = 1,
  decoration_block = 2,
  decoration_buffer_block = 3,
  decoration_array_stride = 6,
  decoration_matrix_stride = 7,
  decoration_built_in = 11,
  decoration_coherent = 23,
  decoration_binding = 33,
  decoration_descriptor_set = 34,
  decoration_offset = 35
};

enum StorageClass : uint32_t {
  storage_uniform_constant = 0,
  storage_uniform = 2,
  storage_push_constant = 9,
  storage_storage_buffer = 12
};

inline constexpr uint32_t execution_model_glcompute = 5;
inline constexpr uint32_t mode_local_size = 17;
inline constexpr uint32_t mode_local_size_id = 38;
inline constexpr uint32_t built_in_workgroup_size = 25;

} // namespace dermis::vulkan::spirv
