#pragma once
// Hooks by which a program extends a Dermis context of the engine and inspects each recorded frame.

#include "integration/examples/demo_engine/result.hpp"

#include <functional>

struct dermis_context_t;

namespace demo {

struct ContextHooks {
  // Called once with the new context, before its first graph. May be empty.
  std::function<Result<>(dermis_context_t* context)> prepare = {};
  // Called after each dermis_view_record; an error drops the frame. May be empty.
  std::function<Result<>()> recorded = {};
};

} // namespace demo
