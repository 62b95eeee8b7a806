#include "tests/framegraph/interpret/interpret.hpp"

#include "tests/framegraph/interpret/commands.hpp"

#include <algorithm>

namespace dermis {
namespace {

enum class Owner : uint8_t { main, async, in_transfer };

Owner owner_of(Queue queue) {
  return queue == Queue::main ? Owner::main : Owner::async;
}

struct Interpreter {
  const Plan& plan;
  const InterpretOptions& options;
  MemoryPieces memory;
  std::vector<Pixels> pieces;
  std::vector<Owner> owners = {}; // By piece.
  uint64_t spoiled = 0;           // Counts lost contents: each loss gives other pixels.
  Interpretation out;

  Pixels poison() { return arbitrary_pixels(~options.poison, spoiled++); }

  void prepare() {
    memory = memory_of(plan);
    for (const PlanResource& resource : plan.resources) {
      const bool history = resource.first_instance != no_instance &&
                           plan.placements[resource.first_instance].persistent;
      for (uint32_t i = 0; i < resource.instance_count * resource.mips * resource.layers; ++i)
        pieces.push_back(history ? Pixels{} : poison());
    }
    owners.assign(pieces.size(), Owner::main);
    uint32_t slots = 0;
    for (const PlanResource& resource : plan.resources)
      slots = std::max(slots, static_cast<uint32_t>(resource.slot + 1));
    out.assign(options.frames, std::vector<std::optional<Pixels>>(slots));
  }

  void write(uint32_t piece, const Pixels& pixels) {
    for (const uint32_t other : memory.overlap[piece])
      if (other != piece) pieces[other] = poison();
    pieces[piece] = pixels;
  }

  // Contents of one queue are lost for the other queue, unless they were released and acquired.
  void touch(uint32_t piece, Queue queue) {
    if (owners[piece] != owner_of(queue)) pieces[piece] = poison();
    owners[piece] = owner_of(queue);
  }

  void change_queue(const PlanBarrier& barrier, uint32_t piece, Queue queue) {
    if (barrier.transfer == PlanBarrier::Transfer::none) return;
    const bool acquire = barrier.transfer == PlanBarrier::Transfer::acquire;
    if (owners[piece] != (acquire ? Owner::in_transfer : owner_of(queue))) pieces[piece] = poison();
    owners[piece] = acquire ? owner_of(queue) : Owner::in_transfer;
  }

  void run(const PlanBarrier& barrier, uint32_t frame, Queue queue) {
    const PlanResource& resource = plan.resources[barrier.resource];
    const auto slot = static_cast<uint32_t>(resource.slot);
    for (const uint32_t piece :
         memory.pieces(plan, barrier.resource, barrier.frames_back, frame, barrier.range)) {
      change_queue(barrier, piece, queue);
      if (barrier.from_host)
        pieces[piece] = host_pixels(options.contents, frame, slot);
      else if (resource.type == ResourceType::image && barrier.old_layout == Layout::undefined)
        write(piece, poison()); // An undefined old layout discards the contents.
      if (barrier.to_host) out[frame][slot] = pieces[piece];
    }
  }

  static bool cut_before(const PlanHistory& history, uint64_t cuts, uint32_t frame) {
    return history.declaration.on_cut == HistoryDeclaration::OnCut::invalidate &&
           (cuts >> frame & 1u) != 0;
  }

  // Returns whether enough frames were written since the history began.
  bool valid(const PlanAccess& access, uint32_t frame) const {
    for (const PlanHistory& history : plan.histories) {
      if (history.resource != access.resource) continue;
      uint32_t age = 0;
      while (age < frame && !cut_before(history, options.cuts, frame - age))
        ++age;
      return age >= access.frames_back;
    }
    return false;
  }

  bool happens(const PlanAccess* accesses, uint32_t a, uint32_t frame) const {
    switch (accesses[a].when) {
    case ReadWhen::always:
      return true;
    case ReadWhen::history_valid:
      return valid(accesses[a], frame);
    case ReadWhen::history_invalid:
      return !valid(accesses[a - 1], frame);
    }
    return true;
  }

  // The executor clears these histories before such a frame, too.
  void restart_histories(uint32_t frame) {
    for (const PlanHistory& history : plan.histories)
      for (uint32_t back = 1; cut_before(history, options.cuts, frame) && back <= history.frames;
           ++back)
        for (const uint32_t piece : memory.pieces(plan, history.resource, back, frame,
                                                  plan.resources[history.resource].whole()))
          pieces[piece] = Pixels{};
  }

  void run(const PlanPass& pass, uint32_t frame) {
    const PlanAccess* accesses = plan.accesses.data() + pass.first_access;
    std::vector<PlaceholderInput> inputs;
    for (uint32_t a = 0; a < pass.access_count; ++a)
      if ((accesses[a].access & ~all_write_access) != 0 && !accesses[a].internally_ordered &&
          happens(accesses, a, frame))
        for (const uint32_t piece : pieces_of(accesses[a], frame)) {
          touch(piece, pass.queue);
          inputs.push_back({accesses[a].port, pieces[piece]});
        }
    std::stable_sort(
        inputs.begin(), inputs.end(),
        [](const PlaceholderInput& a, const PlaceholderInput& b) { return a.port < b.port; });
    for (uint32_t a = 0; a < pass.access_count; ++a) {
      if ((accesses[a].access & all_write_access) == 0) continue;
      uint32_t part = 0;
      for (const uint32_t piece : pieces_of(accesses[a], frame)) {
        touch(piece, pass.queue);
        write(piece, placeholder(pass.declared.value, accesses[a].port, part++, inputs));
      }
    }
  }

  std::vector<uint32_t> pieces_of(const PlanAccess& access, uint32_t frame) const {
    return memory.pieces(plan, access.resource, access.frames_back, frame, access.range);
  }
};

} // namespace

Pixels host_pixels(uint64_t contents, uint32_t frame, uint32_t slot) {
  return arbitrary_pixels(contents, (uint64_t{frame} << 32u) + slot);
}

Interpretation interpret(const Plan& plan, const InterpretOptions& options) {
  Interpreter machine{plan, options, {}, {}, {}, 0, {}};
  machine.prepare();
  for (uint32_t first = 0; first < options.frames;) { // Runs from one cut to the next.
    machine.restart_histories(first);
    uint32_t end = first + 1;
    while (end < options.frames && (options.cuts >> end & 1u) == 0)
      ++end;
    const std::vector<Command> commands = record(plan, first, end);
    for (const uint32_t c : legal_order(plan, machine.memory, commands, options.order)) {
      const Command& command = commands[c];
      if (command.wait_until != no_wait) continue;
      if (command.is_pass)
        machine.run(plan.passes[command.index], command.frame);
      else
        machine.run(plan.barriers[command.index], command.frame, command.queue);
    }
    first = end;
  }
  return std::move(machine.out);
}

} // namespace dermis
