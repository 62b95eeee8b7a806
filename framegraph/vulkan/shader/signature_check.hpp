#pragma once
// Holds a kernel against the signature it claims to follow: bindings, push constants, workgroup size.

#include "framegraph/model/pass_type.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "framegraph/vulkan/shader/reflect.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>
#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

// The descriptor of a port; nullopt for ports without one (indirect arguments, clear). Free-threaded.
std::optional<VkDescriptorType> descriptor_type(Usage usage);
VkDescriptorType descriptor_type(EnvironmentType type);

// Every disagreement, each naming kernel, port and both sides; empty: the kernel fits. Free-threaded.
std::vector<std::string> check_signature(const PassType& type,
                                         std::span<const EnvironmentBinding> environment,
                                         const Reflection& reflection);

} // namespace dermis::vulkan
