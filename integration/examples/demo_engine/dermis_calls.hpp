#pragma once
// What whoever calls Dermis for a VulkanHost has in common: a context of its device, texts, and errors.

#include "integration/examples/demo_engine/context_hooks.hpp"
#include "integration/examples/demo_engine/result.hpp"
#include "integration/examples/demo_engine/vulkan_host.hpp"
#include "integration/include/dermis/dermis.h"

#include <memory>
#include <string>

namespace demo {

// Of one call; destroyed with it.
struct Report {
  dermis_report handle = nullptr;
  Report() = default;
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;
  ~Report() { dermis_report_destroy(handle); }
};

// The report says more than the last error where there is one; it stays the caller's.
Error dermis_error(const char* call, dermis_result result, dermis_report report = nullptr);

// Points into both.
dermis_source source_of(const std::string& name, const std::string& text);

// Made once, into `context`, one of the host's. With times where the device has timestamps, with ray queries
// where the host enabled them and they are `wanted`. Errors: environment, those of `hooks.prepare`.
Result<> make_context(const VulkanHost& host, uint32_t frames_in_flight, bool rays_wanted,
                      std::shared_ptr<dermis_context_t>& context, const ContextHooks& hooks);

} // namespace demo
