#pragma once
// A graph of the host: the program that runs, the one that waits for the next record, and those that the
// device may still be executing.

#include "integration/abi/program.hpp"

#include <array>

struct dermis_graph_t {
  explicit dermis_graph_t(dermis_context owner); // registers itself with the context
  ~dermis_graph_t();
  dermis_graph_t(const dermis_graph_t&) = delete;
  dermis_graph_t& operator=(const dermis_graph_t&) = delete;

  dermis_context context = nullptr;
  dermis::abi::ProgramInput input;               // of the newest program
  dermis::PlanCache plans;                       // of programs built before: what a setting flips back to
  std::unique_ptr<dermis::abi::Program> running; // recorded last; null before the first record
  std::unique_ptr<dermis::abi::Program> next;    // takes over at the next record; null: none
  // Replaced programs, until the frame they were recorded with last has completed. Each was replaced at a
  // different frame, and at most frames_in_flight frames are not complete.
  std::array<std::unique_ptr<dermis::abi::Program>, dermis::vulkan::max_frames_in_flight + 1> retired;
  uint64_t last_frame = 0;
  // What the last record changed, until it is taken back or the next one comes.
  struct Recorded {
    bool known = false;
    uint64_t last_frame = 0; // of the graph
    bool took_over = false;  // a new program: it was `next`
    size_t retired = 0;      // where the program before went, if took_over; the number of places: nowhere
    uint64_t replaced_last_frame = 0;
    uint64_t program_last_frame = 0;
    std::array<double, 2> last_jitter_px{};
    uint32_t outcome = 0, variant = 0;
    dermis::choice::DecisionState decision;
    uint64_t decided_for = 0; // as in Chooser
  } recorded;
  dermis::abi::Chooser chooser;
};

namespace dermis::abi {

// The program that the next record will use.
inline Program& newest(dermis_graph_t& graph) {
  return graph.next ? *graph.next : *graph.running;
}

} // namespace dermis::abi
