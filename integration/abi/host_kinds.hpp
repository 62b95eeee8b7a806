#pragma once
// Kinds of passes that the host records, between dermis.h and the executor.

#include "framegraph/model/host_kind.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "integration/include/dermis/dermis.h"

#include <vector>

namespace dermis::abi {

// What a context keeps of its host's kinds.
struct HostPasses {
  struct Recorder {
    KindId kind;
    dermis_pass_fn record = nullptr;
    void* user = nullptr;
  };
  HostKinds kinds;
  std::vector<Recorder> recorders; // by kind of `kinds`
};

// HostPassFunction of every executor; `host_passes` is the context's HostPasses.
void record_host_pass(void* host_passes, const vulkan::HostPass& call);

} // namespace dermis::abi
