#pragma once
// Holds the kernels of one graph that come from the host's GLSL instead of from the build.

#include "framegraph/model/graph.hpp"
#include "framegraph/model/pass_type.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "integration/include/dermis/dermis.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dermis::abi {

// Copied with the input of a graph, so a failed candidate leaves no trace.
struct RuntimeShaders {
  struct Kernel {
    std::shared_ptr<const std::vector<uint32_t>> spirv; // null: the build's kernel
    // vulkan::KernelCode::version; 0: the build's kernel
    uint64_t version = 0;
  };
  using Kernels = std::map<std::string, Kernel, std::less<>>; // by PassType::shader
  // null: all kernels come from the build
  dermis_include_fn open = nullptr;
  void* user = nullptr;
  Kernels kernels;  // kernels compiled or looked up so far
  Kernels replaced; // kernels of the previous sources, kept until all are compiled again
};

// Makes kernels come from `open`, compiled again; null: from the build.
void use_shaders(RuntimeShaders& shaders, dermis_include_fn open, void* user);

// Compiles the kernels of all pass types that the graph names, except known kernels. Returns false
// with errors in `diagnostics`.
bool compile_missing(RuntimeShaders& shaders, const Graph& graph,
                     const PassTypeRegistry& pass_types, Diagnostics& diagnostics);

// Returns the kernels for an executor; valid while `shaders` is unchanged.
std::vector<vulkan::KernelCode> kernel_codes(const RuntimeShaders& shaders);

} // namespace dermis::abi
