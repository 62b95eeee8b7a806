// Creates pipelines for the plan's pass types. Layouts follow the signature and are checked against
// the kernel's SPIR-V.
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"
#include "framegraph/vulkan/kernel_store.hpp"
#include "framegraph/vulkan/shader/loop_hints.hpp"
#include "framegraph/vulkan/shader/signature_check.hpp"

#include <algorithm>
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

std::string join_lines(const std::vector<std::string>& lines) {
  return fmt::format("{}", fmt::join(lines, "\n"));
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

Error create_kernel(const KernelInput& input, PassTypeId id, Kernel& kernel) {
  const PassType& type = input.pass_types[id];
  const auto code = find_code(input, type);
  if (code == input.codes.end())
    return {ErrorKind::shader, VK_SUCCESS,
            fmt::format("kernel '{}' of type '{}' is not among the {} provided kernels",
                        type.shader, type.name, input.codes.size())};
  std::string problem;
  const std::optional<Reflection> reflection = reflect(code->spirv, problem);
  if (!reflection)
    return {ErrorKind::shader, VK_SUCCESS,
            fmt::format("kernel '{}' cannot be read: {}", type.shader, problem)};
  const std::vector<std::string> mismatches = check_signature(type, input.environment, *reflection);
  if (!mismatches.empty()) return {ErrorKind::shader, VK_SUCCESS, join_lines(mismatches)};
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
  kernel.push_bytes = static_cast<uint32_t>(sizeof(uint32_t) * (1 + type.settings.size()));
  if (Error error = create_set_layout(input.device, type, kernel)) return error;
  if (Error error = create_layout(input.device, input.environment_layout, type, kernel))
    return error;
  return create_pipeline(input.device, fmt::format("kernel '{}'", type.shader),
                         std::string(type.name), code->spirv, {input.cache, input.flags}, kernel);
}

} // namespace

Kernel::~Kernel() {
  device->vk.vkDestroyPipeline(device->device, pipeline, device->allocator);
  device->vk.vkDestroyPipelineLayout(device->device, layout, device->allocator);
  device->vk.vkDestroyDescriptorSetLayout(device->device, set_layout, device->allocator);
}

// constant_id in shaders/common/shape.glsl; kernels without the constant ignore it
constexpr uint32_t shape_constant = 0;

Error create_pipeline(const Device& device, const std::string& subresource,
                      const std::string& label, std::span<const uint32_t> spirv,
                      const PipelineOptions& options, Kernel& kernel) {
  VkShaderModuleCreateInfo module_info{};
  module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
  std::vector<uint32_t> refined;
  if (unrolls_without_end(device.properties)) {
    refined = without_unrolling(spirv);
    spirv = refined;
  }
  module_info.codeSize = spirv.size_bytes();
  module_info.pCode = spirv.data();
  VkShaderModule module = VK_NULL_HANDLE;
  VkResult result =
      device.vk.vkCreateShaderModule(device.device, &module_info, device.allocator, &module);
  if (result != VK_SUCCESS) return call_error(result, "vkCreateShaderModule", subresource);
  VkComputePipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = module;
  info.stage.pName = "main";
  const VkBool32 texel_shape = device.texel_shape ? VK_TRUE : VK_FALSE;
  const VkSpecializationMapEntry shape{shape_constant, 0, sizeof texel_shape};
  const VkSpecializationInfo constants{1, &shape, sizeof texel_shape, &texel_shape};
  info.stage.pSpecializationInfo = &constants;
  info.layout = kernel.layout;
  info.flags = options.flags;
  result = device.vk.vkCreateComputePipelines(device.device, options.cache, 1, &info,
                                              device.allocator, &kernel.pipeline);
  device.vk.vkDestroyShaderModule(device.device, module, device.allocator);
  if (result != VK_SUCCESS) {
    kernel.pipeline = VK_NULL_HANDLE;
    return call_error(result, "vkCreateComputePipelines", subresource);
  }
  name_object(device, VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<uint64_t>(kernel.pipeline),
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
    if (input.store != nullptr) kernel = input.store->find(type, version);
    if (kernel == nullptr) {
      const auto added = std::make_shared<Kernel>(input.device);
      if (Error error = create_kernel(input, type, *added)) return error;
      kernel = added;
      if (input.store != nullptr) input.store->add(kernel);
    }
    made.kernels.push_back(std::move(kernel));
  }
  return {};
}

} // namespace dermis::vulkan
