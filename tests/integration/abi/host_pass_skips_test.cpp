// Passes of the host where nothing scatters: without a profile, and in frames with empty bounds.

#include "tests/integration/abi/dermis_fixture.hpp"

namespace dermis::abi_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

void DERMIS_CALL keep_name(void* user, const dermis_pass_call* call) {
  std::string name = call->pass;
  for (uint32_t p = 0; p < call->port_count; ++p)
    if (call->ports[p].image == VK_NULL_HANDLE) name += " -";
  static_cast<std::vector<std::string>*>(user)->push_back(name);
}

struct HostPassSkips : DermisTest {
  std::vector<std::string> calls;
  dermis_graph graph = nullptr;

  void SetUp() override {
    DermisTest::SetUp();
    if (IsSkipped()) return;
    add("studio.make", {{"out", DERMIS_PORT_STORAGE_IMAGE_WRITE, false}}, false);
    add("studio.tone",
        {{"from", DERMIS_PORT_SAMPLED_IMAGE, false}, {"out", DERMIS_PORT_STORAGE_IMAGE_WRITE, false}}, false);
    add("studio.maybe",
        {{"from", DERMIS_PORT_SAMPLED_IMAGE, true}, {"out", DERMIS_PORT_STORAGE_IMAGE_WRITE, false}}, false);
    add("studio.scatter", {{"out", DERMIS_PORT_STORAGE_IMAGE_WRITE, false}}, true);
    add("studio.count", {{"out", DERMIS_PORT_STORAGE_IMAGE_WRITE, false}}, false, true);
  }

  struct PortOf {
    const char* name;
    dermis_port_usage usage;
    bool optional;
  };
  void add(const char* name, const std::vector<PortOf>& ports, bool serves, bool side_effects = false) {
    std::vector<dermis_port> made;
    for (const PortOf& port : ports) {
      made.push_back(dermis_port DERMIS_PORT_INIT);
      made.back().name = port.name;
      made.back().usage = port.usage;
      made.back().optional = port.optional ? 1 : 0;
    }
    dermis_pass_kind kind = DERMIS_PASS_KIND_INIT;
    kind.name = name;
    kind.ports = made.data();
    kind.port_count = static_cast<uint32_t>(made.size());
    kind.record = keep_name;
    kind.user = &calls;
    kind.serves_scattering = serves ? 1 : 0;
    kind.side_effects = side_effects ? 1 : 0;
    ASSERT_EQ(dermis_register_pass_kind(context, &kind), DERMIS_OK) << dermis_last_error();
  }

  // Runs one frame of a graph with `passes`, whose optional export is `toned`.
  void run(const std::string& passes, bool profiles, uint32_t flags) {
    calls.clear();
    const std::string image = R"({ "format": "rgba16f", "size": "view" })";
    GraphOptions options;
    options.text = R"({ "dermis": 1, "name": "skips", "imports": { "given": )" + image +
                   R"( }, "resources": { "lit": )" + image +
                   R"(, "toned": { "format": "rgba16f", "size": "view", "optional": true } },
      "passes": [ )" +
                   passes + R"( ], "exports": ["toned"] })";
    options.unbound = {};
    options.formats = {};
    options.profiles = profiles;
    graph = make_graph(options);
    ASSERT_NE(graph, nullptr);
    make_images(graph);
    const auto bound = bindings(graph);
    dermis_frame one = frame(bound);
    one.flags = flags;
    ASSERT_EQ(record(graph, one), DERMIS_OK) << dermis_last_error();
  }
  std::string described() {
    std::string text(100000, ' ');
    size_t size = text.size();
    EXPECT_EQ(dermis_graph_describe(graph, DERMIS_DESCRIBE_TEXT, &size, text.data()), DERMIS_OK);
    return text.substr(0, size);
  }
};

struct Way {
  bool profiles;
  uint32_t flags;
};
constexpr Way nothing_scatters[] = {{false, 0}, {true, DERMIS_FRAME_BOUNDS}};

TEST_F(HostPassSkips, HostPassesRunWhereNothingScatters) {
  for (const Way& way : nothing_scatters) {
    run(R"({ "pass": "make", "kind": "studio.make", "write": { "out": "toned" } })", way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("make")) << way.profiles;
    run(R"({ "pass": "tone", "kind": "studio.tone", "read": { "from": "given" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("tone")) << way.profiles;
    run(R"({ "pass": "count", "kind": "studio.count", "write": { "out": "lit" } },
           { "pass": "make", "kind": "studio.make", "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("count", "make")) << "a pass with side effects";
  }
}

TEST_F(HostPassSkips, InputsOfSkippedPassesAreUnboundOrSkip) {
  const std::string scatter =
      R"({ "pass": "scatter", "kind": "studio.scatter", "write": { "out": "lit" } }, )";
  for (const Way& way : nothing_scatters) {
    run(scatter +
            R"({ "pass": "maybe", "kind": "studio.maybe", "read": { "from": "lit" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("maybe -")) << way.profiles;
    run(scatter +
            R"({ "pass": "tone", "kind": "studio.tone", "read": { "from": "lit" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, IsEmpty()) << way.profiles;
    EXPECT_THAT(described(), HasSubstr("it reads 'lit', which only passes that"));
    EXPECT_THAT(described(), Not(HasSubstr("'when' is false")));
  }
}

TEST_F(HostPassSkips, OtherwiseStandsInWithoutAProfile) {
  run(R"({ "pass": "scatter", "kind": "studio.scatter", "write": { "out": "lit" }, "otherwise": { "lit": "given" } },
         { "pass": "tone", "kind": "studio.tone", "read": { "from": "lit" }, "write": { "out": "toned" } })",
      false, 0);
  EXPECT_THAT(calls, ElementsAre("tone"));
  EXPECT_THAT(described(), HasSubstr("off: its kind serves scattering, and the graph has no profile"));
}

} // namespace
} // namespace dermis::abi_test
