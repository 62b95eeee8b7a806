#pragma once
// Helpers for calls of Dermis with a VulkanHost: a context for its device, graphs, texts, and
// errors.

#include "integration/examples/demo_engine/budget.hpp"
#include "integration/examples/demo_engine/context_hooks.hpp"
#include "integration/examples/demo_engine/result.hpp"
#include "integration/examples/demo_engine/vulkan_host.hpp"
#include "integration/include/dermis/dermis.h"

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

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

// Opens files for Dermis by name. Keeps delivered texts until the requesting call returns.
struct Delivery {
  std::function<std::optional<NamedText>(const std::string& name)> open;
  std::deque<NamedText> delivered = {};
};
// The callback; `user` is a Delivery.
uint32_t DERMIS_CALL deliver(void* user, const char* name, dermis_source* source);

// A dermis_graph_desc that owns its texts.
struct GraphRequest {
  std::string graph_name, graph_text; // file name for messages, JSON
  std::vector<NamedText> overlays;    // file name for messages, JSON
  // Opens files that graph and overlays include; not used after creation.
  std::function<std::optional<NamedText>(const std::string& name)> include;
  uint32_t width = 0, height = 0; // allocated size, pixels
  double pixel_aspect = 1;        // width / height of a pixel
  struct Profile {
    uint32_t id = 0;
    std::string name, text; // name for messages, JSON
    bool operator==(const Profile&) const = default;
  };
  std::vector<Profile> profiles;
  std::vector<std::pair<std::string, VkFormat>> formats; // of slots
  std::vector<std::string> unbound;                      // optional slots
};
Result<dermis_graph> create_graph(dermis_context context, const GraphRequest& request,
                                  Report& report);

// Makes a context of the host in `context`, once. The context measures times if the device has
// timestamps, and has ray queries if the host enabled them and `enable_rays` is set. Errors:
// environment, those of `hooks.prepare`.
Result<> make_context(const VulkanHost& host, uint32_t frames_in_flight, bool enable_rays,
                      std::shared_ptr<dermis_context_t>& context, const ContextHooks& hooks);

} // namespace demo
