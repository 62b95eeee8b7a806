#include "integration/abi/shaders/runtime_shaders.hpp"

#include "integration/abi/host_files.hpp"
#include "integration/abi/shaders/compiler.hpp"
#include "passes/common/kernels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <span>

namespace dermis::abi {
namespace {

// Shared by all graphs, because graphs of a context share kernels.
std::atomic<uint64_t> versions = 0;

// Keeps the version of unchanged SPIR-V, so that pipelines are reused.
RuntimeShaders::Kernel versioned(RuntimeShaders& shaders, const std::string& shader,
                                 std::vector<uint32_t>&& spirv) {
  if (spirv.empty() || std::ranges::equal(spirv, find_kernel(shader))) return {};
  const auto before = shaders.replaced.find(shader);
  if (before != shaders.replaced.end() && before->second.spirv && *before->second.spirv == spirv)
    return before->second;
  return {std::make_shared<const std::vector<uint32_t>>(std::move(spirv)), ++versions};
}

std::string list_files(const std::vector<std::string>& shaders) {
  std::string list;
  for (const std::string& shader : shaders)
    list += fmt::format("{}'{}.comp'", list.empty() ? "" : ", ", shader);
  return list;
}

} // namespace

void use_shaders(RuntimeShaders& shaders, dermis_include_fn open, void* user) {
  shaders.open = open;
  shaders.user = user;
  shaders.replaced = std::move(shaders.kernels);
  shaders.kernels.clear();
}

bool compile_missing(RuntimeShaders& shaders, const Graph& graph,
                     const PassTypeRegistry& pass_types, Diagnostics& diagnostics) {
  if (shaders.open == nullptr) return true;
  std::vector<std::string> missing;
  for (const PassDeclaration& pass : graph.passes) {
    const PassType& type = pass_types[pass.type];
    const std::string shader(type.shader);
    if (!type.dispatch.is_kernel()) continue;
    if (shaders.kernels.contains(shader) || std::ranges::find(missing, shader) != missing.end())
      continue;
    missing.push_back(shader);
  }
  if (missing.empty()) return true;
  const OpenFile open = [&](std::string_view name) {
    return ask_host(shaders.open, shaders.user, name);
  };
  std::vector<std::vector<uint32_t>> spirv;
  if (!compile_shaders(missing, open, spirv, diagnostics)) return false;
  const auto is_empty = [](const std::vector<uint32_t>& words) { return words.empty(); };
  if (shaders.kernels.empty() && std::ranges::all_of(spirv, is_empty)) {
    diagnostics.add(
        DiagnosticId::shader_error, {},
        fmt::format("the host delivers none of the graph's kernels: {}", list_files(missing)));
    return false;
  }
  for (size_t i = 0; i < missing.size(); ++i)
    shaders.kernels.emplace(missing[i], versioned(shaders, missing[i], std::move(spirv[i])));
  shaders.replaced.clear();
  return true;
}

std::vector<vulkan::KernelCode> kernel_codes(const RuntimeShaders& shaders) {
  std::vector<vulkan::KernelCode> codes;
  for (const Kernel& kernel : embedded_kernels()) {
    const auto own = shaders.kernels.find(kernel.shader);
    if (own != shaders.kernels.end() && own->second.spirv)
      codes.push_back({kernel.shader, *own->second.spirv, own->second.version});
    else
      codes.push_back({kernel.shader, kernel.spirv, 0});
  }
  return codes;
}

} // namespace dermis::abi
