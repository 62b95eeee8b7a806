// Tests host passes when nothing scatters: without a profile, and in frames with empty bounds.

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
    if (call->ports[p].image == VK_NULL_HANDLE && call->ports[p].buffer == VK_NULL_HANDLE) name += " -";
  static_cast<std::vector<std::string>*>(user)->push_back(name);
}

struct HostPassSkips : DermisTest {
  std::vector<std::string> calls;
  dermis_graph graph = nullptr;
  bool export_is_optional = true;

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
    add("studio.change", {{"out", DERMIS_PORT_STORAGE_IMAGE_UPDATE, false}}, false);
    add("studio.scatter_list", {{"list", DERMIS_PORT_STORAGE_BUFFER_WRITE, false}}, true);
    add("studio.use_list",
        {{"list", DERMIS_PORT_STORAGE_BUFFER_READ, false}, {"out", DERMIS_PORT_STORAGE_IMAGE_WRITE, false}},
        false);
    add("studio.remember",
        {{"from", DERMIS_PORT_SAMPLED_IMAGE, false},
         {"before", DERMIS_PORT_SAMPLED_IMAGE, true},
         {"out", DERMIS_PORT_STORAGE_IMAGE_WRITE, false}},
        false);
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
    dermis_pass_type type = DERMIS_PASS_TYPE_INIT;
    type.name = name;
    type.ports = made.data();
    type.port_count = static_cast<uint32_t>(made.size());
    type.record = keep_name;
    type.user = &calls;
    type.serves_scattering = serves ? 1 : 0;
    type.side_effects = side_effects ? 1 : 0;
    ASSERT_EQ(dermis_register_pass_type(context, &type), DERMIS_OK) << dermis_last_error();
  }

  // Makes a graph with `passes`, whose export is `toned`, and records a frame.
  void run(const std::string& passes, bool profiles, uint32_t flags) {
    calls.clear();
    const std::string image = R"({ "format": "rgba16f", "size": "view" })";
    GraphOptions options;
    options.text = R"({ "dermis": 2, "name": "skips", "imports": { "given": )" + image +
                   R"( }, "resources": { "list": { "buffer": { "stride": 4, "count": [16, 1] } },
                   "usual": { "buffer": { "stride": 4, "count": [16, 1] } },
                   "kept": { "format": "rgba16f", "size": "view", "history": { "frames": 1 } },
                   "chain": { "format": "rgba16f", "size": "view", "mips": 2 }, "lit": )" +
                   image + R"(, "toned": { "format": "rgba16f", "size": "view", "optional": )" +
                   (export_is_optional ? "true" : "false") + R"( } },
      "passes": [ )" +
                   passes + R"( ], "exports": ["toned"] })";
    options.unbound = {};
    options.formats = {};
    options.profiles = profiles;
    graph = make_graph(options);
    ASSERT_NE(graph, nullptr);
    make_images(graph);
    again(flags);
  }
  void again(uint32_t flags) { // Records the next frame.
    calls.clear();
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
    run(R"({ "pass": "make", "type": "studio.make", "write": { "out": "toned" } })", way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("make")) << way.profiles;
    run(R"({ "pass": "tone", "type": "studio.tone", "read": { "from": "given" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("tone")) << way.profiles;
    run(R"({ "pass": "count", "type": "studio.count", "write": { "out": "lit" } },
           { "pass": "make", "type": "studio.make", "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("count", "make")) << "a pass with side effects";
  }
}

TEST_F(HostPassSkips, InputsOfSkippedPassesAreUnboundOrSkip) {
  const std::string scatter =
      R"({ "pass": "scatter", "type": "studio.scatter", "write": { "out": "lit" } }, )";
  for (const Way& way : nothing_scatters) {
    run(scatter +
            R"({ "pass": "maybe", "type": "studio.maybe", "read": { "from": "lit" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("maybe -")) << way.profiles;
    run(scatter +
            R"({ "pass": "tone", "type": "studio.tone", "read": { "from": "lit" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, IsEmpty()) << way.profiles;
    EXPECT_THAT(described(),
                ::testing::AnyOf(HasSubstr("it reads 'lit', whose producers are off"),
                                 HasSubstr("it reads 'lit', which only scattering passes write")));
    EXPECT_THAT(described(), Not(HasSubstr("'when' is false")));
  }
}

TEST_F(HostPassSkips, OtherwiseIsRead) {
  for (const Way& way : nothing_scatters) {
    run(R"({ "pass": "scatter", "type": "studio.scatter", "write": { "out": "lit" }, "otherwise": { "lit": "given" } },
           { "pass": "tone", "type": "studio.tone", "read": { "from": "lit" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("tone")) << way.profiles;
    if (way.profiles) continue;
    EXPECT_THAT(described(),
                HasSubstr("off: its pass type only serves scattering, and the graph has no profile"));
  }
}

// The export keeps its contents, because no pass of such a frame writes it.
TEST_F(HostPassSkips, RequiredExport_KeepsContentsInEmptyFrames) {
  export_is_optional = false;
  const std::string scatter =
      R"({ "pass": "scatter", "type": "studio.scatter", "write": { "out": "lit" } }, )";
  const std::string tone =
      R"({ "pass": "tone", "type": "studio.tone", "read": { "from": "lit" }, "write": { "out": "toned" } })";
  run(scatter + tone, true, 0);
  EXPECT_THAT(calls, ElementsAre("scatter", "tone"));
  again(DERMIS_FRAME_BOUNDS);
  EXPECT_THAT(calls, IsEmpty());
  again(0);
  EXPECT_THAT(calls, ElementsAre("scatter", "tone"));
}

TEST_F(HostPassSkips, BufferOtherwise_IsRead) {
  for (const Way& way : nothing_scatters) {
    run(R"({ "pass": "usual", "type": "clear", "write": { "target": "usual" } },
           { "pass": "list", "type": "studio.scatter_list", "write": { "list": "list" }, "otherwise": { "list": "usual" } },
           { "pass": "use", "type": "studio.use_list", "read": { "list": "list" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("use")) << way.profiles;
  }
}

TEST_F(HostPassSkips, AnUpdateNeedsContents) {
  const std::string scatter =
                        R"({ "pass": "scatter", "type": "studio.scatter", "write": { "out": "toned" } }, )",
                    change = R"({ "pass": "change", "type": "studio.change", "write": { "out": "toned" } })";
  for (const Way& way : nothing_scatters) {
    run(scatter + change, way.profiles, way.flags);
    EXPECT_THAT(calls, IsEmpty()) << way.profiles;
    EXPECT_THAT(described(),
                ::testing::AnyOf(HasSubstr("it reads 'toned', whose producers are off"),
                                 HasSubstr("it reads 'toned', which only scattering passes write")));
    run(R"({ "pass": "make", "type": "studio.make", "write": { "out": "toned" } }, )" + change, way.profiles,
        way.flags);
    EXPECT_THAT(calls, ElementsAre("make", "change")) << way.profiles;
  }
}

TEST_F(HostPassSkips, SkippedPass_SkipsItsReaders) {
  for (const Way& way : nothing_scatters) {
    run(R"({ "pass": "scatter", "type": "studio.scatter", "write": { "out": "lit" } },
           { "pass": "first", "type": "studio.tone", "read": { "from": "lit" }, "write": { "out": "kept" } },
           { "pass": "second", "type": "studio.maybe", "read": { "from": "kept" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("second -")) << way.profiles;
  }
}

TEST_F(HostPassSkips, MipsHaveSeparateWriters) {
  const std::string chain = R"({ "pass": "make", "type": "studio.make", "write": { "out": "chain#0" } },
      { "pass": "scatter", "type": "studio.scatter", "write": { "out": "chain#1" } }, )";
  run(chain +
          R"({ "pass": "tone", "type": "studio.tone", "read": { "from": "chain#0" }, "write": { "out": "toned" } })",
      true, DERMIS_FRAME_BOUNDS);
  EXPECT_THAT(calls, ElementsAre("make", "tone"));
  run(chain +
          R"({ "pass": "maybe", "type": "studio.maybe", "read": { "from": "chain#1" }, "write": { "out": "toned" } })",
      true, DERMIS_FRAME_BOUNDS);
  EXPECT_THAT(calls, ElementsAre("maybe -"));
  for (const Way& way : nothing_scatters) {
    run(chain +
            R"({ "pass": "maybe", "type": "studio.maybe", "read": { "from": "chain" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, ElementsAre("maybe -")) << way.profiles;
    run(chain +
            R"({ "pass": "tone", "type": "studio.tone", "read": { "from": "chain#1" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, IsEmpty()) << way.profiles;
    run(chain +
            R"({ "pass": "tone", "type": "studio.tone", "read": { "from": "chain" }, "write": { "out": "toned" } })",
        way.profiles, way.flags);
    EXPECT_THAT(calls, IsEmpty()) << way.profiles;
  }
}

TEST_F(HostPassSkips, DiscardedFrame_IsRevertedInBothPlans) {
  run(R"({ "pass": "scatter", "type": "studio.scatter", "write": { "out": "lit" }, "otherwise": { "lit": "given" } },
         { "pass": "remember", "type": "studio.remember", "read": { "from": "lit", "before": "kept@-1" },
           "write": { "out": "kept" } },
         { "pass": "tone", "type": "studio.tone", "read": { "from": "kept" }, "write": { "out": "toned" } })",
      true, 0);
  const auto age = [&] {
    uint32_t count = 1;
    dermis_history history = DERMIS_HISTORY_INIT;
    EXPECT_EQ(dermis_view_histories(dermis_graph_view(graph), &count, &history), DERMIS_OK)
        << dermis_last_error();
    return history.age;
  };
  ASSERT_EQ(age(), 1u);
  const auto bound = bindings(graph);
  dermis_frame empty = frame(bound);
  empty.flags = DERMIS_FRAME_BOUNDS;
  uint32_t count = 0;
  const dermis_command* commands = nullptr;
  ASSERT_EQ(dermis_view_commands(dermis_graph_view(graph), &empty, &count, &commands), DERMIS_OK)
      << dermis_last_error();
  EXPECT_EQ(age(), 2u);
  ASSERT_EQ(dermis_view_discard(dermis_graph_view(graph), empty.frame_index), DERMIS_OK)
      << dermis_last_error();
  EXPECT_EQ(age(), 1u);
  again(0);
  EXPECT_THAT(calls, ElementsAre("scatter", "remember", "tone"));
  EXPECT_EQ(age(), 2u);
}

TEST_F(HostPassSkips, AlternatingPlans_KeepTheHostsHistory) {
  run(R"({ "pass": "scatter", "type": "studio.scatter", "write": { "out": "lit" }, "otherwise": { "lit": "given" } },
         { "pass": "remember", "type": "studio.remember", "read": { "from": "lit", "before": "kept@-1" },
           "write": { "out": "kept" } },
         { "pass": "tone", "type": "studio.tone", "read": { "from": "kept" }, "write": { "out": "toned" } })",
      true, 0);
  for (const uint32_t flags : {0u, uint32_t{DERMIS_FRAME_BOUNDS}, uint32_t{DERMIS_FRAME_BOUNDS}, 0u, 0u}) {
    again(flags);
    const auto expected = flags == 0 ? std::vector<std::string>{"scatter", "remember", "tone"}
                                     : std::vector<std::string>{"remember", "tone"};
    EXPECT_EQ(calls, expected) << flags;
  }
  uint32_t count = 1;
  dermis_history history = DERMIS_HISTORY_INIT;
  ASSERT_EQ(dermis_view_histories(dermis_graph_view(graph), &count, &history), DERMIS_OK)
      << dermis_last_error();
  EXPECT_STREQ(history.name, "kept");
  EXPECT_EQ(history.age, 6u) << history.text;
  std::vector<dermis_pass_timing> timings(3, dermis_pass_timing DERMIS_PASS_TIMING_INIT);
  uint32_t timed = 3;
  EXPECT_EQ(dermis_view_timings(dermis_graph_view(graph), last_frame, &timed, timings.data()), DERMIS_OK);
  EXPECT_EQ(timed, 3u);
}

} // namespace
} // namespace dermis::abi_test
