// Tests the debug fill: results do not change if only written memory is read, and reads of
// undefined memory give NaN.
#include "tests/framegraph/vulkan/executor_fixture.hpp"

#include <cmath>

namespace dermis::testing {
namespace {

constexpr uint32_t wide = 24, high = 16;

class PoisonTest : public ExecutorTest {
protected:
  std::vector<float> run(const SmallGraph& graph, bool with_poison, vulkan::Rectangle rectangle) {
    poison = with_poison;
    make_executor(graph, wide, high);
    images.clear();
    const TestImage result = bind(graph, "result", std::vector<float>(wide * high, 0.0f));
    for (int i = 0; i < 3; ++i)
      EXPECT_FALSE(frame(static_cast<float>(i), rectangle));
    const std::vector<float> texels = read(result);
    wait();
    executor.reset();
    frame_index = 0;
    return texels;
  }
};

TEST_F(PoisonTest, ResultsDoNotDependOnUndefinedMemory) {
  SmallGraph g{"export result"};
  g.image("parts").mips = 2;
  g.history("count");
  g.buffer("classes", 0);
  g.buffer("tiles", 1);
  g.buffer("arguments", 4);
  g.image("marked");
  g.image("sum");
  g.pass("fill", "test.fill", {}, {{"target", "parts#0"}});
  g.pass("small", "test.fill", {}, {{"target", "parts#1"}});
  g.set(g.pass("step", "test.add", {{"a", "count@-1"}, {"b", "parts#0"}}, {{"target", "count"}}),
        "bias", 1);
  g.pass("classify", "test.classes", {}, {{"classes", "classes"}});
  g.pass("list", "test.list", {{"classes", "classes"}},
         {{"tiles", "tiles"}, {"arguments", "arguments"}});
  g.pass("clear", "test.clear", {}, {{"target", "marked"}});
  g.pass("mark", "test.mark", {{"tiles", "tiles"}, {"arguments", "arguments"}},
         {{"target", "marked"}});
  g.pass("sum", "test.add", {{"a", "count"}, {"b", "marked"}}, {{"target", "sum"}});
  g.pass("show", "test.add", {{"a", "sum"}}, {{"target", "result"}});
  const std::vector<float> plain = run(g, false, {}), poisoned = run(g, true, {});
  EXPECT_EQ(plain, poisoned);
  EXPECT_GT(poisoned[0], 0.0f); // Not NaN and not zero.
}

TEST_F(PoisonTest, UndefinedMemoryIsNaN) {
  SmallGraph g{"export result", "image first"};
  g.pass("fill", "test.fill", {}, {{"target", "first"}});
  // A quarter of the next texel.
  g.pass("blur", "test.sample", {{"a", "first"}}, {{"target", "result"}});
  constexpr uint32_t inside = 8;
  const std::vector<float> texels = run(g, true, {0, 0, inside, inside});
  EXPECT_FALSE(std::isnan(texels[inside - 2]));
  EXPECT_TRUE(std::isnan(texels[inside - 1])) << "the next texel lies outside of the rectangle";
}

TEST_F(PoisonTest, NeedsAPlanCompiledForIt) {
  SmallGraph g{"export result", "image first"};
  g.pass("fill", "test.fill", {}, {{"target", "first"}});
  g.pass("show", "test.add", {{"a", "first"}}, {{"target", "result"}});
  const Plan plan = g.compile(profile, wide, high);
  poison = true;
  const vulkan::Error error = try_executor(g, plan, dermis_device, executor);
  EXPECT_EQ(error.kind, vulkan::ErrorKind::argument);
  EXPECT_NE(error.text.find("poison"), std::string::npos);
}

} // namespace
} // namespace dermis::testing
