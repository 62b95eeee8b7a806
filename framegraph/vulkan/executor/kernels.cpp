// Creates kernels and pipelines for the plan's passes. Layouts follow the signature and are checked
// against the kernel's SPIR-V.
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"
#include "framegraph/vulkan/kernel_store.hpp"
#include "framegraph/vulkan/shader/signature_check.hpp"
#include "framegraph/vulkan/shader/swiftshader.hpp"

#include <algorithm>
#include <bit>
#include <fmt/format.h>

namespace dermis::vulkan {
namespace {

// Returns the placeholder format of an unbound port: the format that the port or shader declares,
// else any format with the same numeric type. Some drivers recompile a kernel for another format.
VkFormat placeholder_format(const Port& port, const ShaderBinding& binding) {
  if (port.usage == Usage::sampled_image && !port.formats.empty() &&
      !format_info(port.formats.front()).depth)
    return vk_format(port.formats.front());
  // values of SPIR-V specification, 3.11 Image Format
  switch (binding.image_format) {
  case 1:
    return VK_FORMAT_R32G32B32A32_SFLOAT;
  case 2:
    return VK_FORMAT_R16G16B16A16_SFLOAT;
  case 3:
    return VK_FORMAT_R32_SFLOAT;
  case 4:
    return VK_FORMAT_R8G8B8A8_UNORM;
  case 6:
    return VK_FORMAT_R32G32_SFLOAT;
  case 7:
    return VK_FORMAT_R16G16_SFLOAT;
  case 8:
    return VK_FORMAT_B10G11R11_UFLOAT_PACK32;
  case 9:
    return VK_FORMAT_R16_SFLOAT;
  case 13:
    return VK_FORMAT_R8G8_UNORM;
  case 15:
    return VK_FORMAT_R8_UNORM;
  case 30:
    return VK_FORMAT_R32G32B32A32_UINT;
  case 33:
    return VK_FORMAT_R32_UINT;
  case 35:
    return VK_FORMAT_R32G32_UINT;
  case 38:
    return VK_FORMAT_R16_UINT;
  case 39:
    return VK_FORMAT_R8_UINT;
  default:
    break;
  }
  switch (binding.numeric) {
  case Numeric::unsigned_integer:
    return VK_FORMAT_R32_UINT;
  case Numeric::signed_integer:
    return VK_FORMAT_R32_SINT;
  case Numeric::real:
  case Numeric::none:
    break;
  }
  return VK_FORMAT_R16G16B16A16_SFLOAT;
}

Error create_set_layout(const Device& device, const PassType& type, Kernel& kernel) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (uint32_t i = 0; i < kernel.ports.size(); ++i)
    if (kernel.ports[i].type)
      bindings.push_back({i, *kernel.ports[i].type, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  VkDescriptorSetLayoutCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  info.bindingCount = static_cast<uint32_t>(bindings.size());
  info.pBindings = bindings.data();
  const VkResult result = device.vk.vkCreateDescriptorSetLayout(
      device.device, &info, device.allocator, &kernel.set_layout);
  if (result != VK_SUCCESS) kernel.set_layout = VK_NULL_HANDLE;
  return call_error(result, "vkCreateDescriptorSetLayout",
                    fmt::format("pass type '{}'", type.name));
}

// Compares the descriptors of a kernel, its ports and the environment, with the limits of a stage.
Error check_descriptors(const Device& device, const KernelInput& input, const PassType& type,
                        const Kernel& kernel) {
  uint32_t storage_buffers = 0, uniform_buffers = 0, sampled_images = 0, storage_images = 0;
  for (const KernelPort& port : kernel.ports) {
    if (!port.type) continue;
    storage_buffers += *port.type == VK_DESCRIPTOR_TYPE_STORAGE_BUFFER ? 1 : 0;
    sampled_images += *port.type == VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE ? 1 : 0;
    storage_images += *port.type == VK_DESCRIPTOR_TYPE_STORAGE_IMAGE ? 1 : 0;
  }
  for (const EnvironmentBinding& binding : input.environment) {
    storage_buffers +=
        binding.type == EnvironmentType::storage_buffer || binding.type == EnvironmentType::counters
            ? 1
            : 0;
    uniform_buffers += binding.type == EnvironmentType::uniform_buffer ? 1 : 0;
  }
  const VkPhysicalDeviceLimits& limits = device.properties.limits;
  const struct {
    const char* what;
    uint32_t needed, limit;
  } checks[] = {
      {"storage buffers", storage_buffers, limits.maxPerStageDescriptorStorageBuffers},
      {"uniform buffers", uniform_buffers, limits.maxPerStageDescriptorUniformBuffers},
      {"sampled images", sampled_images, limits.maxPerStageDescriptorSampledImages},
      {"storage images", storage_images, limits.maxPerStageDescriptorStorageImages},
      {"resources", storage_buffers + uniform_buffers + sampled_images + storage_images,
       limits.maxPerStageResources},
  };
  for (const auto& [what, needed, limit] : checks)
    if (needed > limit)
      return {ErrorKind::unsupported, VK_SUCCESS,
              fmt::format("pass type '{}' binds {} {}; the device '{}' allows {} per stage",
                          type.name, needed, what, device.properties.deviceName, limit)};
  return {};
}

Error create_layout(const Device& device, VkDescriptorSetLayout environment, const PassType& type,
                    Kernel& kernel) {
  const VkDescriptorSetLayout sets[] = {kernel.set_layout, environment};
  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, kernel.push_bytes};
  VkPipelineLayoutCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  info.setLayoutCount = environment != VK_NULL_HANDLE ? 2 : 1;
  info.pSetLayouts = sets;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  const VkResult result =
      device.vk.vkCreatePipelineLayout(device.device, &info, device.allocator, &kernel.layout);
  if (result != VK_SUCCESS) kernel.layout = VK_NULL_HANDLE;
  return call_error(result, "vkCreatePipelineLayout", fmt::format("pass type '{}'", type.name));
}

auto find_code(const KernelInput& input, const PassType& type) {
  return std::find_if(input.codes.begin(), input.codes.end(),
                      [&](const KernelCode& candidate) { return candidate.shader == type.shader; });
}

Error missing_code(const KernelInput& input, const PassType& type) {
  return {ErrorKind::shader, VK_SUCCESS,
          fmt::format("kernel '{}' of type '{}' is not among the {} provided kernels", type.shader,
                      type.name, input.codes.size())};
}

Error create_kernel(const KernelInput& input, PassTypeId id, Kernel& kernel) {
  const PassType& type = input.pass_types[id];
  const auto code = find_code(input, type);
  if (code == input.codes.end()) return missing_code(input, type);
  std::string problem;
  const std::optional<Reflection> reflection = reflect(code->spirv, problem);
  if (!reflection)
    return {ErrorKind::shader, VK_SUCCESS,
            fmt::format("kernel '{}' cannot be read: {}", type.shader, problem)};
  const std::vector<std::string> mismatches = check_signature(type, input.environment, *reflection);
  if (!mismatches.empty())
    return {ErrorKind::shader, VK_SUCCESS, fmt::format("{}", fmt::join(mismatches, "\n"))};
  kernel.type = id;
  kernel.version = code->version;
  kernel.dispatch = type.dispatch;
  for (const ShaderBinding& binding : reflection->bindings)
    kernel.counts =
        kernel.counts || (binding.set == 1 && binding.binding < input.environment.size() &&
                          input.environment[binding.binding].type == EnvironmentType::counters);
  kernel.ports.resize(type.ports.size());
  for (uint32_t p = 0; p < type.ports.size(); ++p) {
    kernel.ports[p].type = descriptor_type(type.ports[p].usage);
    if (type.ports[p].usage == Usage::indirect_arguments) kernel.indirect_port = p;
    for (const ShaderBinding& binding : reflection->bindings)
      if (binding.set == 0 && binding.binding == p)
        kernel.ports[p].placeholder = placeholder_format(type.ports[p], binding);
    if (kernel.ports[p].placeholder == VK_FORMAT_UNDEFINED)
      kernel.ports[p].placeholder = VK_FORMAT_R16G16B16A16_SFLOAT;
  }
  if (type.dispatch.domain == DispatchRule::Domain::indirect && kernel.indirect_port == no_index)
    return {
        ErrorKind::shader, VK_SUCCESS,
        fmt::format(
            "pass type '{}' dispatches indirectly but has no port with usage indirect_arguments",
            type.name)};
  if (!type.arguments_entry.empty())
    kernel.entry_setting = static_cast<uint32_t>(find_setting(type, type.arguments_entry));
  kernel.push_bytes = push_constant_bytes(type);
  for (uint32_t s = 0; s < type.settings.size(); ++s)
    if (!is_constant(type.settings[s])) kernel.pushed_settings.push_back(s);
  for (const SpecialisationConstant& constant : reflection->constants) {
    if (constant.id == constant_id::bound_ports || constant.id == constant_id::changing_ports ||
        constant.id == constant_id::pixel_grid)
      kernel.constants.push_back({constant.id, no_index});
    if (constant.id >= constant_id::first_setting)
      kernel.constants.push_back({constant.id, constant.id - constant_id::first_setting});
  }
  if (Error error = check_descriptors(input.device, input, type, kernel)) return error;
  if (Error error = create_set_layout(input.device, type, kernel)) return error;
  return create_layout(input.device, input.environment_layout, type, kernel);
}

// Returns the constants of a pass's kernel in frames with `settings` (empty: the plan's values).
std::vector<uint32_t> constants_of(const PassType& type, const Kernel& kernel, const Plan& plan,
                                   const PlanPass& pass, std::span<const SettingValue> settings) {
  uint32_t optional = 0; // the presence of other ports makes no difference
  for (uint32_t p = 0; p < type.ports.size(); ++p)
    if (type.ports[p].optional) optional |= uint32_t{1} << p;
  PortMasks masks = port_masks(plan, pass);
  // Drivers on the CPU compile slowly: there, one pipeline serves passes with different ports.
  if (!kernel.device->texel_shape) masks = {.bound = 0, .changing = optional};
  std::vector<uint32_t> values;
  for (const KernelConstant& constant : kernel.constants)
    values.push_back(
        constant.setting != no_index ? kernel_word(value_of(plan, pass, constant.setting, settings))
        : constant.id == constant_id::pixel_grid
            ? plan.pixel_grid
            : (constant.id == constant_id::bound_ports ? masks.bound : masks.changing) & optional);
  return values;
}

} // namespace

Kernel::~Kernel() {
  device->vk.vkDestroyPipelineLayout(device->device, layout, device->allocator);
  device->vk.vkDestroyDescriptorSetLayout(device->device, set_layout, device->allocator);
}

Pipeline::~Pipeline() {
  const Device& device = *kernel->device;
  device.vk.vkDestroyPipeline(device.device, handle, device.allocator);
}

PortMasks port_masks(const Plan& plan, const PlanPass& pass) {
  PortMasks masks;
  for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
    const PlanAccess& access = plan.accesses[a];
    const uint32_t bit = uint32_t{1} << access.port;
    if (access.when == ReadWhen::history_valid)
      masks.changing |= bit;
    else
      masks.bound |= bit;
  }
  // A fallback makes the port bound in every frame.
  masks.changing &= ~masks.bound;
  return masks;
}

SettingValue value_of(const Plan& plan, const PlanPass& pass, uint32_t index,
                      std::span<const SettingValue> settings) noexcept {
  const PlanSetting& setting = plan.settings[pass.first_setting + index];
  const bool live = setting.from.valid() && setting.from.value < settings.size();
  return live ? settings[setting.from.value] : setting.value;
}

uint32_t kernel_word(const SettingValue& value) {
  return value.type == SettingType::real
             ? std::bit_cast<uint32_t>(static_cast<float>(value.real))
             : static_cast<uint32_t>(static_cast<int32_t>(value.integer));
}

// Invocations per group of kernels whose size the executor sets. On the CPU one vector of lavapipe,
// which executes the other vectors of a group even if their lanes are off.
constexpr uint32_t lanes_on_cpu = 8, lanes_on_gpu = 128;
constexpr uint32_t tile_lanes_on_gpu = 64; // the texels of a tile
static_assert(tile_lanes_on_gpu % lanes_on_cpu == 0 && lanes_on_cpu >= 8, "sap_rounds.glsl");

Error create_pipeline(const Device& device, const std::string& object, const std::string& label,
                      std::span<const uint32_t> spirv, const PipelineOptions& options,
                      Pipeline& pipeline) {
  // Kernels ignore constants that they do not declare.
  const uint32_t lanes = device.texel_shape ? lanes_on_gpu : lanes_on_cpu;
  std::vector<uint32_t> values;
  std::vector<VkSpecializationMapEntry> entries;
  const auto add = [&](uint32_t id, uint32_t value) {
    entries.push_back(
        {id, static_cast<uint32_t>(sizeof(uint32_t) * values.size()), sizeof(uint32_t)});
    values.push_back(value);
  };
  add(constant_id::texel_shape, device.texel_shape ? VK_TRUE : VK_FALSE);
  add(constant_id::group_lanes, lanes);
  add(constant_id::wide_group, device.wide_groups ? VK_TRUE : VK_FALSE);
  add(constant_id::wide_lanes, device.wide_groups ? wide_group_lanes : lanes);
  add(constant_id::tile_lanes, device.texel_shape ? tile_lanes_on_gpu : lanes_on_cpu);
  for (size_t i = 0; i < pipeline.constants.size(); ++i)
    add(pipeline.kernel->constants[i].id, pipeline.constants[i]);
  const VkSpecializationInfo constants{static_cast<uint32_t>(entries.size()), entries.data(),
                                       sizeof(uint32_t) * values.size(), values.data()};
  VkShaderModuleCreateInfo module_info{};
  module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  std::vector<uint32_t> simplified;
  if (is_swiftshader(device.properties)) {
    simplified = simplify_for_swiftshader(spirv, constants);
    spirv = simplified;
  }
  module_info.codeSize = spirv.size_bytes();
  module_info.pCode = spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  VkResult result =
      device.vk.vkCreateShaderModule(device.device, &module_info, device.allocator, &module);
  if (result != VK_SUCCESS) return call_error(result, "vkCreateShaderModule", object);
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &constants;
  info.layout = pipeline.kernel->layout;
  info.flags = options.flags;
  result = device.vk.vkCreateComputePipelines(device.device, options.cache, 1, &info,
                                              device.allocator, &pipeline.handle);
  device.vk.vkDestroyShaderModule(device.device, module, device.allocator);
  if (result != VK_SUCCESS) {
    pipeline.handle = VK_NULL_HANDLE;
    return call_error(result, "vkCreateComputePipelines", object);
  }
  name_object(device, VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(pipeline.handle),
              label.c_str());
  return {};
}

Error create_kernels(const KernelInput& input, const Plan& plan, PlanKernels& made) {
  made.of_pass.assign(plan.passes.size(), no_index);
  for (uint32_t p = 0; p < plan.passes.size(); ++p) {
    const PassTypeId type = plan.passes[p].type;
    if (!input.pass_types[type].dispatch.is_kernel()) continue;
    const auto code = find_code(input, input.pass_types[type]);
    const uint64_t version = code != input.codes.end() ? code->version : 0;
    const auto runs = [&](const auto& kernel) {
      return kernel->type == type && kernel->version == version;
    };
    const auto existing = std::find_if(made.kernels.begin(), made.kernels.end(), runs);
    made.of_pass[p] = static_cast<uint32_t>(existing - made.kernels.begin());
    if (existing != made.kernels.end()) continue;
    std::shared_ptr<const Kernel> kernel;
    if (input.store != nullptr) kernel = input.store->find_kernel(type, version);
    if (kernel == nullptr) {
      const auto added = std::make_shared<Kernel>(input.device);
      if (Error error = create_kernel(input, type, *added)) return error;
      kernel = added;
    }
    made.kernels.push_back(std::move(kernel));
  }
  return {};
}

Error create_pipelines(const KernelInput& input, const Plan& plan, const PlanKernels& kernels,
                       PlanPipelines& made) {
  const std::vector<SettingValue> values_of_plan;
  const std::span<const std::vector<SettingValue>> settings =
      input.settings.empty() ? std::span(&values_of_plan, 1) : input.settings;
  made.of_pass.resize(plan.passes.size());
  for (uint32_t p = 0; p < plan.passes.size(); ++p) {
    if (kernels.of_pass[p] == no_index) continue;
    const std::shared_ptr<const Kernel>& kernel = kernels.kernels[kernels.of_pass[p]];
    const PassType& type = input.pass_types[kernel->type];
    for (const std::vector<SettingValue>& values : settings) {
      const std::vector<uint32_t> constants =
          constants_of(type, *kernel, plan, plan.passes[p], values);
      const auto existing = std::ranges::find_if(made.all, [&](const auto& one) {
        return one->kernel->type == kernel->type && one->constants == constants;
      });
      const auto index = static_cast<uint32_t>(existing - made.all.begin());
      if (std::ranges::find(made.of_pass[p], index) == made.of_pass[p].end())
        made.of_pass[p].push_back(index);
      if (existing != made.all.end()) continue;
      std::shared_ptr<const Pipeline> pipeline;
      if (input.store != nullptr)
        pipeline = input.store->find(kernel->type, kernel->version, constants);
      if (pipeline == nullptr) {
        const auto code = find_code(input, type);
        if (code == input.codes.end()) return missing_code(input, type);
        const auto added = std::make_shared<Pipeline>(kernel);
        added->constants = constants;
        if (Error error = create_pipeline(input.device, fmt::format("kernel '{}'", type.shader),
                                          std::string(type.name), code->spirv,
                                          {input.cache, input.flags}, *added))
          return error;
        pipeline = added;
        if (input.store != nullptr) input.store->add(pipeline);
      }
      made.all.push_back(std::move(pipeline));
    }
  }
  return {};
}

} // namespace dermis::vulkan
