#include "framegraph/vulkan/shader/signature_check.hpp"

#include <fmt/core.h>

namespace dermis::vulkan {
namespace {

struct Checker {
  const PassType& type;
  std::vector<std::string> found;

  template <class... Arguments>
  void mismatch(fmt::format_string<Arguments...> text, Arguments&&... arguments) {
    found.push_back(fmt::format("kernel '{}' of type '{}': ", type.shader, type.name) +
                    fmt::format(text, std::forward<Arguments>(arguments)...));
  }

  void check_type(const ShaderBinding& binding, const std::string& place, BindingType expected) {
    if (binding.array)
      mismatch("{} is an array of descriptors in the shader ('{}'), but the signature binds one "
               "descriptor",
               place, binding.name);
    else if (binding.type != expected)
      mismatch("{} is a {} in the signature and a {} ('{}') in the shader", place,
               binding_type_name(expected), binding_type_name(binding.type), binding.name);
  }

  void check_port(const ShaderBinding& binding) {
    if (binding.binding >= type.ports.size())
      return mismatch(
          "the shader has '{}' at set 0 binding {}, but the signature has only {} ports",
          binding.name, binding.binding, type.ports.size());
    const Port& port = type.ports[binding.binding];
    const std::string place =
        fmt::format("port '{}' (set 0 binding {})", port.name, binding.binding);
    const auto descriptor = descriptor_type(port.usage);
    if (!descriptor)
      return mismatch(
          "{} has usage {} and therefore no descriptor, but the shader binds '{}' there", place,
          usage_info(port.usage).name, binding.name);
    const BindingType expected =
        *descriptor == VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE   ? BindingType::sampled_image
        : *descriptor == VK_DESCRIPTOR_TYPE_STORAGE_IMAGE ? BindingType::storage_image
        : *descriptor == VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR
            ? BindingType::acceleration_structure
            : BindingType::storage_buffer;
    check_type(binding, place, expected);
    if (port.internally_ordered && !binding.coherent)
      mismatch("{} is internally ordered in the signature, but '{}' is not coherent in the shader",
               place, binding.name);
    if (expected == BindingType::storage_buffer ||
        expected == BindingType::acceleration_structure || binding.type != expected ||
        port.glsl_type.empty())
      return;
    const char first = port.glsl_type.front(); // utexture2D, itexture2D, texture2D
    const Numeric numeric = first == 'u'                          ? Numeric::unsigned_integer
                            : port.glsl_type.substr(0, 2) == "im" ? Numeric::real
                            : first == 'i'                        ? Numeric::signed_integer
                                                                  : Numeric::real;
    if (numeric != binding.numeric)
      mismatch("{} reads as {} because of its type {}, but as {} in the shader", place,
               numeric_name(numeric), port.glsl_type, numeric_name(binding.numeric));
  }

  void check_environment(const ShaderBinding& binding,
                         std::span<const EnvironmentBinding> environment) {
    if (binding.binding >= environment.size())
      return mismatch(
          "the shader has '{}' at set 1 binding {}, but the environment has only {} bindings",
          binding.name, binding.binding, environment.size());
    const EnvironmentBinding& given = environment[binding.binding];
    const std::string place = fmt::format("environment binding {}", binding.binding);
    check_type(binding, place,
               given.type == EnvironmentType::uniform_buffer   ? BindingType::uniform_buffer
               : given.type == EnvironmentType::linear_sampler ? BindingType::sampler
                                                               : BindingType::storage_buffer);
    if (given.type != EnvironmentType::linear_sampler && binding.bytes > given.bytes)
      mismatch("{} has {} bytes, but '{}' in the shader needs {}", place, given.bytes, binding.name,
               binding.bytes);
  }

  // A kernel need not declare constants that it does not use.
  void check_constant(const SpecialisationConstant& constant) {
    if (constant.id == constant_id::bound_ports || constant.id == constant_id::changing_ports) {
      if (!has_type(constant, false) || constant.numeric == Numeric::signed_integer)
        mismatch("constant {} is a mask of ports, but '{}' is {} in the shader; expected uint",
                 constant.id, constant.name, constant_type(constant));
      return;
    }
    if (constant.id < constant_id::first_setting) return;
    const uint32_t index = constant.id - constant_id::first_setting;
    if (index >= type.settings.size())
      return mismatch("the shader has the constant '{}' with id {}, but the signature has only {} "
                      "settings, from id {} on",
                      constant.name, constant.id, type.settings.size(), constant_id::first_setting);
    const PassTypeSetting& setting = type.settings[index];
    const bool boolean = setting.type == SettingType::boolean;
    if (!is_constant(setting))
      mismatch("setting '{}' is a push constant, but '{}' is a specialisation constant in the "
               "shader",
               setting.name, constant.name);
    else if (!has_type(constant, boolean))
      mismatch("setting '{}' is {} in the signature, but '{}' is {} in the shader", setting.name,
               boolean ? "bool, int or uint" : "int or uint", constant.name,
               constant_type(constant));
  }

  // Returns whether the constant is an integer of 32 bits, or, if allowed, a boolean.
  static bool has_type(const SpecialisationConstant& constant, bool boolean_allowed) {
    const bool integer = constant.numeric == Numeric::signed_integer ||
                         constant.numeric == Numeric::unsigned_integer;
    return integer ? constant.bytes == sizeof(uint32_t)
                   : boolean_allowed && constant.numeric == Numeric::none;
  }

  static std::string constant_type(const SpecialisationConstant& constant) {
    if (constant.numeric == Numeric::none) return "bool";
    return constant.bytes == sizeof(uint32_t)
               ? numeric_name(constant.numeric)
               : fmt::format("{} with {} bytes", numeric_name(constant.numeric), constant.bytes);
  }

  void check_push_constants(const Reflection& reflection) {
    const auto& members = reflection.push_members;
    std::vector<const PassTypeSetting*> settings;
    for (const PassTypeSetting& setting : type.settings)
      if (!is_constant(setting)) settings.push_back(&setting);
    if (!reflection.has_push_constants) {
      if (!settings.empty())
        mismatch("the shader has no push constants, but the signature has {} settings that are",
                 settings.size());
      return;
    }
    if (members.size() != 1 + settings.size())
      return mismatch("the shader has {} push constants, but the signature has the port mask and "
                      "{} settings that are push constants",
                      members.size(), settings.size());
    for (size_t i = 0; i < members.size(); ++i) {
      const std::string name =
          i == 0 ? "port mask" : fmt::format("setting '{}'", settings[i - 1]->name);
      if (members[i].offset != 4 * i)
        mismatch("{} is at byte {} of the push constants, but '{}' of the shader is at byte {}",
                 name, 4 * i, members[i].name, members[i].offset);
      const bool real = i > 0 && settings[i - 1]->type == SettingType::real;
      const bool fits = real ? members[i].numeric == Numeric::real
                             : members[i].numeric == Numeric::signed_integer ||
                                   members[i].numeric == Numeric::unsigned_integer;
      if (!fits)
        mismatch("{} is {} in the signature, but '{}' is {} in the shader", name,
                 real ? "float" : "int or uint", members[i].name, numeric_name(members[i].numeric));
    }
  }

  void check_local_size(const std::array<uint32_t, 3>& size) {
    const uint64_t invocations = uint64_t{size[0]} * size[1] * size[2];
    const DispatchRule& rule = type.dispatch;
    const uint32_t side = rule.cell_side;
    const auto reject = [&](const std::string& needed) {
      mismatch("its workgroup is {}x{}x{}, but this dispatch needs {}", size[0], size[1], size[2],
               needed);
    };
    if (!rule.is_kernel() || rule.domain == DispatchRule::Domain::one) return;
    if (rule.cell_shaped()) {
      if (size[0] != side || size[1] != side || size[2] != 1)
        reject(fmt::format("{}x{}x1", side, side));
    } else if (invocations != rule.invocations) {
      reject(fmt::format("{} invocations", rule.invocations));
    }
  }
};

} // namespace

std::optional<VkDescriptorType> descriptor_type(Usage usage) {
  switch (usage) {
  case Usage::sampled_image:
    return VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
  case Usage::storage_image_write:
  case Usage::storage_image_update:
    return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
  case Usage::storage_buffer_read:
  case Usage::storage_buffer_write:
  case Usage::storage_buffer_update:
    return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  case Usage::acceleration_structure:
    return VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR;
  case Usage::indirect_arguments:
  case Usage::clear:
  case Usage::count:
    break;
  }
  return std::nullopt;
}

VkDescriptorType descriptor_type(EnvironmentType type) {
  switch (type) {
  case EnvironmentType::storage_buffer:
  case EnvironmentType::counters:
    return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  case EnvironmentType::linear_sampler:
    return VK_DESCRIPTOR_TYPE_SAMPLER;
  case EnvironmentType::uniform_buffer:
    break;
  }
  return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
}

std::vector<std::string> check_signature(const PassType& type,
                                         std::span<const EnvironmentBinding> environment,
                                         const Reflection& reflection) {
  Checker checker{type, {}};
  for (const ShaderBinding& binding : reflection.bindings) {
    if (binding.set == 0)
      checker.check_port(binding);
    else if (binding.set == 1)
      checker.check_environment(binding, environment);
    else
      checker.mismatch(
          "the shader has '{}' at set {}, but only sets 0 (ports) and 1 (environment) exist",
          binding.name, binding.set);
  }
  for (const SpecialisationConstant& constant : reflection.constants)
    checker.check_constant(constant);
  checker.check_push_constants(reflection);
  checker.check_local_size(reflection.local_size);
  return std::move(checker.found);
}

} // namespace dermis::vulkan
