#pragma once
// Connects host-recorded pass types in dermis.h to the executor.

#include "framegraph/model/host_pass_type.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "integration/include/dermis/dermis.h"

#include <array>
#include <vector>

namespace dermis::abi {

// Pass types that the host registered with a context.
struct HostPasses {
  struct Recorder {
    PassTypeId type;
    dermis_pass_fn record = nullptr;
    void* user = nullptr;
  };
  HostPassTypes pass_types;
  std::vector<Recorder> recorders; // by pass type of `pass_types`
};

// Adds a pass type to a context without graphs; see dermis_register_pass_type.
dermis_result add_host_pass_type(dermis_context_t& context, HostPassTypeDeclaration type,
                                 dermis_pass_fn record, void* user);

// Returns a value as hosts see it: reals and integers unchanged, booleans as 0 or 1, options as
// their index.
double number_of(const SettingValue& value);

// A call as the host sees it. `call` refers to the two arrays.
struct HostPassCall {
  std::array<dermis_pass_port, limits::host_pass_type_ports> ports;
  std::array<double, limits::host_pass_type_settings> settings;
  dermis_pass_call call;
};
void fill_host_pass(const vulkan::HostPass& call, HostPassCall& out);

// The HostPassFunction of every executor; `host_passes` is the context's HostPasses.
void record_host_pass(void* host_passes, const vulkan::HostPass& call);

} // namespace dermis::abi
