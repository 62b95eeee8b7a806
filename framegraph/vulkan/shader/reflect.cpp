#include "framegraph/vulkan/shader/reflect.hpp"

#include "framegraph/vulkan/shader/spirv.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/core.h>

namespace dermis::vulkan {
namespace {

using namespace spirv;

// Holds everything known of one result id. Which fields are used depends on the instruction.
struct Id {
  uint32_t op = 0;
  std::string name;
  std::array<uint32_t, 3> operands{}; // of types and constants; meaning depends on the instruction
  Numeric numeric = Numeric::none;
  uint32_t image_format = 0, image_sampled = 0;
  uint64_t bytes = 0; // size of a type
  bool scalar32 = false;
  std::vector<uint32_t> members;        // struct
  std::vector<uint32_t> member_offsets; // by decoration
  std::vector<uint32_t> matrix_strides;
  std::vector<std::string> member_names;
  uint32_t array_stride = 0, set = 0, binding = 0, spec_id = 0;
  bool has_spec_id = false, has_set = false, has_binding = false, buffer_block = false,
       workgroup_size = false;
  bool coherent = false; // of a variable, or of a member of a struct
};

struct Module {
  std::vector<Id> ids;
  std::vector<uint32_t> variables; // ids
  std::vector<uint32_t> constants; // ids of specialisation constants
  bool has_entry = false;
  uint32_t entry = 0;
  std::array<uint32_t, 3> local_size{1, 1, 1};
  std::array<uint32_t, 3> local_size_ids{}; // 0: not given by id
  std::string error;
};

constexpr uint64_t boolean_bytes = 4; // of a specialisation constant: VkBool32
constexpr size_t max_members = 4096;  // of a block; limits the cost of hostile member numbers

// Holds the operands of one instruction. Reading past the end returns 0 and sets `cut`.
struct Operands {
  std::span<const uint32_t> words;
  bool cut = false;

  uint32_t at(size_t i) {
    if (i < words.size()) return words[i];
    cut = true;
    return 0;
  }
  std::string text(size_t first) const {
    std::string result;
    for (size_t i = first; i < words.size(); ++i)
      for (uint32_t shift = 0; shift < 32; shift += 8) {
        const char c = static_cast<char>((words[i] >> shift) & 0xff);
        if (c == '\0') return result;
        result += c;
      }
    return result;
  }
};

template <class T> T& member_slot(std::vector<T>& list, size_t index) {
  if (list.size() <= index) list.resize(index + 1);
  return list[index];
}

class Reader {
public:
  explicit Reader(std::span<const uint32_t> words) : words_(words) {}

  bool read() {
    if (words_.size() < header_words || words_[0] != magic)
      return fail("it is not SPIR-V in this machine's byte order");
    const uint32_t bound = words_[3];
    if (bound == 0 || bound > max_id_bound)
      return fail(fmt::format("its id bound {} is out of range", bound));
    module.ids.resize(bound);
    for (size_t at = header_words; at < words_.size();) {
      const uint32_t count = words_[at] >> 16, op = words_[at] & 0xffff;
      if (count == 0 || count > words_.size() - at)
        return fail(fmt::format("it is truncated at word {}", at));
      if (op == op_function) break; // declarations end here
      Operands operands{words_.subspan(at + 1, count - 1)};
      instruction(op, operands);
      if (operands.cut) return fail(fmt::format("instruction {} at word {} is too short", op, at));
      if (!module.error.empty()) return false;
      at += count;
    }
    if (!module.has_entry) return fail("it has no compute entry point \"main\"");
    return true;
  }

  Module module;

private:
  bool fail(std::string text) {
    if (module.error.empty()) module.error = std::move(text);
    return false;
  }

  Id& id(uint32_t number) {
    if (number != 0 && number < module.ids.size()) return module.ids[number];
    fail(fmt::format("id {} is out of bounds", number));
    return module.ids[0];
  }

  void instruction(uint32_t op, Operands& o) {
    switch (op) {
    case op_name:
      id(o.at(0)).name = o.text(1);
      break;
    case op_member_name:
      if (o.at(1) < max_members) member_slot(id(o.at(0)).member_names, o.at(1)) = o.text(2);
      break;
    case op_entry_point:
      if (o.at(0) == execution_model_glcompute && o.text(2) == "main") {
        module.has_entry = true;
        module.entry = o.at(1);
      }
      break;
    case op_execution_mode:
      if (o.at(0) == module.entry && o.at(1) == mode_local_size)
        module.local_size = {o.at(2), o.at(3), o.at(4)};
      break;
    case op_execution_mode_id:
      if (o.at(0) == module.entry && o.at(1) == mode_local_size_id)
        module.local_size_ids = {o.at(2), o.at(3), o.at(4)};
      break;
    case op_decorate:
      decorate(o);
      break;
    case op_member_decorate:
      if (o.at(1) >= max_members) break;
      if (o.at(2) == decoration_offset) member_slot(id(o.at(0)).member_offsets, o.at(1)) = o.at(3);
      if (o.at(2) == decoration_matrix_stride)
        member_slot(id(o.at(0)).matrix_strides, o.at(1)) = o.at(3);
      if (o.at(2) == decoration_coherent) id(o.at(0)).coherent = true;
      break;
    case op_constant:
    case op_spec_constant:
      id(o.at(1)).operands[0] = o.at(2);
      specialisation_constant(op, o);
      break;
    case op_spec_constant_true:
    case op_spec_constant_false:
      specialisation_constant(op, o);
      break;
    case op_constant_composite:
    case op_spec_constant_composite:
      if (id(o.at(1)).workgroup_size) module.local_size_ids = {o.at(2), o.at(3), o.at(4)};
      break;
    case op_variable: {
      Id& variable = id(o.at(1));
      variable.op = op;
      variable.operands = {o.at(0), o.at(2), 0};
      module.variables.push_back(o.at(1));
      break;
    }
    default:
      type(op, o);
    }
  }

  // Types and decorations come before the constant.
  void specialisation_constant(uint32_t op, Operands& o) {
    Id& constant = id(o.at(1));
    if (op == op_constant || !constant.has_spec_id) return;
    const Id& type = id(o.at(0));
    constant.numeric = type.numeric;
    constant.bytes = type.numeric == Numeric::none ? boolean_bytes : type.bytes;
    module.constants.push_back(o.at(1));
  }

  void decorate(Operands& o) {
    Id& target = id(o.at(0));
    switch (o.at(1)) {
    case decoration_spec_id:
      target.spec_id = o.at(2);
      target.has_spec_id = true;
      break;
    case decoration_buffer_block:
      target.buffer_block = true;
      break;
    case decoration_coherent:
      target.coherent = true;
      break;
    case decoration_array_stride:
      target.array_stride = o.at(2);
      break;
    case decoration_built_in:
      target.workgroup_size = o.at(2) == built_in_workgroup_size;
      break;
    case decoration_binding:
      target.binding = o.at(2);
      target.has_binding = true;
      break;
    case decoration_descriptor_set:
      target.set = o.at(2);
      target.has_set = true;
      break;
    default:
      break;
    }
  }

  // Types are declared before use, so operand sizes are already known.
  void type(uint32_t op, Operands& o) {
    switch (op) {
    case op_type_int:
    case op_type_float: {
      Id& t = id(o.at(0));
      t.op = op;
      t.numeric = op == op_type_float ? Numeric::real
                  : o.at(2) != 0      ? Numeric::signed_integer
                                      : Numeric::unsigned_integer;
      t.bytes = o.at(1) / 8;
      t.scalar32 = o.at(1) == 32;
      break;
    }
    case op_type_vector:
    case op_type_matrix: {
      Id& t = id(o.at(0));
      t.op = op;
      t.bytes = id(o.at(1)).bytes * o.at(2);
      t.operands = {o.at(1), o.at(2), 0};
      break;
    }
    case op_type_image: {
      Id& t = id(o.at(0));
      t.op = op;
      t.numeric = id(o.at(1)).numeric;
      t.image_sampled = o.at(6);
      t.image_format = o.at(7);
      break;
    }
    case op_type_sampler:
    case op_type_sampled_image:
    case op_type_acceleration_structure:
      id(o.at(0)).op = op;
      break;
    case op_type_array: {
      Id& t = id(o.at(0));
      t.op = op;
      t.bytes = uint64_t{t.array_stride} * id(o.at(2)).operands[0];
      break;
    }
    case op_type_runtime_array:
      id(o.at(0)).op = op;
      break;
    case op_type_struct: {
      Id& t = id(o.at(0));
      t.op = op;
      if (o.words.empty()) break;
      t.members.assign(o.words.begin() + 1, o.words.end());
      t.member_offsets.resize(t.members.size());
      t.member_names.resize(t.members.size());
      t.matrix_strides.resize(t.members.size());
      for (size_t i = 0; i < t.members.size(); ++i) {
        const Id& member = id(t.members[i]);
        // A column-major matrix has one stride per column.
        const uint64_t bytes = member.op == op_type_matrix
                                   ? uint64_t{t.matrix_strides[i]} * member.operands[1]
                                   : member.bytes;
        t.bytes = std::max(t.bytes, t.member_offsets[i] + bytes);
      }
      break;
    }
    case op_type_pointer: {
      Id& t = id(o.at(0));
      t.op = op;
      t.operands = {o.at(1), o.at(2), 0};
      break;
    }
    default:
      break;
    }
  }

  std::span<const uint32_t> words_;
};

BindingType binding_type(const Id& type, uint32_t storage_class) {
  constexpr uint32_t sampled_yes = 1, sampled_no = 2; // operand Sampled of OpTypeImage
  if (storage_class == storage_storage_buffer) return BindingType::storage_buffer;
  if (storage_class == storage_uniform)
    return type.buffer_block ? BindingType::storage_buffer : BindingType::uniform_buffer;
  switch (type.op) {
  case op_type_image:
    return type.image_sampled == sampled_yes  ? BindingType::sampled_image
           : type.image_sampled == sampled_no ? BindingType::storage_image
                                              : BindingType::other;
  case op_type_sampler:
    return BindingType::sampler;
  case op_type_sampled_image:
    return BindingType::combined_image;
  case op_type_acceleration_structure:
    return BindingType::acceleration_structure;
  default:
    return BindingType::other;
  }
}

} // namespace

std::optional<Reflection> reflect(std::span<const uint32_t> spirv, std::string& error) {
  Reader reader(spirv);
  const bool read = reader.read();
  const Module& module = reader.module;
  if (!read) {
    error = module.error;
    return std::nullopt;
  }
  const auto known = [&](uint32_t number) -> const Id& {
    return module.ids[number < module.ids.size() ? number : 0];
  };
  Reflection result;
  result.local_size = module.local_size;
  for (size_t axis = 0; axis < 3; ++axis)
    if (module.local_size_ids[axis] != 0)
      result.local_size[axis] = known(module.local_size_ids[axis]).operands[0];
  for (const uint32_t number : module.constants) {
    const Id& constant = known(number);
    result.constants.push_back({constant.spec_id, constant.numeric, constant.bytes, constant.name});
  }
  std::ranges::stable_sort(result.constants, {}, &SpecialisationConstant::id);
  for (const uint32_t number : module.variables) {
    const Id& variable = known(number);
    const Id& pointer = known(variable.operands[0]);
    const uint32_t storage_class = variable.operands[1];
    const Id* type = &known(pointer.operands[1]);
    if (storage_class == storage_push_constant) {
      result.has_push_constants = true;
      for (size_t i = 0; i < type->members.size(); ++i) {
        const Id& member = known(type->members[i]);
        result.push_members.push_back({type->member_offsets[i],
                                       member.scalar32 ? member.numeric : Numeric::none,
                                       type->member_names[i]});
      }
    }
    if (!variable.has_set || !variable.has_binding) continue;
    ShaderBinding binding;
    binding.set = variable.set;
    binding.binding = variable.binding;
    binding.array = type->op == op_type_array || type->op == op_type_runtime_array;
    binding.type = binding_type(*type, storage_class);
    binding.numeric = type->numeric;
    binding.image_format = type->image_format;
    binding.bytes = type->bytes;
    binding.coherent = variable.coherent || type->coherent;
    binding.name = variable.name.empty() ? type->name : variable.name;
    result.bindings.push_back(std::move(binding));
  }
  std::stable_sort(result.bindings.begin(), result.bindings.end(),
                   [](const auto& a, const auto& b) {
                     return a.set != b.set ? a.set < b.set : a.binding < b.binding;
                   });
  return result;
}

const char* binding_type_name(BindingType type) {
  switch (type) {
  case BindingType::sampled_image:
    return "texture";
  case BindingType::storage_image:
    return "image";
  case BindingType::combined_image:
    return "combined texture and sampler";
  case BindingType::sampler:
    return "sampler";
  case BindingType::uniform_buffer:
    return "uniform block";
  case BindingType::storage_buffer:
    return "buffer block";
  case BindingType::acceleration_structure:
    return "acceleration structure";
  case BindingType::other:
    break;
  }
  return "something else";
}

const char* numeric_name(Numeric numeric) {
  switch (numeric) {
  case Numeric::real:
    return "float";
  case Numeric::signed_integer:
    return "int";
  case Numeric::unsigned_integer:
    return "uint";
  case Numeric::none:
    break;
  }
  return "not a 32-bit scalar";
}

} // namespace dermis::vulkan
