// Tests host passes when nothing scatters: without a profile, and in frames with empty bounds.

#include "tests/integration/abi/dermis_fixture.hpp"

namespace dermis::abi_test {
namespace {

void DERMIS_CALL keep_name(void* user, const dermis_pass_call* call) {
  std::string name = call->pass;
  for (uint32_t p = 0; p < call->port_count; ++p)
    if (call->ports[p].image == VK_NULL_HANDLE && call->ports[p].buffer == VK_NULL_HANDLE)
      name += " -";
  static_cast<std::vector<std::string>*>(user)->push_back(name);
}

const dermis_port written = port_of("out", DERMIS_PORT_STORAGE_IMAGE_WRITE);
const dermis_port maybe = port_of("from", DERMIS_PORT_SAMPLED_IMAGE, true);

struct Way {
  bool profiles;
  uint32_t flags;
};
// Returns a pass of type studio.`name` that reads `from` and writes `out`.
std::string pass(const std::string& name, const std::string& from,
                 const std::string& out = "toned") {
  const std::string read = from.empty() ? "" : R"("read": { "from": ")" + from + R"(" }, )";
  return R"({ "pass": ")" + name + R"(", "type": "studio.)" + name + R"(", )" + read +
         R"("write": { "out": ")" + out + R"(" } })";
}

struct HostPassSkips : DermisTest {
  std::vector<std::string> calls;
  dermis_graph graph = nullptr;
  bool export_is_optional = true;

  void SetUp() override {
    DermisTest::SetUp();
    if (IsSkipped()) return;
    own_context(context_desc()); // pass types stay registered
    add("studio.make", {written}, false);
    add("studio.tone", {port_of("from"), written}, false);
    add("studio.maybe", {maybe, written}, false);
    add("studio.scatter", {written}, true);
    add("studio.count", {written}, false, true);
    add("studio.change", {port_of("out", DERMIS_PORT_STORAGE_IMAGE_UPDATE)}, false);
    add("studio.rescatter", {port_of("out", DERMIS_PORT_STORAGE_IMAGE_UPDATE)}, true);
    add("studio.scatter_list", {port_of("list", DERMIS_PORT_STORAGE_BUFFER_WRITE)}, true);
    add("studio.use_list", {port_of("list", DERMIS_PORT_STORAGE_BUFFER_READ), written}, false);
    add("studio.remember",
        {port_of("from"), port_of("before", DERMIS_PORT_SAMPLED_IMAGE, true), written}, false);
  }

  void add(const char* name, const std::vector<dermis_port>& ports, bool serves,
           bool side_effects = false) {
    dermis_pass_type type = pass_type_of(name, ports, keep_name, &calls);
    type.serves_scattering = serves ? 1 : 0;
    type.side_effects = side_effects ? 1 : 0;
    ASSERT_OK(dermis_register_pass_type(context, &type));
  }

  // Makes a graph with `passes`, whose export is `toned`, and records a frame.
  void run(const std::string& passes, Way way = {true, 0}) {
    calls.clear();
    const std::string image = R"({ "format": "rgba16f", "size": "view" })";
    GraphOptions options =
        own_graph(R"({ "dermis": 2, "name": "skips", "imports": { "given": )" + image +
                  R"( }, "resources": { "list": { "buffer": { "stride": 4, "count": [16, 1] } },
                   "usual": { "buffer": { "stride": 4, "count": [16, 1] } },
                   "kept": { "format": "rgba16f", "size": "view", "history": { "frames": 1 } },
                   "chain": { "format": "rgba16f", "size": "view", "mips": 2 }, "lit": )" +
                  image + R"(, "toned": { "format": "rgba16f", "size": "view", "optional": )" +
                  (export_is_optional ? "true" : "false") + R"( } },
      "passes": [ )" +
                  passes + R"( ], "exports": ["toned"] })");
    options.profiles = way.profiles;
    graph = make_bound_graph(options);
    again(way.flags);
  }
  void again(uint32_t flags) { // Records the next frame.
    calls.clear();
    dermis_frame one = bound_frame(graph);
    one.flags = flags;
    ASSERT_OK(record(graph, one));
  }
  std::string described() {
    std::string text(100000, ' ');
    size_t size = text.size();
    EXPECT_OK(dermis_graph_describe(graph, DERMIS_DESCRIBE_TEXT, &size, text.data()));
    return text.substr(0, size);
  }
};

const std::string remembering =
    R"({ "pass": "scatter", "type": "studio.scatter", "write": { "out": "lit" }, "otherwise": { "lit": "given" } },
         { "pass": "remember", "type": "studio.remember", "read": { "from": "lit", "before": "kept@-1" },
           "write": { "out": "kept" } },
         { "pass": "tone", "type": "studio.tone", "read": { "from": "kept" }, "write": { "out": "toned" } })";

constexpr Way nothing_scatters[] = {{false, 0}, {true, DERMIS_FRAME_BOUNDS}};

TEST_F(HostPassSkips, HostPassesRunWhereNothingScatters) {
  for (const Way& way : nothing_scatters) {
    run(pass("make", ""), way);
    EXPECT_THAT(calls, ElementsAre("make")) << way.profiles;
    run(pass("tone", "given"), way);
    EXPECT_THAT(calls, ElementsAre("tone")) << way.profiles;
    run(pass("count", "", "lit") + ", " + pass("make", ""), way);
    EXPECT_THAT(calls, ElementsAre("count", "make")) << "a pass with side effects";
  }
}

TEST_F(HostPassSkips, InputsOfSkippedPassesAreUnboundOrSkip) {
  const std::string scatter = pass("scatter", "", "lit") + ", ";
  for (const Way& way : nothing_scatters) {
    run(scatter + pass("maybe", "lit"), way);
    EXPECT_THAT(calls, ElementsAre("maybe -")) << way.profiles;
    run(scatter + pass("tone", "lit"), way);
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
        way);
    EXPECT_THAT(calls, ElementsAre("tone")) << way.profiles;
    if (way.profiles) continue;
    EXPECT_THAT(
        described(),
        HasSubstr("off: its pass type only serves scattering, and the graph has no profile"));
  }
}

// The replacement is read although another pass has written the resource before.
TEST_F(HostPassSkips, OtherwiseOfAnUpdate_IsRead) {
  for (const Way& way : nothing_scatters) {
    run(pass("make", "", "lit") +
            R"(, { "pass": "again", "type": "studio.rescatter", "write": { "out": "lit" }, "otherwise": { "lit": "given" } }, )" +
            pass("tone", "lit"),
        way);
    EXPECT_THAT(calls, ElementsAre("tone")) << way.profiles;
    for (const dermis_slot& slot : list_of(dermis_slot DERMIS_SLOT_INIT, dermis_graph_slots, graph))
      EXPECT_EQ(slot.read, slot.name == std::string("given") ? 1u : 0u) << slot.name;
  }
}

// The export keeps its contents, because no pass of such a frame writes it.
TEST_F(HostPassSkips, RequiredExport_KeepsContentsInEmptyFrames) {
  export_is_optional = false;
  const std::string scatter = pass("scatter", "", "lit") + ", ";
  const std::string tone = pass("tone", "lit");
  run(scatter + tone);
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
        way);
    EXPECT_THAT(calls, ElementsAre("use")) << way.profiles;
  }
}

TEST_F(HostPassSkips, AnUpdateNeedsContents) {
  const std::string scatter = pass("scatter", "") + ", ", change = pass("change", "");
  for (const Way& way : nothing_scatters) {
    run(scatter + change, way);
    EXPECT_THAT(calls, IsEmpty()) << way.profiles;
    EXPECT_THAT(
        described(),
        ::testing::AnyOf(HasSubstr("it reads 'toned', whose producers are off"),
                         HasSubstr("it reads 'toned', which only scattering passes write")));
    run(pass("make", "") + ", " + change, way);
    EXPECT_THAT(calls, ElementsAre("make", "change")) << way.profiles;
  }
}

TEST_F(HostPassSkips, SkippedPass_SkipsItsReaders) {
  for (const Way& way : nothing_scatters) {
    run(R"({ "pass": "scatter", "type": "studio.scatter", "write": { "out": "lit" } },
           { "pass": "first", "type": "studio.tone", "read": { "from": "lit" }, "write": { "out": "kept" } },
           { "pass": "second", "type": "studio.maybe", "read": { "from": "kept" }, "write": { "out": "toned" } })",
        way);
    EXPECT_THAT(calls, ElementsAre("second -")) << way.profiles;
  }
}

TEST_F(HostPassSkips, MipsHaveSeparateWriters) {
  const std::string chain =
      pass("make", "", "chain#0") + ", " + pass("scatter", "", "chain#1") + ", ";
  run(chain + pass("tone", "chain#0"), {true, DERMIS_FRAME_BOUNDS});
  EXPECT_THAT(calls, ElementsAre("make", "tone"));
  run(chain + pass("maybe", "chain#1"), {true, DERMIS_FRAME_BOUNDS});
  EXPECT_THAT(calls, ElementsAre("maybe -"));
  for (const Way& way : nothing_scatters) {
    run(chain + pass("maybe", "chain"), way);
    EXPECT_THAT(calls, ElementsAre("maybe -")) << way.profiles;
    run(chain + pass("tone", "chain#1"), way);
    EXPECT_THAT(calls, IsEmpty()) << way.profiles;
    run(chain + pass("tone", "chain"), way);
    EXPECT_THAT(calls, IsEmpty()) << way.profiles;
  }
}

TEST_F(HostPassSkips, DiscardedFrame_IsRevertedInBothPlans) {
  run(remembering);
  const auto age = [&] {
    uint32_t count = 1;
    dermis_history history = DERMIS_HISTORY_INIT;
    EXPECT_OK(dermis_view_histories(dermis_graph_view(graph), &count, &history));
    return history.age;
  };
  ASSERT_EQ(age(), 1u);
  dermis_frame empty = bound_frame(graph);
  empty.flags = DERMIS_FRAME_BOUNDS;
  uint32_t count = 0;
  const dermis_command* commands = nullptr;
  ASSERT_OK(dermis_view_commands(dermis_graph_view(graph), &empty, &count, &commands));
  EXPECT_EQ(age(), 2u);
  ASSERT_OK(dermis_view_discard(dermis_graph_view(graph), empty.frame_index));
  EXPECT_EQ(age(), 1u);
  again(0);
  EXPECT_THAT(calls, ElementsAre("scatter", "remember", "tone"));
  EXPECT_EQ(age(), 2u);
}

// In frames with empty bounds `tone` reads what the host provides, because `scatter` is left out.
TEST_F(HostPassSkips, SlotThatOnlyEmptyBoundsRead_NeedsContents) {
  run(pass("scatter", "", "given") + ", " + pass("tone", "given"));
  for (const dermis_slot& slot : list_of(dermis_slot DERMIS_SLOT_INIT, dermis_graph_slots, graph))
    EXPECT_EQ(slot.read, slot.name == std::string("given") ? 1u : 0u) << slot.name;
  run(pass("make", "", "given") + ", " + pass("tone", "given")); // never left out
  for (const dermis_slot& slot : list_of(dermis_slot DERMIS_SLOT_INIT, dermis_graph_slots, graph))
    EXPECT_EQ(slot.read, 0u) << slot.name;
}

TEST_F(HostPassSkips, AlternatingPlans_KeepTheHostsHistory) {
  run(remembering);
  for (const uint32_t flags :
       {0u, uint32_t{DERMIS_FRAME_BOUNDS}, uint32_t{DERMIS_FRAME_BOUNDS}, 0u, 0u}) {
    again(flags);
    const auto expected = flags == 0 ? std::vector<std::string>{"scatter", "remember", "tone"}
                                     : std::vector<std::string>{"remember", "tone"};
    EXPECT_EQ(calls, expected) << flags;
  }
  uint32_t count = 1;
  dermis_history history = DERMIS_HISTORY_INIT;
  ASSERT_OK(dermis_view_histories(dermis_graph_view(graph), &count, &history));
  EXPECT_STREQ(history.name, "kept");
  EXPECT_EQ(history.age, 6u) << history.text;
  std::vector<dermis_pass_timing> timings(3, dermis_pass_timing DERMIS_PASS_TIMING_INIT);
  uint32_t timed = 3;
  EXPECT_OK(dermis_view_timings(dermis_graph_view(graph), last_frame, &timed, timings.data()));
  EXPECT_EQ(timed, 3u);
}

} // namespace
} // namespace dermis::abi_test
