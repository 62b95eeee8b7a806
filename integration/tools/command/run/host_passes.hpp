#pragma once
// Pass types of a host in a program that has no kernels for them. Graphs with such passes run as
// long as those passes are off or not needed; a pass that would run is rejected by name.

#include "framegraph/model/host_pass_type.hpp"
#include "integration/examples/demo_engine/context_hooks.hpp"

#include <deque>
#include <memory>
#include <string>

namespace dermis::tools {

// Must outlive the contexts that use its hooks. One thread.
class HostPasses {
public:
  explicit HostPasses(std::shared_ptr<const HostPassTypes> pass_types);
  HostPasses(const HostPasses&) = delete;
  HostPasses& operator=(const HostPasses&) = delete;

  demo::ContextHooks hooks();
  demo::Result<> prepare(dermis_context_t* context); // registers the pass types
  demo::Result<> recorded() const; // the error names the first host pass that would have run

private:
  struct Kind {
    HostPasses* owner;
    std::string name;
  };

  std::shared_ptr<const HostPassTypes> declared_;
  std::deque<Kind> pass_types_; // a deque, for stable addresses
  std::string rejected_;
};

} // namespace dermis::tools
