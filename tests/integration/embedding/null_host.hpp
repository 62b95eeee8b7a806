#pragma once
// A host on a device that runs nothing: the whole interface where failures can be asked for and counted.

#include "integration/tools/null_device/null_device.hpp"

#include <dermis/dermis.h>

#include <string>
#include <vector>

namespace dermis::abi_test {

// One thread at a time for each.
class NullHost {
public:
  NullHost() = default;
  ~NullHost();
  NullHost(const NullHost&) = delete;
  NullHost& operator=(const NullHost&) = delete;

  dermis_context_desc context_desc(); // of `device`, with times
  dermis_result make_context(const dermis_context_desc& desc);
  dermis_result make_graph(uint32_t side = 64);             // burley.json with light over frames and a skin
  void make_bindings();                                     // images for every slot
  void give_up_views();                                     // content_ids instead
  dermis_result reload(const std::string& text = "") const; // ""; the graph's own
  dermis_result set_profile(const std::string& text) const; // number 1
  // The next frame of the graph, or of a view of it.
  dermis_result record();
  dermis_result record(dermis_view view, uint64_t index) const;
  dermis_frame frame_at(uint64_t index) const; // with the images of make_bindings
  void destroy();                              // graph, then context

  NullDevice device;
  dermis_context context = nullptr;
  dermis_graph graph = nullptr;
  uint64_t last_frame = 0; // recorded last

private:
  std::vector<dermis_image_binding> bindings_;
};

// For dermis_graph_reload_shaders: one kernel of the graph, which does nothing. `user`: a uint32_t that
// counts how often it was asked for.
uint32_t DERMIS_CALL open_kernel(void* user, const char* name, dermis_source* source);

} // namespace dermis::abi_test
