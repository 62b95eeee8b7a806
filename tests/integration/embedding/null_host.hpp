#pragma once
// A host on a null device: the whole interface, with failures that tests can request and count.

#include "integration/tools/null_device/null_device.hpp"

#include "tests/integration/abi/results.hpp"

#include <string>
#include <vector>

namespace dermis::abi_test {

// Thread: one at a time for each object.
class NullHost {
public:
  NullHost() = default;
  ~NullHost();
  NullHost(const NullHost&) = delete;
  NullHost& operator=(const NullHost&) = delete;

  dermis_context_desc context_desc(); // Describes `device`, with timing enabled.
  dermis_result make_context(const dermis_context_desc& desc);
  // Makes a graph of burley.json with accumulated light and one skin profile.
  dermis_result make_graph(uint32_t side = 64);
  // Returns a binding of a new image in general layout.
  dermis_image_binding image_for(const dermis_slot& slot);
  void make_bindings(); // Makes images for every slot.
  std::vector<dermis_image_binding>& bindings() { return bindings_; }
  // Makes the context, the graph and images.
  dermis_result start();
  void number_images();                                     // Gives each image a new content_id.
  void give_up_views();                                     // Uses content_ids instead of views.
  dermis_result reload(const std::string& text = "") const; // "" means the graph's own text.
  dermis_result set_profile(const std::string& text) const; // Sets profile 1.
  // Records the next frame of the graph or of one of its views.
  dermis_result record();
  dermis_result record(dermis_view view, uint64_t index) const;
  dermis_frame frame_at(uint64_t index) const; // Uses the images of make_bindings.
  void destroy();                              // Destroys the graph, then the context.

  NullDevice device;
  dermis_context context = nullptr;
  dermis_graph graph = nullptr;
  uint64_t last_frame = 0; // The last recorded frame.

private:
  std::vector<dermis_image_binding> bindings_;
  uint64_t last_id_ = 0; // dermis_image_binding.content_id
};

// Callback for dermis_graph_reload_shaders: returns one kernel of the graph that does nothing.
// `user` points to a uint32_t that counts the calls.
uint32_t DERMIS_CALL open_kernel(void* user, const char* name, dermis_source* source);

} // namespace dermis::abi_test
