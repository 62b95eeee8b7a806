// Configurations of a graph share memory, also that of histories which no other one has.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace dermis::abi_test {
namespace {

struct SharedMemory : DermisTest {
  void use_flags(uint32_t flags) {
    for (const dermis_graph graph : graphs)
      dermis_graph_destroy(graph);
    graphs.clear();
    images.clear();
    last_frame = 0;
    share_context(flags);
  }
  // Makes the row of the error table the best one, so that the choice takes its technique.
  static void prefer(dermis_graph graph, const std::string& row) {
    std::string table = read_text("configs/choice/errors.json");
    const size_t name = table.find("\"name\": \"" + row + "\"");
    ASSERT_NE(name, std::string::npos) << row;
    const size_t first = table.find("[[", name), last = table.find("]]", first);
    table.replace(first, last + 2 - first, "[[1, 1e-9, 1]]");
    const dermis_source errors = source_of(table, "errors");
    dermis_budget budget = budget_of(1e6f, DERMIS_BUDGET_DETERMINISTIC);
    budget.errors = &errors;
    dermis_report report = nullptr;
    ASSERT_OK(dermis_graph_set_budget(graph, &budget, &report)) << take(report).all;
    dermis_report_destroy(report);
  }
  struct Run {
    std::vector<std::string> techniques;      // by frame
    std::vector<std::vector<float>> pictures; // by frame
    dermis_memory memory = DERMIS_MEMORY_INIT;
  };
  // Runs a few frames of the technique of each row, one after another.
  Run frames_of(const std::vector<std::string>& rows) {
    Run out;
    const dermis_graph graph = make_bound_graph(shipped_options("configs/graphs/skin.json"));
    for (const std::string& row : rows) {
      prefer(graph, row);
      for (int i = 0; i < 3; ++i) {
        fill("lighting", [&](uint32_t x, uint32_t y) {
          return float(0.5 + 0.4 * std::sin(0.9 * x) * std::sin(0.7 * y));
        });
        dermis_frame one = bound_frame(graph);
        one.delta_seconds = 60;
        rest(one);
        out.techniques.push_back(record_and_read(graph, one).configuration);
        out.pictures.push_back(texels("lighting"));
      }
    }
    out.memory = memory_of(graph);
    return out;
  }
};

TEST_F(SharedMemory, PicturesEqualThoseOfSeparateHistories) {
  const std::vector<std::string> rows = {"afis over frames", "sap smooth", "afis over frames",
                                         "hybrid smooth",    "sap base",   "afis over frames"};
  use_flags(0);
  const Run shared = frames_of(rows);
  use_flags(DERMIS_CONTEXT_SEPARATE_HISTORIES);
  const Run separate = frames_of(rows);
  EXPECT_EQ(shared.techniques, separate.techniques);
  EXPECT_THAT(shared.techniques, ::testing::Contains("technique=afis"));
  EXPECT_THAT(shared.techniques, ::testing::Contains(HasSubstr("technique=sap")));
  EXPECT_THAT(shared.techniques, ::testing::Contains(HasSubstr("technique=hybrid")));
  for (size_t t = 0; t < shared.pictures.size(); ++t)
    EXPECT_TRUE(shared.pictures[t] == separate.pictures[t])
        << "frame " << t << ", " << shared.techniques[t];
  EXPECT_GT(separate.memory.transient_bytes, 0u);
  EXPECT_LT(shared.memory.transient_bytes + shared.memory.history_bytes,
            separate.memory.transient_bytes + separate.memory.history_bytes);
}

} // namespace
} // namespace dermis::abi_test
