#include "framegraph/vulkan/pipeline_statistics.hpp"

#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <string_view>

namespace dermis::vulkan {
namespace {

// Functions of VK_KHR_pipeline_executable_properties, which only this file uses.
struct StatisticFunctions {
  PFN_vkGetPipelineExecutablePropertiesKHR properties = nullptr;
  PFN_vkGetPipelineExecutableStatisticsKHR statistics = nullptr;
  PFN_vkGetPipelineExecutableInternalRepresentationsKHR representations = nullptr;
};

template <class Function>
void load_function(const Device& device, const char* name, Function& function) {
  function = reinterpret_cast<Function>(device.vk.vkGetDeviceProcAddr(device.device, name));
}

StatisticFunctions load_statistic_functions(const Device& device) {
  StatisticFunctions functions;
  load_function(device, "vkGetPipelineExecutablePropertiesKHR", functions.properties);
  load_function(device, "vkGetPipelineExecutableStatisticsKHR", functions.statistics);
  load_function(device, "vkGetPipelineExecutableInternalRepresentationsKHR",
                functions.representations);
  return functions;
}

// Calls `query(count, out)` twice: for the count, and to fill that many structs.
template <class T, class Query> std::vector<T> enumerate_all(VkStructureType type, Query query) {
  uint32_t count = 0;
  if (query(&count, nullptr) != VK_SUCCESS) return {};
  T empty{};
  empty.sType = type;
  std::vector<T> all(count, empty);
  if (query(&count, all.data()) != VK_SUCCESS) return {};
  all.resize(count);
  return all;
}

double statistic_value(const VkPipelineExecutableStatisticKHR& statistic) {
  switch (statistic.format) {
  case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_BOOL32_KHR:
    return statistic.value.b32 != VK_FALSE ? 1 : 0;
  case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_INT64_KHR:
    return static_cast<double>(statistic.value.i64);
  case VK_PIPELINE_EXECUTABLE_STATISTIC_FORMAT_UINT64_KHR:
    return static_cast<double>(statistic.value.u64);
  default:
    return statistic.value.f64;
  }
}

// Returns the last textual representation, which is the final assembly.
std::string read_assembly(const Device& device, const StatisticFunctions& vk,
                          const VkPipelineExecutableInfoKHR& info) {
  using Representation = VkPipelineExecutableInternalRepresentationKHR;
  const auto query = [&](uint32_t* count, Representation* out) {
    return vk.representations(device.device, &info, count, out);
  };
  auto all = enumerate_all<Representation>(
      VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INTERNAL_REPRESENTATION_KHR, query);
  std::vector<std::string> texts(all.size());
  for (size_t i = 0; i < all.size(); ++i) {
    texts[i].resize(all[i].dataSize);
    all[i].pData = texts[i].data();
  }
  auto count = static_cast<uint32_t>(all.size());
  if (count == 0 || query(&count, all.data()) != VK_SUCCESS) return "";
  for (size_t i = all.size(); i-- > 0;) {
    if (all[i].isText == VK_FALSE) continue;
    return texts[i].substr(0, texts[i].find('\0'));
  }
  return "";
}

std::vector<PipelineExecutable>
read_executables(const PipelinesInput& input, const StatisticFunctions& vk, VkPipeline pipeline) {
  const VkDevice device = input.device->device;
  const VkPipelineInfoKHR of{VK_STRUCTURE_TYPE_PIPELINE_INFO_KHR, nullptr, pipeline};
  const auto programs = enumerate_all<VkPipelineExecutablePropertiesKHR>(
      VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_PROPERTIES_KHR,
      [&](uint32_t* count, VkPipelineExecutablePropertiesKHR* out) {
        return vk.properties(device, &of, count, out);
      });
  std::vector<PipelineExecutable> executables;
  for (uint32_t i = 0; i < programs.size(); ++i) {
    const VkPipelineExecutableInfoKHR info{VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_INFO_KHR, nullptr,
                                           pipeline, i};
    PipelineExecutable& executable = executables.emplace_back();
    executable.name = programs[i].name;
    executable.subgroup_size = programs[i].subgroupSize;
    for (const VkPipelineExecutableStatisticKHR& one :
         enumerate_all<VkPipelineExecutableStatisticKHR>(
             VK_STRUCTURE_TYPE_PIPELINE_EXECUTABLE_STATISTIC_KHR,
             [&](uint32_t*count, VkPipelineExecutableStatisticKHR*out) {
               return vk.statistics(device, &info, count, out);
             }))
      executable.statistics.push_back({one.name, one.description, statistic_value(one)});
    if (input.assembly && vk.representations != nullptr)
      executable.assembly = read_assembly(*input.device, vk, info);
  }
  return executables;
}

std::string setting_text(const PassTypeSetting& setting, uint32_t value) {
  if (setting.type == SettingType::boolean)
    return fmt::format("{}={}", setting.name, value != 0 ? "true" : "false");
  return value < setting.options.size() ? fmt::format("{}={}", setting.name, setting.options[value])
                                        : fmt::format("{}={}", setting.name, value);
}

std::string constants_text(const PassType& type, const Pipeline& pipeline) {
  std::vector<std::string> words;
  PortMasks masks;
  bool has_masks = false;
  for (size_t i = 0; i < pipeline.constants.size(); ++i) {
    const KernelConstant& constant = pipeline.kernel->constants[i];
    if (constant.setting != no_index)
      words.push_back(setting_text(type.settings[constant.setting], pipeline.constants[i]));
    else if (constant.id == constant_id::pixel_grid)
      words.push_back(fmt::format("pixel_grid={}", pipeline.constants[i]));
    else
      (constant.id == constant_id::bound_ports ? masks.bound : masks.changing) =
          pipeline.constants[i];
    has_masks = has_masks || constant.id == constant_id::bound_ports ||
                constant.id == constant_id::changing_ports;
  }
  for (uint32_t p = 0; has_masks && p < type.ports.size(); ++p)
    if (type.ports[p].optional)
      words.push_back(fmt::format("{}={}", type.ports[p].name,
                                  (masks.bound >> p & 1u) != 0      ? "bound"
                                  : (masks.changing >> p & 1u) != 0 ? "changing"
                                                                    : "unbound"));
  return fmt::format("{}", fmt::join(words, " "));
}

// Layout of set 1, which pipelines need only while they are created.
struct EnvironmentLayout {
  const Device& device;
  VkDescriptorSetLayout layout = VK_NULL_HANDLE;
  explicit EnvironmentLayout(const Device& owner) : device(owner) {}
  ~EnvironmentLayout() {
    device.vk.vkDestroyDescriptorSetLayout(device.device, layout, device.allocator);
  }
  EnvironmentLayout(const EnvironmentLayout&) = delete;
  EnvironmentLayout& operator=(const EnvironmentLayout&) = delete;
};

} // namespace

Error compile_pipelines(const PipelinesInput& input, std::vector<CompiledPipeline>& pipelines) {
  const Device& device = *input.device;
  EnvironmentLayout environment(device);
  if (!input.environment.empty())
    if (Error error = create_environment_layout(device, input.environment, environment.layout))
      return error;
  VkPipelineCreateFlags flags = 0;
  if (input.statistics) flags |= VK_PIPELINE_CREATE_CAPTURE_STATISTICS_BIT_KHR;
  if (input.statistics && input.assembly)
    flags |= VK_PIPELINE_CREATE_CAPTURE_INTERNAL_REPRESENTATIONS_BIT_KHR;
  PlanKernels kernels;
  PlanPipelines made;
  const KernelInput source{.device = device,
                           .pass_types = *input.pass_types,
                           .codes = input.kernels,
                           .environment = input.environment,
                           .environment_layout = environment.layout,
                           .flags = flags,
                           .store = input.store};
  if (Error error = create_kernels(source, *input.plan, kernels)) return error;
  if (Error error = create_pipelines(source, *input.plan, kernels, made)) return error;
  const size_t first = pipelines.size();
  for (std::shared_ptr<const Pipeline>& one : made.all) {
    CompiledPipeline& pipeline = pipelines.emplace_back();
    pipeline.type = one->kernel->type;
    pipeline.constants = constants_text((*input.pass_types)[pipeline.type], *one);
    pipeline.pipeline = std::move(one);
  }
  for (uint32_t p = 0; p < made.of_pass.size(); ++p)
    for (const uint32_t index : made.of_pass[p])
      pipelines[first + index].passes.push_back(p);
  if (!input.statistics) return {};
  const StatisticFunctions functions = load_statistic_functions(device);
  if (functions.properties == nullptr || functions.statistics == nullptr)
    return {ErrorKind::unsupported, VK_SUCCESS,
            "functions of VK_KHR_pipeline_executable_properties are missing"};
  for (size_t i = first; i < pipelines.size(); ++i)
    pipelines[i].executables = read_executables(input, functions, pipelines[i].pipeline->handle);
  return {};
}

} // namespace dermis::vulkan
