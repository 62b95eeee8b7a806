#pragma once
// Holds a graph of the host and its views. Each view has the running compiled graph, the next one,
// which takes over at the next record, and replaced ones that the device may still execute.

#include "integration/abi/chooser.hpp"
#include "integration/abi/commands/capture.hpp"
#include "integration/abi/compiled_graph.hpp"
#include "integration/abi/image_views.hpp"

#include <array>
#include <mutex>

// One camera with its histories. Recording only locks `mutex`, so another thread can change the
// graph meanwhile: it builds without `mutex` and locks `mutex` only to hand over.
struct dermis_view_t {
  dermis_view_t(dermis_context from, dermis_graph of, void* pointer)
      : context(from), graph(of), user(pointer),
        chooser(dermis::abi::make_chooser(
            dermis::abi::device_class(from->device.properties.deviceType))),
        image_views(from->device) {}
  ~dermis_view_t();
  dermis_view_t(const dermis_view_t&) = delete;
  dermis_view_t& operator=(const dermis_view_t&) = delete;

  dermis_context context = nullptr;
  dermis_graph graph = nullptr;
  void* user = nullptr; // passed to host-recorded passes
  // the view's own values; guarded by graph->changing
  std::vector<dermis::abi::HostSetting> settings;
  mutable std::mutex mutex; // guards all following members
  std::shared_ptr<dermis::abi::CompiledGraph>
      running;                                      // recorded last; null before the first record
  std::shared_ptr<dermis::abi::CompiledGraph> next; // takes over at the next record; null: none
  // Replaced compiled graphs, until their last recorded frame has completed. Each was replaced at a
  // different frame, and at most frames_in_flight frames are incomplete.
  std::array<std::shared_ptr<dermis::abi::CompiledGraph>, dermis::vulkan::max_frames_in_flight + 1>
      retired;
  uint64_t last_frame = 0;
  // Recorded frames since the last cut, including the cut; discarded frames do not count.
  uint32_t frames = 0;
  // State before the last record, until that is discarded or another frame is recorded.
  struct Recorded {
    bool known = false;
    uint64_t last_frame = 0; // of the view
    uint32_t frames = 0;     // of the view
    bool took_over = false;  // a new compiled graph, formerly `next`, took over
    // index of the previous compiled graph in `retired`; retired.size(): not stored
    size_t retired = 0;
    uint64_t compiled_graph_last_frame = 0;
    std::array<double, 2> last_jitter_px{};
    uint32_t configuration = 0, plan = 0, compiled_graph_plan = 0;
    bool plan_recorded = false;
  } recorded;
  dermis::abi::Chooser chooser;
  dermis::choice::ViewShare share; // guarded by graph->shared_budget.mutex
  dermis::abi::ImageViews image_views;
  dermis::abi::Capture capture;                // commands of the last capture
  const char* function = "dermis_view_record"; // that records now; errors name it
};

struct dermis_graph_t {
  explicit dermis_graph_t(dermis_context owner); // registers itself with the context
  ~dermis_graph_t();
  dermis_graph_t(const dermis_graph_t&) = delete;
  dermis_graph_t& operator=(const dermis_graph_t&) = delete;

  dermis_context context = nullptr;
  // Serialises changes of the graph and guards the rest. Locked before the mutex of a view.
  std::mutex changing;
  dermis::abi::CompiledGraphInput input; // of the newest compiled graph
  // Plans of earlier compiled graphs, for a setting that returns to an earlier value.
  dermis::PlanCache plans;
  dermis::abi::SharedBudget shared_budget; // outlives the views
  dermis_view_t own;                       // returned by dermis_graph_view
  std::vector<std::unique_ptr<dermis_view_t>> others;
};

namespace dermis::abi {

// Returns the compiled graph that the next record will use. Requires the view's mutex.
inline CompiledGraph& newest(dermis_view_t& view) {
  return view.next ? *view.next : *view.running;
}
// Returns the compiled graph that the next record will use, and keeps it alive while another thread
// records.
inline std::shared_ptr<CompiledGraph> keep_newest(const dermis_view_t& view) {
  const std::lock_guard lock(view.mutex);
  return view.next ? view.next : view.running;
}

// Returns the milliseconds that the next frame of the view may take; 0: no budget. Requires the
// view's mutex.
double budget_of_view(const dermis_view_t& view);

// Returns DEVICE_LOST if reading timings of the running compiled graph reported a lost device; the
// whole context is then lost. Requires the view's mutex.
dermis_result check_loss(const dermis_view_t& view, const char* function);

// Calls use(view) for each view of the graph, its own first. Requires graph.changing.
template <class Use> void for_each_view(dermis_graph_t& graph, Use use) {
  use(graph.own);
  for (const auto& view : graph.others)
    use(*view);
}

// Returns the executor of the previous frame if it is not that of `plan`: another plan of this
// compiled graph, or of the compiled graph that it replaces. Requires the view's mutex.
const vulkan::Executor* recorded_before(const dermis_view_t& view,
                                        const CompiledGraph& compiled_graph, uint32_t plan);

// Builds compiled graphs for all views from `input`; they take over at the next record. On failure
// nothing has changed. Requires graph.changing. `diagnostics` holds findings of reading `input`; an
// error in it fails the call.
dermis_result replace_compiled_graphs(dermis_graph_t& graph, CompiledGraphInput&& input,
                                      vulkan::HistoryReason reason, dermis_report* report,
                                      Diagnostics&& diagnostics = {});

// Gives a copy of the view's compiled graph the graph's values of settings that the view has
// itself.
void drop_own_settings(const dermis_view_t& view, CompiledGraph& compiled_graph);
// Applies the view's own settings to a compiled graph that it will record. Reports settings that no
// longer fit.
void apply_own_settings(const dermis_view_t& view, CompiledGraph& compiled_graph,
                        Diagnostics& diagnostics);

// The functions of a view; `function` names the one that was called.
dermis_result record_frame(dermis_view_t& view, const char* function, const dermis_frame* frame);
dermis_result capture_frame(dermis_view_t& view, const char* function, const dermis_frame* frame,
                            uint32_t* count, const dermis_command** commands);
dermis_result discard_frame(dermis_view_t& view, const char* function, uint64_t frame_index);
dermis_result get_report(dermis_view_t& view, uint64_t completed, dermis_frame_report* out);
dermis_result get_statistics(dermis_view_t& view, uint64_t completed, dermis_frame_statistics* out);
dermis_result get_timings(dermis_view_t& view, const char* function, uint64_t completed,
                          uint32_t* count, dermis_pass_timing* out);
dermis_result get_histories(const dermis_view_t& view, const char* function, uint32_t* count,
                            dermis_history* out);

} // namespace dermis::abi
