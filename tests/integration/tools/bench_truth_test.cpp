// Tests `dermis bench truth`: rows, exit codes and messages.
#include "tests/framegraph/test_scale.hpp"
#include "tests/integration/tools/command_fixture.hpp"

namespace {

using namespace dermis::test;
using ::testing::HasSubstr;

class BenchReference : public CommandTest {
protected:
  std::string property_file(const std::string& tolerances) const {
    return write("laws.json",
                 R"({ "dermis_benchmark": 1, "truth": { "white_furnace": 1e-6 }, "techniques": [
      { "technique": "separable", "setting": "taps=11", "graph": "configs/graphs/separable.json",
        "set": { "taps": "11" }, "tolerances": )" +
                     tolerances + R"( },
      { "technique": "unheard_of", "setting": "n=1", "graph": "configs/graphs/none.json", "tolerances": {} } ] })");
  }
};

TEST_F(BenchReference, PrintsExpectedAndMeasured_FailureIsAProblem) {
  const Outcome outcome =
      run({"bench", "truth", "--file", property_file(R"({ "white_furnace": 0.001, "edge": 1e-9 })"),
           "--json", path("out.json")}); // No fp16 picture is that exact.
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.out, ::testing::Not(HasSubstr("\n0 of ")));
  EXPECT_THAT(outcome.out, HasSubstr("graph 'configs/graphs/none.json' does not exist"));
  for (const char* property :
       {"cdf(0.5 d)", "edge at 8 d", "E[w r^2]", "harmonic 4", "edge: mean of a column",
        "sinusoid_45: contrast", "disc: centre", "parabola", "tilted_edge_60"})
    EXPECT_THAT(outcome.out, HasSubstr(property)) << property;
  EXPECT_EQ(files(), (std::vector<std::string>{"laws.json", "out.json"}));
  EXPECT_THAT(read("out.json"), HasSubstr(R"("holds": false)"));
}

TEST_F(BenchReference, SucceedsIfAllPropertiesHold) {
  DERMIS_FULL_TESTS_ONLY();
  EXPECT_THAT(run({"bench", "truth", "--file", property_file(R"({ "white_furnace": 0.001 })"),
                   "--json", "-"}),
              Succeeds(IsJson(), ::testing::Not(HasSubstr(R"("holds": false)"))));
}

TEST_F(BenchReference, MisspeltProperty_SuggestsTheNearest) {
  EXPECT_THAT(run({"bench", "truth", "--file", property_file(R"({ "white_furnaces": 1 })")}),
              FailsWith(1, "white_furnace", "laws.json:3:"));
}

} // namespace
