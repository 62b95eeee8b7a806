// Runs random graphs of the real pass types on a device: the host gets equal bits for every order
// and memory placement.
#include "framegraph/model/expression.hpp"
#include "framegraph/text/diagnostic.hpp"
#include "framegraph/verify/verify.hpp"
#include "tests/framegraph/graph_reference.hpp"
#include "tests/framegraph/interpret/interpret.hpp"
#include "tests/passes/device/fuzz_seeds.hpp"
#include "tests/passes/device/player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace dermis::testing {
namespace {

// Compiler options that must not change the result.
struct Decisions {
  std::string name;
  PassOrder order = PassOrder::memory;
  uint64_t order_seed = 0;
  PackingLevel packing = PackingLevel::tight;
  bool alias = true, cull = true, poison = false;
  ResourceId keep_alive = {};
};

struct Totals {
  uint64_t graphs = 0, passes = 0, plans = 0, other_plans = 0, frames = 0, pictures = 0,
           aliased = 0, shared = 0, cuts = 0, references = 0;
};

bool is_aliased(const Plan& plan, uint32_t history) {
  const PlanResource& resource = plan.resources[plan.histories[history].resource];
  if (resource.first_instance == no_instance) return false;
  const Placement& alias_target = plan.placements[resource.first_instance];
  for (const Placement& placement : plan.placements)
    if (!placement.persistent && placement.heap == alias_target.heap &&
        placement.offset < alias_target.offset + alias_target.size &&
        alias_target.offset < placement.offset + placement.size)
      return true;
  return false;
}

// Returns whether everything is bound and every pass is enabled. The reference does not define an
// optional port without a producer.
bool whole(const Graph& graph, const Show& show) {
  std::vector<SettingValue> settings;
  for (const SettingDeclaration& setting : graph.settings)
    settings.push_back(setting.default_value);
  const auto on = [&](const PassDeclaration& pass) {
    return !pass.when.valid() || evaluate(graph, pass.when, settings);
  };
  return std::find(show.bound.begin(), show.bound.end(), false) == show.bound.end() &&
         std::all_of(graph.passes.begin(), graph.passes.end(), on);
}

class DeviceFuzz : public DevicePlayer {
protected:
  std::optional<Plan> plan_of(const RealGraph& graph, const Show& show,
                              const Decisions& decisions) const {
    CompileInput input = compile_input(graph, show);
    input.order = decisions.order;
    input.order_seed = decisions.order_seed;
    input.packing = decisions.packing;
    input.alias = decisions.alias;
    input.cull = decisions.cull;
    input.poison = decisions.poison;
    input.keep_alive = decisions.keep_alive;
    input.reasons = false;
    Diagnostics diagnostics;
    auto compiled = compile(input, diagnostics);
    EXPECT_TRUE(compiled) << decisions.name << ": " << format_as_json(diagnostics);
    if (!compiled) return std::nullopt;
    EXPECT_EQ(verify(compiled->plan).violations, std::vector<std::string>{}) << decisions.name;
    return std::move(compiled->plan);
  }

  // The first entry is the baseline: nothing is aliased or reordered.
  std::vector<Decisions> decisions_of(const RealGraph& graph, const Show& show,
                                      uint64_t seed) const {
    std::vector<Decisions> all = {
        {"nothing shared, order of the file", PassOrder::program, 0, PackingLevel::fast, false},
        {"shipped options"},
        {"packed fast, poison", PassOrder::memory, 0, PackingLevel::fast, true, true, true},
        {"another order", PassOrder::random, 2 * seed + 1},
        {"a third order, packed fast", PassOrder::random, 2 * seed + 2, PackingLevel::fast},
        {"another order, nothing culled", PassOrder::random, 2 * seed + 1, PackingLevel::tight,
         true, false},
        {"another order, nothing shared, nothing culled", PassOrder::random, 2 * seed + 1,
         PackingLevel::tight, false, false}};
    // The best packing level searches for up to half a minute.
    if (std::getenv("DERMIS_TESTS_FULL") != nullptr && seed % 10 == 0)
      all.push_back({"packed as well as can be", PassOrder::memory, 0, PackingLevel::optimize});
    const auto shipped = plan_of(graph, show, all[1]);
    for (uint32_t h = 0; shipped && h < shipped->histories.size(); ++h)
      if (is_aliased(*shipped, h)) {
        Decisions without = {"shipped options, without aliasing into one history"};
        without.keep_alive = shipped->resources[shipped->histories[h].resource].declared;
        all.push_back(without);
        break;
      }
    return all;
  }

  void try_graph(uint64_t seed, Totals& totals) {
    const auto graph = random_real_graph(seed, pass_types);
    if (!graph) return;
    const Show show = random_show(seed, graph->graph);
    SCOPED_TRACE(fmt::format("seed {}: {}, {}x{}", seed, graph->name, show.width, show.height));
    const std::vector<Decisions> all = decisions_of(*graph, show, seed);
    std::optional<Plan> first_plan;
    Played first;
    Interpretation meant;
    for (const Decisions& decisions : all) {
      auto plan = plan_of(*graph, show, decisions);
      if (!plan) return;
      const Played played = play(*graph, show, *plan, decisions.poison);
      EXPECT_EQ(take_messages(), std::vector<std::string>{}) << decisions.name;
      const Interpretation interpreted = interpret(*plan, {random_frames, seed, seed + 1, seed});
      ++totals.plans;
      totals.frames += played.size();
      totals.aliased += decisions.keep_alive.valid();
      if (!first_plan) {
        first_plan = std::move(plan);
        first = played;
        meant = interpreted;
        if (whole(graph->graph, show)) {
          EXPECT_TRUE(
              agrees(meant, graph_reference(graph->graph, pass_types, random_frames, seed)));
          ++totals.references;
        }
        totals.passes += first_plan->passes.size();
        for (const auto& frame : first)
          totals.pictures += frame.size();
        continue;
      }
      totals.other_plans += plan->barriers.size() != first_plan->barriers.size() ||
                            plan->heaps.size() != first_plan->heaps.size() ||
                            plan->transient_bytes != first_plan->transient_bytes;
      totals.shared += plan->transient_bytes < first_plan->transient_bytes;

      EXPECT_TRUE(agrees(interpreted, meant)) << decisions.name;
      for (size_t f = 0; f < first.size() && f < played.size(); ++f)
        for (const auto& [slot, texels] : first[f])
          EXPECT_TRUE(same(slot, texels, played[f]))
              << decisions.name << ": " << slot << ", frame " << f;
    }
    ++totals.graphs;
    for (const ShownFrame& frame : show.frames)
      totals.cuts += frame.cut;
  }

  // Sample statistics for tools are undefined where nothing scatters.
  static bool same(const std::string& slot, const std::vector<std::byte>& texels,
                   const std::map<std::string, std::vector<std::byte>>& others) {
    const auto other = others.find(slot);
    return slot.ends_with("sampling") || (other != others.end() && other->second == texels);
  }

  static constexpr uint32_t random_frames = 4;
};

TEST_F(DeviceFuzz, CompilerOptions_GiveEqualBits) {
  const FuzzSeeds seeds = fuzz_seeds(4);
  Totals totals;
  for (uint64_t seed = seeds.begin; seed < seeds.end && !HasFailure(); ++seed)
    try_graph(seed, totals);
  const std::string reported =
      fmt::format("{} graphs of {} passes, {} interpreted against what they mean; {} plans, {} of "
                  "them unlike the "
                  "first, {} with shared memory, {} without a loan; {} frames, {} cuts; {} "
                  "pictures compared with "
                  "those of each other plan; {}",
                  totals.graphs, totals.passes, totals.references, totals.plans, totals.other_plans,
                  totals.shared, totals.aliased, totals.frames, totals.cuts, totals.pictures,
                  HasFailure() ? "a finding" : "no finding");
  RecordProperty("totals", reported);
  std::printf("%s\n", reported.c_str());
  EXPECT_EQ(totals.graphs, seeds.end - seeds.begin);
  EXPECT_GT(totals.shared, totals.graphs); // Aliasing has to occur in the tested graphs.
}

// Nothing reads its `sampling`. Light of other passes used the memory before, and small mips use it
// after. No barrier that the validation layer can see makes the write available.
TEST_F(DeviceFuzz, UnreadMemory_IsReusedTwice) {
  Totals totals;
  try_graph(51, totals);
  EXPECT_EQ(totals.graphs, 1u);
  EXPECT_GT(totals.shared, 0u);
}

} // namespace
} // namespace dermis::testing
