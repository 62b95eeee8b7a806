#pragma once
// Helpers for calls of Dermis with a VulkanHost: a context for its device, texts, and errors.

#include "integration/examples/demo_engine/context_hooks.hpp"
#include "integration/examples/demo_engine/result.hpp"
#include "integration/examples/demo_engine/vulkan_host.hpp"
#include "integration/include/dermis/dermis.h"

#include <memory>
#include <string>

namespace demo {

// Owns the report of one call.
struct Report {
  dermis_report handle = nullptr;
  Report() = default;
  Report(const Report&) = delete;
  Report& operator=(const Report&) = delete;
  ~Report() { dermis_report_destroy(handle); }
};

// Returns an error with the text of the report, or of the last error if the report is empty. The
// caller keeps the report.
Error dermis_error(const char* call, dermis_result result, dermis_report report = nullptr);

// Returns a source that points into both strings.
dermis_source source_of(const std::string& name, const std::string& text);

// Makes a context of the host in `context`, once. The context measures times if the device has
// timestamps, and has ray queries if the host enabled them and `enable_rays` is set. Errors:
// environment, those of `hooks.prepare`.
Result<> make_context(const VulkanHost& host, uint32_t frames_in_flight, bool enable_rays,
                      std::shared_ptr<dermis_context_t>& context, const ContextHooks& hooks);

} // namespace demo
