#pragma once
// Kinds of passes that the host records, between dermis.h and the executor.

#include "framegraph/model/host_pass_type.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "integration/include/dermis/dermis.h"

#include <array>
#include <vector>

namespace dermis::abi {

// What a context keeps of its host's kinds.
struct HostPasses {
  struct Recorder {
    PassTypeId type;
    dermis_pass_fn record = nullptr;
    void* user = nullptr;
  };
  HostPassTypes pass_types;
  std::vector<Recorder> recorders; // by kind of `pass_types`
};

// Makes a pass type known to the graphs of a context that has none yet; see dermis_register_pass_type.
dermis_result add_host_pass_type(dermis_context_t& context, HostPassTypeDeclaration type,
                                 dermis_pass_fn record, void* user);

// A value as hosts see it: reals and integers as they are, booleans as 0 or 1, words as their index.
double number_of(const SettingValue& value);

// A call as the host sees it. `call` points into the two arrays.
struct HostPassCall {
  std::array<dermis_pass_port, limits::host_pass_type_ports> ports;
  std::array<double, limits::host_pass_type_settings> settings;
  dermis_pass_call call;
};
void fill_host_pass(const vulkan::HostPass& call, HostPassCall& out);

// HostPassFunction of every executor; `host_passes` is the context's HostPasses.
void record_host_pass(void* host_passes, const vulkan::HostPass& call);

} // namespace dermis::abi
