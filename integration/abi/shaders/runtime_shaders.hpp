#pragma once
// The kernels of one graph that come from text of the host instead of from the build.

#include "framegraph/model/graph.hpp"
#include "framegraph/model/pass_type.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "integration/include/dermis/dermis.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dermis::abi {

struct RuntimeShaders { // copied with what a graph is built from: a candidate that fails leaves no trace
  struct Kernel {
    std::shared_ptr<const std::vector<uint32_t>> spirv; // null: the build's
    uint64_t version = 0;                               // vulkan::KernelCode::version; 0: the build's
  };
  using Kernels = std::map<std::string, Kernel, std::less<>>; // by PassType::shader
  dermis_include_fn open = nullptr;                           // null: all kernels are the build's
  void* user = nullptr;
  Kernels kernels; // that were looked at
  Kernels before;  // that these replace
};

// From now on kernels come from what `open` delivers, anew; null: from the build.
void use_shaders(RuntimeShaders& shaders, dermis_include_fn open, void* user);

// Compiles the kernels of all pass types that the graph names, but for those that are known. False with
// errors.
bool compile_missing(RuntimeShaders& shaders, const Graph& graph, const PassTypeRegistry& pass_types,
                     Diagnostics& diagnostics);

// For an executor; valid as long as `shaders` stays as it is.
std::vector<vulkan::KernelCode> kernel_codes(const RuntimeShaders& shaders);

} // namespace dermis::abi
