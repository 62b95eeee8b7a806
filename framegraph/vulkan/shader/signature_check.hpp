#pragma once
// Checks a kernel against its declared signature: bindings, constants and workgroup size.

#include "framegraph/model/pass_type.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "framegraph/vulkan/shader/reflect.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>
#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

// Returns the descriptor type of a port; nullopt for ports without a descriptor (indirect
// arguments, clear). Free-threaded.
std::optional<VkDescriptorType> descriptor_type(Usage usage);
VkDescriptorType descriptor_type(EnvironmentType type);

// Returns every disagreement, naming the kernel, the port and both sides; empty if the kernel fits.
// Free-threaded.
std::vector<std::string> check_signature(const PassType& type,
                                         std::span<const EnvironmentBinding> environment,
                                         const Reflection& reflection);

} // namespace dermis::vulkan
