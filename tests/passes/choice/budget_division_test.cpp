// One budget for several views: the sum stays within the budget, no view starves, and the error is
// less than with equal parts.

#include "passes/choice/budget_division.hpp"
#include "tests/passes/choice/judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace dermis::choice_test {
namespace {

using choice::Offers;
using choice::ViewShare;

Offers offers_of(std::vector<choice::Offer> list) {
  Offers offers;
  std::ranges::copy(list, offers.all.begin());
  offers.count = list.size();
  return offers;
}

choice::Forecast forecast_of(double ms, double rmse) {
  choice::Forecast out;
  out.time.expected_ms = out.time.pessimistic_ms = out.time.optimistic_ms = ms;
  out.time.undisturbed_ms = out.time.usual_ms = ms;
  out.rmse = out.unsampled_rmse = rmse;
  return out;
}

TEST(Offers, OnlyConfigurationsWorthTheirTime) {
  const std::vector<choice::Forecast> forecasts = {forecast_of(3, 0.1), forecast_of(1, 0.5),
                                                   forecast_of(2, 0.6), forecast_of(4, 0.1),
                                                   forecast_of(5, 0.05)};
  const Offers offers = choice::make_offers(forecasts, {});
  ASSERT_EQ(offers.count, 3u);
  const double gap = needed_budget_ms(forecasts[1], 0); // of 1 ms
  EXPECT_GT(gap, 1);
  const std::vector<choice::Offer> expected = {{1, 0.5}, {3, 0.1}, {5, 0.05}};
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(offers.all[i].ms, gap * expected[i].ms, 1e-12);
    EXPECT_EQ(offers.all[i].rmse, expected[i].rmse);
  }
}

TEST(Offers, IncludePartsOfTheSamples) {
  choice::Forecast sampled = forecast_of(1, 0.1);
  sampled.takes_samples = true;
  sampled.demand = 100;
  sampled.time.unit_ms = 0.01;
  sampled.unsampled_rmse = 0.3;
  const Offers offers = choice::make_offers(std::span(&sampled, 1), {});
  ASSERT_EQ(offers.count, 5u);
  EXPECT_NEAR(offers.all[4].ms / offers.all[0].ms, 2, 1e-12);
  EXPECT_DOUBLE_EQ(offers.all[4].rmse, 0.1);
}

TEST(Offers, CheapestOfMany_IsKept) {
  std::vector<choice::Forecast> forecasts;
  for (int i = 20; i > 0; --i) {
    choice::Forecast& one = forecasts.emplace_back(forecast_of(i, 1.0 / i));
    one.takes_samples = true;
    one.demand = 100;
    one.time.unit_ms = 0.001;
    one.unsampled_rmse = 1.01 / i;
  }
  const Offers offers = choice::make_offers(forecasts, {});
  EXPECT_NEAR(offers.all[0].ms, needed_budget_ms(forecasts.back(), 0), 1e-12);
}

TEST(Offers, NothingThatScatters_NeedsTheTimeOfWhatRuns) {
  const std::vector<choice::Forecast> forecasts = {forecast_of(3, 0.1), forecast_of(1, 0.5)};
  choice::DecisionState state;
  restart(state, 2, 0);
  for (const auto& [current, ms] : {std::pair{choice::no_configuration, 1.0}, {0u, 3.0}}) {
    state.current = current;
    const Offers offers = choice::offers_of_idle(forecasts, state);
    ASSERT_EQ(offers.count, 1u);
    EXPECT_NEAR(offers.all[0].ms, ms * needed_budget_ms(forecasts[1], 0), 1e-12);
    EXPECT_EQ(offers.all[0].rmse, 0);
  }
}

// The least squared error within the budget, by trying everything.
double least_square(const std::vector<ViewShare>& views, size_t from, double budget_ms) {
  if (from == views.size()) return 0;
  double least = HUGE_VAL;
  for (const choice::Offer& one : views[from].offers.list())
    if (one.ms <= budget_ms)
      least =
          std::min(least, one.rmse * one.rmse + least_square(views, from + 1, budget_ms - one.ms));
  return least;
}

TEST(Division, HasTheLeastSquaredError) {
  Random random(5);
  for (int test = 0; test < 300; ++test) {
    std::vector<ViewShare> views(1 + random.integer(4));
    std::vector<ViewShare*> pointers;
    double cheapest = 0, most = 0;
    for (ViewShare& view : views) {
      std::vector<choice::Offer> list;
      double ms = random.log_uniform(0.05, 1), rmse = 0.05;
      for (uint64_t i = 0, count = 1 + random.integer(6); i < count; ++i) {
        list.push_back({ms, rmse});
        ms += random.log_uniform(0.05, 2);
        rmse *= random.uniform(0.3, 0.95);
      }
      cheapest += list.front().ms;
      most += list.back().ms;
      view.offers = offers_of(list);
      pointers.push_back(&view);
    }
    const double budget = random.uniform(0.8 * cheapest, 1.2 * most);
    std::vector<double> table(choice::division_table_size(views.size())), parts(views.size());
    const double squares = choice::divide(budget, pointers, table, parts);
    double sum = 0;
    for (const double part : parts)
      sum += part;
    EXPECT_NEAR(sum, 1, 1e-12);
    if (least_square(views, 0, budget) == HUGE_VAL) continue; // nothing fits
    // Each view's offers are rounded up to 1/256 of the budget.
    const double rounded = budget * (1 - double(views.size()) / 256);
    EXPECT_GE(squares, least_square(views, 0, budget) - 1e-12) << test;
    if (least_square(views, 0, rounded) < HUGE_VAL) {
      EXPECT_LE(squares, least_square(views, 0, rounded) + 1e-12) << test;
      double kept = 0; // what the parts allow
      for (size_t v = 0; v < views.size(); ++v) {
        double rmse = HUGE_VAL;
        for (const choice::Offer& one : views[v].offers.list())
          if (one.ms <= parts[v] * budget * (1 + 1e-12)) rmse = one.rmse;
        kept += rmse * rmse;
      }
      EXPECT_LE(kept, squares + 1e-12) << test;
    }
  }
}

TEST(Division, NothingFits_PartsFollowTheCheapest) {
  ViewShare a, b;
  a.offers = offers_of({{3, 0.1}, {4, 0.05}});
  b.offers = offers_of({{1, 0.1}});
  ViewShare* views[] = {&a, &b};
  std::vector<double> table(choice::division_table_size(2)), parts(2);
  choice::divide(2, views, table, parts);
  EXPECT_DOUBLE_EQ(parts[0], 0.75);
  EXPECT_DOUBLE_EQ(parts[1], 0.25);
}

// A disturbance that may be over keeps no configuration from the part that it would need.
TEST(Offers, ConfigurationThatMayReturn_TakesItsUsualTime) {
  std::vector<choice::Forecast> forecasts = {forecast_of(1, 0.5), forecast_of(6, 0.1)};
  forecasts[1].time.usual_ms = 2;
  choice::DecisionState state;
  restart(state, 2, 0);
  state.current = 0;
  state.configurations[1] = {.backoff_s = 4, .left_s = 10, .left_ratio = 1, .ran = true};
  const double gap = needed_budget_ms(forecasts[0], 0); // of 1 ms
  for (const auto& [clock_s, ms] : {std::pair{13.0, 6.0}, {14.1, 2.0}}) {
    state.clock_s = clock_s;
    EXPECT_NEAR(choice::make_offers(forecasts, state).all[1].ms, gap * ms, 1e-12) << clock_s;
  }
  state.current = 1;
  EXPECT_NEAR(choice::make_offers(forecasts, state).all[1].ms, gap * 6, 1e-12) << "runs";
}

struct Rounds : ::testing::Test {
  choice::BudgetDivision division;
  ViewShare a, b;
  Offers large = offers_of({{1, 0.05}, {6, 0.01}}), small = offers_of({{0.5, 0.05}, {2, 0.001}});
  double of_a = 0, of_b = 0;

  void SetUp() override {
    division.add(a);
    division.add(b);
  }
  void frame(bool counted = true, bool with_b = true) {
    of_a = division.share(a, 10, large, counted, 0.1);
    of_b = with_b ? division.share(b, 10, small, counted, 0.1) : 0;
    EXPECT_LE(of_a + of_b, 10 * (1 + 1e-12));
  }
};

TEST_F(Rounds, PartsAreEqual_UntilTilesAreCounted) {
  for (int i = 0; i < 30; ++i) {
    frame(false);
    EXPECT_DOUBLE_EQ(of_a, 5);
  }
  frame();
  frame();
  EXPECT_DOUBLE_EQ(of_a, 7.5); // 6 of 8 ms
}

TEST_F(Rounds, PartsChangeOncePerSecondAtMost) {
  for (int i = 0; i < 4; ++i)
    frame();
  EXPECT_DOUBLE_EQ(of_a, 7.5);
  std::swap(large, small);
  int frames = 0;
  for (; of_a > 5 && frames < 40; ++frames)
    frame();
  EXPECT_GE(frames, 6);
  EXPECT_LE(frames, 11); // a tenth of a second each
  EXPECT_DOUBLE_EQ(of_a, 2.5);
}

TEST_F(Rounds, SlightlyBetterDivisions_ChangeNothing) {
  for (int i = 0; i < 4; ++i)
    frame();
  large.all[1].ms = 6.5;
  for (int i = 0; i < 40; ++i)
    frame();
  EXPECT_DOUBLE_EQ(of_a, 7.5);
}

TEST_F(Rounds, AbsentView_GivesItsPartToTheOthers) {
  for (int i = 0; i < 4; ++i)
    frame();
  for (int i = 0; i < 12; ++i)
    frame(true, false);
  EXPECT_DOUBLE_EQ(of_a, 10);
  division.share(b, 10, small, true, 0.1);
  frame();
  EXPECT_DOUBLE_EQ(of_b, 2.5) << "and gets it back";
  division.remove(b);
  for (int i = 0; i < 2; ++i)
    of_a = division.share(a, 10, large, true, 0.1);
  EXPECT_DOUBLE_EQ(of_a, 10);
}

TEST_F(Rounds, ViewThatReturnsAsAnotherGoes_DoesNotExceedTheBudget) {
  ViewShare c;
  division.add(c);
  for (int i = 0; i < 4; ++i) {
    frame();
    division.share(c, 10, small, true, 0.1);
  }
  for (int i = 0; i < 12; ++i)
    frame(); // without c
  division.remove(b);
  const double of_c = division.share(c, 10, small, true, 0.1); // in the next frame, before a
  of_a = division.share(a, 10, large, true, 0.1);
  EXPECT_LE(of_a + of_c, 10 * (1 + 1e-9));
  division.remove(c);
}

// A character enters the view of a security camera, which was recorded all the time.
TEST_F(Rounds, EmptyViewThatHasWorkAgain_GetsItsPartAtOnce) {
  for (int i = 0; i < 30; ++i) {
    of_a = division.share(a, 10, large, true, 0.1);
    division.share(b, 10, choice::offers_of_no_work(), true, 0.1);
  }
  EXPECT_GT(of_a, 9.99);
  of_a = division.share(a, 10, large, true, 0.1);
  EXPECT_DOUBLE_EQ(division.share(b, 10, small, true, 0.1), 2.5);
}

// A camera approaches, so that what `b` needs at least grows.
TEST_F(Rounds, CheapestOfferThatGrew_GetsItsPart) {
  large = offers_of({{1, 0.05}, {7.9, 0.01}});
  small = offers_of({{0.5, 0.05}});
  for (int i = 0; i < 4; ++i)
    frame();
  EXPECT_LT(of_b, 1);
  small = offers_of({{3, 0.05}});
  for (int i = 0; i < 12; ++i)
    frame();
  EXPECT_GE(of_b, 3);
  large = offers_of({{8, 0.05}}); // not both fit
  small = offers_of({{4, 0.05}});
  for (int i = 0; i < 12; ++i)
    frame();
  EXPECT_NEAR(of_b, 10.0 / 3, 1e-9);
}

TEST_F(Rounds, EmptyViewThatHasWorkAgain_NextToANewOne_HasAPart) {
  for (int i = 0; i < 4; ++i) {
    division.share(a, 10, large, true, 0.1);
    division.share(b, 10, choice::offers_of_no_work(), true, 0.1);
  }
  ViewShare c;
  division.add(c);
  division.share(a, 10, large, true, 0.1);
  division.share(c, 10, small, false, 0.1);
  EXPECT_GT(division.share(b, 10, small, true, 0.1), 1);
  division.remove(c);
}

// Another new view keeps the parts from being divided.
TEST_F(Rounds, NewView_HasAPartFromItsFirstFrame) {
  for (int i = 0; i < 4; ++i)
    of_a = division.share(a, 10, large, true, 0.1);
  ViewShare c;
  division.add(c);
  EXPECT_GT(division.share(b, 10, choice::offers_of_no_work(), true, 0.1), 0.1);
  division.remove(c);
}

// A mirror that is rendered in each twelfth frame.
TEST_F(Rounds, RareView_KeepsItsPart) {
  for (int i = 0; i < 120; ++i) {
    const bool with_b = i % 12 == 0;
    of_a = division.share(a, 10, large, true, 0.016);
    if (with_b) of_b = division.share(b, 10, small, true, 0.2);
    if (i < 60) continue;
    EXPECT_DOUBLE_EQ(of_a, 7.5) << i;
    EXPECT_DOUBLE_EQ(of_b, 2.5) << i;
  }
}

TEST_F(Rounds, DiscardedFrames_DoNotEndARound) {
  constexpr int discarded = 10; // more rounds than a rare view is waited for, if each ended one
  for (int i = 0; i < 120; ++i) {
    for (int frame = 0; frame <= discarded; ++frame) {
      of_a = division.share(a, 10, large, true, 0.016);
      if (frame < discarded) division.repeat(a);
    }
    if (i % 12 == 0) of_b = division.share(b, 10, small, true, 0.2);
    if (i < 60) continue;
    EXPECT_DOUBLE_EQ(of_a, 7.5) << i;
    EXPECT_DOUBLE_EQ(of_b, 2.5) << i;
  }
}

// Views of one graph on one device, that show different amounts of subsurface.
class SimulatedViews {
public:
  SimulatedViews(uint64_t seed, double budget_position, bool equal_parts)
      : random_(seed + 77), equal_parts_(equal_parts) {
    const Scenario base = make_scenario(Disturbance::none, seed);
    const size_t count = 2 + seed % 3;
    double least = 0, scattering = 0, most = 0;
    for (size_t v = 0; v < count; ++v) {
      One& one = *views_.emplace_back(std::make_unique<One>(base));
      one.scenario.tiles = std::floor(base.tiles * random_.log_uniform(0.05, 1));
      set_frames(one.scenario, frames);
      one.device = std::make_unique<SimulatedDevice>(one.scenario, seed + 1000 * (v + 1));
      one.graph = std::make_unique<ControlledGraph>(one.scenario, LoopOptions{});
      one.pipeline = std::make_unique<Pipeline>(*one.graph, one.scenario);
      one.find_costs();
      least += one.least_ms;
      scattering += one.scattering_ms;
      most += one.most_ms;
      division_.add(one.share);
    }
    budget_ms_ = 1.3 * least * std::pow(most / least, budget_position);
    all_can_scatter_ = 1.4 * scattering < budget_ms_;
  }

  void run() {
    for (int t = 0; t < frames; ++t) {
      double sum_ms = 0, shares = 0, squares = 0;
      for (const auto& view : views_) {
        One& one = *view;
        one.pipeline->finish_oldest();
        const std::optional<double> tiles =
            t >= one.scenario.latency ? std::optional(one.scenario.tiles) : std::nullopt;
        const double divided = division_.share(one.share, budget_ms_, one.graph->offers(tiles),
                                               tiles.has_value(), frame_seconds);
        const double part = equal_parts_ ? budget_ms_ / double(views_.size()) : divided;
        choice::Decision decision = one.graph->decide(part, tiles);
        decision.units = std::min(std::floor(decision.units), requested_units(one.scenario.tiles));
        sum_ms += one.pipeline->run(*one.device, decision, t).total_ms;
        shares += part;
        const SimulatedConfiguration& ran = one.scenario.configurations[decision.configuration];
        squares += std::pow(rmse_of(ran, decision.units, one.scenario.tiles), 2);
        if (t < first_counted) continue;
        starved += part < one.least_ms ? 1 : 0;
        one.unscattered += decision.configuration == 0 ? 1.0 / (frames - first_counted) : 0;
      }
      EXPECT_LE(shares, budget_ms_ * (1 + 1e-9)) << t;
      if (t < first_counted) continue;
      late += sum_ms > budget_ms_ ? 1.0 / (frames - first_counted) : 0;
      mean_square += squares / double(views_.size()) / (frames - first_counted);
    }
    for (const auto& one : views_)
      unscattered = std::max(unscattered, one->unscattered);
  }

  static constexpr int frames = 3600, first_counted = 600;
  double late = 0, mean_square = 0;
  double unscattered = 0; // fraction of the frames of the worst view
  int starved = 0;
  bool all_can_scatter() const { return all_can_scatter_; }

private:
  struct One {
    explicit One(const Scenario& base) : scenario(base) {}
    void find_costs() {
      for (size_t c = 0; c < scenario.configurations.size(); ++c) {
        double ms = 0;
        for (const uint32_t pass : scenario.configurations[c].passes)
          ms += true_ms(scenario, pass, groups_of(scenario, pass, scenario.tiles), 0);
        least_ms = std::min(least_ms, ms);
        if (c > 0) scattering_ms = std::min(scattering_ms, ms);
        most_ms = std::max(most_ms, ms);
      }
    }
    Scenario scenario;
    std::unique_ptr<SimulatedDevice> device;
    std::unique_ptr<ControlledGraph> graph;
    std::unique_ptr<Pipeline> pipeline;
    ViewShare share;
    double least_ms = 1e9, scattering_ms = 1e9, most_ms = 0, unscattered = 0;
  };

  Random random_;
  bool equal_parts_ = false, all_can_scatter_ = false;
  choice::BudgetDivision division_;
  std::vector<std::unique_ptr<One>> views_;
  double budget_ms_ = 0;
};

TEST(SeveralViews, SumIsWithinTheBudgetAndNoneStarves) {
  constexpr uint64_t scenarios = 24;
  double log_ratio = 0, worst_late = 0, worst_unscattered = 0;
  int runs = 0, could_scatter = 0, worse = 0;
  for (uint64_t seed = 0; seed < scenarios; ++seed)
    for (const double position : {0.3, 0.5, 0.8}) {
      SimulatedViews divided(seed, position, false), equal(seed, position, true);
      divided.run();
      equal.run();
      EXPECT_EQ(divided.starved, 0) << seed << " at " << position;
      EXPECT_LE(divided.late, 0.05) << seed << " at " << position;
      worst_late = std::max(worst_late, divided.late);
      if (divided.all_can_scatter()) {
        ++could_scatter;
        EXPECT_LE(divided.unscattered, 0.10) << seed << " at " << position;
        worst_unscattered = std::max(worst_unscattered, divided.unscattered);
      }
      worse += divided.mean_square > 1.25 * equal.mean_square ? 1 : 0;
      log_ratio += std::log(divided.mean_square / equal.mean_square);
      ++runs;
    }
  std::printf("%d runs: squared error %.2f of that with equal parts, worse in %d; worst late %.3f, "
              "worst unscattered %.3f of %d runs\n",
              runs, std::exp(log_ratio / runs), worse, worst_late, worst_unscattered,
              could_scatter);
  EXPECT_LT(log_ratio / runs, std::log(0.6));
  EXPECT_LE(worse, runs / 20);
  EXPECT_GT(could_scatter, runs / 3);
}

} // namespace
} // namespace dermis::choice_test
