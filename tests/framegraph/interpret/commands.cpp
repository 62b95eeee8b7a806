#include "tests/framegraph/interpret/commands.hpp"

#include "tests/framegraph/interpret/placeholder.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <queue>

namespace dermis {
namespace {

bool overlap(const Placement& a, const Placement& b) {
  return a.heap == b.heap && a.offset < b.offset + b.size && b.offset < a.offset + a.size;
}

// One access of a command to one piece of memory.
struct PieceAccess {
  uint32_t command = 0;
  bool is_barrier = false;
  // For barriers: the stages waited for. For passes: the stages of the access.
  Stage source = 0;
  Stage destination = 0; // For barriers: the stages that wait.
  bool from_host = false, to_host = false;
  Queue queue = Queue::main;
};

bool same(const PieceAccess& a, const PieceAccess& b) {
  return a.command == b.command && a.source == b.source && a.destination == b.destination;
}

bool waits(const PieceAccess& later, const PieceAccess& earlier) {
  if (later.queue != earlier.queue) return false;
  if (later.is_barrier && later.from_host) return earlier.is_barrier && earlier.to_host;
  if (later.is_barrier && earlier.is_barrier) return (earlier.destination & later.source) != 0;
  if (later.is_barrier) return (earlier.source & ~later.source) == 0;
  return earlier.is_barrier && (later.source & earlier.destination) != 0;
}

// Returns the accesses to each piece of memory, in command order.
std::vector<std::vector<PieceAccess>> accesses_by_piece(const Plan& plan,
                                                        const MemoryPieces& memory,
                                                        const std::vector<Command>& commands) {
  std::vector<std::vector<PieceAccess>> piece_accesses(memory.overlap.size());
  // Adds at most one access per piece.
  const auto add_access = [&](const auto& what, uint32_t frame, const PieceAccess& one) {
    for (const uint32_t own :
         memory.pieces(plan, what.resource, what.frames_back, frame, what.range))
      for (const uint32_t piece : memory.overlap[own])
        if (piece_accesses[piece].empty() || !same(piece_accesses[piece].back(), one))
          piece_accesses[piece].push_back(one);
  };
  for (uint32_t c = 0; c < commands.size(); ++c) {
    const Command& command = commands[c];
    if (command.wait_until != no_wait) continue;
    if (command.is_pass) {
      const PlanPass& pass = plan.passes[command.index];
      for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
        const PlanAccess& access = plan.accesses[a];
        add_access(access, command.frame,
                   {c, false, access.stages, 0, false, false, command.queue});
      }
    } else {
      const PlanBarrier& barrier = plan.barriers[command.index];
      add_access(barrier, command.frame,
                 {c, true, barrier.source_stages, barrier.destination_stages, barrier.from_host,
                  barrier.to_host, command.queue});
    }
  }
  return piece_accesses;
}

} // namespace

std::vector<uint32_t> MemoryPieces::pieces(const Plan& plan, uint32_t resource,
                                           uint32_t frames_back, uint32_t frame,
                                           const SubresourceRange& range) const {
  const PlanResource& declared = plan.resources[resource];
  const uint32_t count = declared.instance_count;
  const uint32_t instance = (frame % count + count - frames_back % count) % count;
  const uint32_t begin = first[resource] + instance * declared.mips * declared.layers;
  std::vector<uint32_t> result;
  for (uint32_t m = range.first_mip; m < uint32_t{range.first_mip} + range.mips; ++m)
    for (uint32_t l = range.first_layer; l < uint32_t{range.first_layer} + range.layers; ++l)
      result.push_back(begin + m * declared.layers + l);
  return result;
}

MemoryPieces memory_of(const Plan& plan) {
  struct Owner {
    uint32_t resource, instance, placement;
  };
  MemoryPieces memory;
  std::vector<Owner> owners; // By piece.
  for (uint32_t r = 0; r < plan.resources.size(); ++r) {
    const PlanResource& resource = plan.resources[r];
    memory.first.push_back(static_cast<uint32_t>(owners.size()));
    for (uint32_t i = 0; i < resource.instance_count; ++i) {
      const uint32_t placement =
          resource.first_instance == no_instance ? no_instance : resource.first_instance + i;
      owners.insert(owners.end(), size_t{resource.mips} * resource.layers, {r, i, placement});
    }
  }
  memory.overlap.resize(owners.size());
  for (uint32_t a = 0; a < owners.size(); ++a)
    for (uint32_t b = 0; b < owners.size(); ++b) {
      const bool one_image =
          owners[a].resource == owners[b].resource && owners[a].instance == owners[b].instance;
      const bool placed = owners[a].placement != no_instance && owners[b].placement != no_instance;
      const bool shared =
          placed && !one_image &&
          overlap(plan.placements[owners[a].placement], plan.placements[owners[b].placement]);
      if (a == b || shared) memory.overlap[a].push_back(b);
    }
  return memory;
}

std::vector<Command> record(const Plan& plan, uint32_t first, uint32_t end) {
  std::vector<Command> commands;
  uint32_t batch = 0;
  std::array<std::vector<uint32_t>, 2> reached; // Commands, by queue and timeline point.
  const auto barriers = [&](uint32_t frame, uint32_t begin, uint32_t count, Queue queue) {
    for (uint32_t b = begin; b < begin + count; ++b)
      commands.push_back({frame, false, b, batch, queue, no_wait});
    ++batch;
  };
  const auto reach = [&](uint32_t point, Queue queue) {
    if (point != 0)
      reached[static_cast<size_t>(queue)].push_back(static_cast<uint32_t>(commands.size() - 1));
  };
  for (uint32_t frame = first; frame < end; ++frame) {
    const std::array<size_t, 2> before{reached[0].size(), reached[1].size()};
    const auto wait = [&](uint32_t point, Queue queue) {
      const size_t other = queue == Queue::main ? 1 : 0;
      if (point == no_point || before[other] + point == 0 ||
          before[other] + point > reached[other].size())
        return;
      commands.push_back({frame, false, 0, 0, queue, reached[other][before[other] + point - 1]});
    };
    for (uint32_t p = 0; p < plan.passes.size(); ++p) {
      const PlanPass& pass = plan.passes[p];
      wait(pass.wait, pass.queue);
      barriers(frame, pass.first_barrier, pass.barrier_count, pass.queue);
      commands.push_back({frame, true, p, 0, pass.queue, no_wait});
      barriers(frame, pass.first_barrier + pass.barrier_count, pass.release_count, pass.queue);
      reach(pass.signal, pass.queue);
    }
    wait(plan.final_wait, Queue::main);
    barriers(frame, plan.first_final_barrier, plan.final_barrier_count, Queue::main);
  }
  return commands;
}

std::vector<uint32_t> legal_order(const Plan& plan, const MemoryPieces& memory,
                                  const std::vector<Command>& commands, uint64_t seed) {
  std::vector<uint32_t> order(commands.size());
  std::iota(order.begin(), order.end(), 0u);
  if (seed == 0) return order;
  std::vector<std::vector<uint32_t>> followers(commands.size());
  for (const std::vector<PieceAccess>& on_piece : accesses_by_piece(plan, memory, commands))
    for (size_t later = 0; later < on_piece.size(); ++later)
      for (size_t earlier = 0; earlier < later; ++earlier) {
        const uint32_t a = on_piece[earlier].command, b = on_piece[later].command;
        const bool one_batch =
            !commands[a].is_pass && !commands[b].is_pass && commands[a].batch == commands[b].batch;
        if (a != b && !one_batch && waits(on_piece[later], on_piece[earlier]))
          followers[a].push_back(b);
      }
  for (uint32_t w = 0; w < commands.size(); ++w) {
    if (commands[w].wait_until == no_wait) continue;
    for (uint32_t c = 0; c < commands.size(); ++c) {
      const bool own = commands[c].queue == commands[w].queue;
      if (own && c > w) followers[w].push_back(c);
      if (!own && c <= commands[w].wait_until) followers[c].push_back(w);
    }
  }
  std::vector<uint32_t> waits_for(commands.size(), 0);
  for (const auto& all : followers)
    for (const uint32_t b : all)
      ++waits_for[b];
  // The ready command with the highest random priority runs next, which moves some commands far.
  using Ready = std::pair<uint64_t, uint32_t>;
  std::priority_queue<Ready> ready;
  const auto release = [&](uint32_t c) { ready.emplace(arbitrary_pixels(seed, c)[0], c); };
  for (uint32_t c = 0; c < commands.size(); ++c)
    if (waits_for[c] == 0) release(c);
  order.clear();
  while (!ready.empty()) {
    const uint32_t next = ready.top().second;
    ready.pop();
    order.push_back(next);
    for (const uint32_t b : followers[next])
      if (--waits_for[b] == 0) release(b);
  }
  return order;
}

} // namespace dermis
