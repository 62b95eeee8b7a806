#include "integration/tools/command/run/host_passes.hpp"

#include "integration/abi/host_pass_types.hpp"
#include "integration/examples/demo_engine/dermis_calls.hpp"

#include <fmt/format.h>

namespace dermis::tools {

HostPasses::HostPasses(std::shared_ptr<const HostPassTypes> pass_types)
    : declared_(std::move(pass_types)) {}

demo::ContextHooks HostPasses::hooks() {
  return {[this](dermis_context_t* context) { return prepare(context); },
          [this] { return recorded(); }};
}

demo::Result<> HostPasses::prepare(dermis_context_t* context) {
  const auto reject = [](void* user, const dermis_pass_call* call) {
    const Kind& kind = *static_cast<const Kind*>(user);
    if (kind.owner->rejected_.empty())
      kind.owner->rejected_ =
          fmt::format("pass '{}' ({}) has no kernel here; embed Dermis or turn the pass off",
                      call->pass, kind.name);
  };
  for (size_t i = 0; i < declared_->size(); ++i) {
    Kind& kind = pass_types_.emplace_back(Kind{this, (*declared_)[i].name});
    const dermis_result result = abi::add_host_pass_type(*context, (*declared_)[i], reject, &kind);
    if (result != DERMIS_OK) return demo::dermis_error("dermis_register_pass_type", result);
  }
  return demo::success();
}

demo::Result<> HostPasses::recorded() const {
  if (rejected_.empty()) return demo::success();
  return demo::Error{demo::ErrorKind::input, rejected_};
}

} // namespace dermis::tools
