// Saved plans read back as they were written; any other file is rejected in bounded memory.

#include "framegraph/serialize/plan_file.hpp"
#include "framegraph/verify/verify.hpp"
#include "tests/framegraph/random_graph.hpp"
#include "tests/framegraph/saved_graph.hpp"
#include "tests/support/matchers.hpp"

#include <random>
#include <set>

namespace dermis::testing {
namespace {

std::string file_of(uint64_t seed) {
  const GraphBuilder builder = random_graph(seed);
  return write_plan(saved(builder.input()));
}

std::string refusal(std::string_view bytes) {
  Diagnostics diagnostics;
  EXPECT_FALSE(read_plan("p.plan", bytes, diagnostics));
  EXPECT_EQ(diagnostics.list.size(), 1u);
  if (diagnostics.list.empty()) return "";
  EXPECT_EQ(diagnostics.list[0].id, DiagnosticId::plan_file);
  EXPECT_EQ(diagnostics.files[diagnostics.list[0].where.file.value].name, "p.plan");
  return diagnostics.list[0].text;
}

TEST(Digest, MatchesTheStandard) { // FIPS 180-4 examples of zero, one and two blocks.
  EXPECT_EQ(digest_text(sha256("abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(digest_text(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(digest_text(sha256("")),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(SavedPlan, ReadsBackAsWritten) {
  for (uint64_t seed = 0; seed < 300; ++seed) {
    const GraphBuilder builder = random_graph(seed);
    const SavedPlan before = saved(builder.input());
    const std::string bytes = write_plan(before);
    Diagnostics diagnostics;
    const auto after = read_plan("p.plan", bytes, diagnostics);
    ASSERT_TRUE(after) << seed << format_as_json(diagnostics);
    EXPECT_EQ(write_plan(*after), bytes);
    EXPECT_EQ(plan_bytes(after->plan), plan_bytes(before.plan));
    EXPECT_EQ(after->names.passes, before.names.passes);
    EXPECT_EQ(verify(after->plan).violations, std::vector<std::string>{});
  }
}

// The name of a host's pass type has two parts of up to 64 bytes.
TEST(SavedPlan, LongestNamesOfPassTypes_AreRead) {
  SavedPlan before = saved(random_graph(1).input());
  ASSERT_FALSE(before.names.pass_types.empty());
  before.names.pass_types[0] = std::string(64, 'a') + "." + std::string(64, 'b');
  Diagnostics diagnostics;
  const auto after = read_plan("p.plan", write_plan(before), diagnostics);
  ASSERT_TRUE(after) << format_as_json(diagnostics);
  EXPECT_EQ(after->names.pass_types[0], before.names.pass_types[0]);
}

TEST(SavedPlan, EqualInputs_GiveEqualBytes) {
  for (uint64_t seed = 0; seed < 100; ++seed)
    EXPECT_EQ(file_of(seed), file_of(seed));
}

TEST(SavedPlan, Preserves64BitIntegers) {
  const GraphBuilder builder = random_graph(3);
  SavedPlan plan = saved(builder.input());
  plan.key.order_seed = 0xfedcba9876543210ull;
  plan.plan.transient_bytes = 0xffffffff00000001ull;
  ASSERT_FALSE(plan.plan.barriers.empty());
  plan.plan.barriers[0].source_stages = stage::clear | stage::compute_shader;
  Diagnostics diagnostics;
  const auto after = read_plan("p.plan", write_plan(plan), diagnostics);
  ASSERT_TRUE(after);
  EXPECT_EQ(after->key.order_seed, plan.key.order_seed);
  EXPECT_EQ(after->plan.transient_bytes, plan.plan.transient_bytes);
  EXPECT_EQ(after->plan.barriers[0].source_stages, plan.plan.barriers[0].source_stages);
}

TEST(SavedPlan, TruncatedFile_IsRejected) {
  const std::string bytes = file_of(5);
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_NE(refusal(std::string_view(bytes).substr(0, size)), "") << size;
  EXPECT_THAT(refusal(bytes + "x"), HasSubstr("1 bytes remain after the last field"));
}

TEST(SavedPlan, OtherVersion_IsRejected) {
  std::string bytes = file_of(5);
  bytes[8] = 9;
  EXPECT_EQ(refusal(bytes), "the plan has version 9; this library reads version 7");
  EXPECT_EQ(refusal("{}"), "a saved plan must begin with DERMPLAN");
}

TEST(SavedPlan, ExcessiveCount_IsRejectedBeforeAllocation) {
  SavedPlan plan;
  std::string bytes = write_plan(plan); // The last lists are empty, so 3 * 4 + 2 * 8 bytes follow.
  const size_t layouts = bytes.size() - 32;
  bytes.replace(layouts, 4, "\xff\xff\xff\xff");
  EXPECT_THAT(
      refusal(bytes),
      HasSubstr(
          "'history layouts' has 4294967295 entries, but the rest of the file can hold only 7"));
}

TEST(SavedPlan, ChangedByte_IsRejectedOrAValidPlan) {
  size_t accepted = 0, tried = 0;
  for (const uint64_t seed : {1u, 2u, 8u}) {
    const std::string bytes = file_of(seed);
    for (size_t at = 0; at < bytes.size(); ++at)
      for (const char value : {'\0', '\1', '\x7f', '\xff'}) {
        std::string damaged = bytes;
        damaged[at] = value;
        if (damaged == bytes) continue;
        Diagnostics diagnostics;
        const auto plan = read_plan("p.plan", damaged, diagnostics);
        ++tried;
        if (!plan) continue;
        ++accepted;
        ASSERT_EQ(write_plan(*plan), damaged) << seed << " " << at;
      }
  }
  EXPECT_GT(accepted, 0u);
  EXPECT_LT(accepted, tried);
}

TEST(SavedPlan, IndexOutOfRange_IsRejected) {
  const GraphBuilder builder = random_graph(8);
  const SavedPlan good = saved(builder.input());
  const auto rejected_with = [&](auto&& change) {
    SavedPlan plan = good;
    change(plan);
    return refusal(write_plan(plan));
  };
  EXPECT_EQ(rejected_with([](SavedPlan& p) { p.names.passes.pop_back(); }),
            "the numbers of names and of objects in the plan differ");
  EXPECT_EQ(rejected_with([](SavedPlan& p) { p.key.view_width += 1; }),
            "key and plan were made for different views or devices");
  EXPECT_THAT(rejected_with([](SavedPlan& p) { p.plan.accesses[0].resource = 70000; }),
              HasSubstr("accesses a resource or an earlier frame that does not exist"));
  EXPECT_THAT(rejected_with([](SavedPlan& p) { p.plan.placements[0].heap = 77; }),
              HasSubstr("is not in a heap"));
  EXPECT_THAT(rejected_with([](SavedPlan& p) { p.plan.placements[0].last_use = 0xffffffff; }),
              HasSubstr("alive outside of the frame"));
  EXPECT_THAT(rejected_with([](SavedPlan& p) { p.plan.passes[0].access_count += 1; }),
              HasSubstr("are not in the order of their passes"));
}

TEST(PlanKey, DiffersIfThePlanCanDiffer) {
  GraphBuilder builder = random_graph(8);
  DeviceProfile other = generic_profile();
  other.name = "other";
  std::set<std::string> keys;
  const auto is_new = [&](auto&& change) {
    CompileInput input = builder.input();
    change(input);
    return keys.insert(key_bytes(plan_key(input))).second;
  };
  EXPECT_TRUE(is_new([](CompileInput&) {}));
  EXPECT_TRUE(is_new([](CompileInput& input) { input.view_width += 1; }));
  EXPECT_TRUE(is_new([](CompileInput& input) { input.pixel_grid = 1; }));
  EXPECT_TRUE(is_new([](CompileInput& input) { input.view_height += 1; }));
  EXPECT_TRUE(is_new([&](CompileInput& input) { input.device = &other; }));
  EXPECT_TRUE(is_new([](CompileInput& input) { input.order = PassOrder::program; }));
  EXPECT_TRUE(is_new([](CompileInput& input) { input.order = PassOrder::random; }));
  EXPECT_TRUE(is_new([](CompileInput& input) {
    input.order = PassOrder::random;
    input.order_seed = 1;
  }));
  EXPECT_TRUE(is_new([](CompileInput& input) { input.packing = PackingLevel::fast; }));
  EXPECT_TRUE(is_new([](CompileInput& input) { input.alias = false; }));
  EXPECT_TRUE(is_new([](CompileInput& input) { input.cull = false; }));
  EXPECT_TRUE(is_new([](CompileInput& input) { input.keep_alive = ResourceId{0}; }));
  EXPECT_TRUE(is_new([&](CompileInput& input) {
    input.host_formats.assign(builder.graph.resources.size(), Format::undefined);
    input.host_formats[0] = Format::r32f;
  }));
  builder.graph.resources[0].size.x.numerator += 1;
  EXPECT_TRUE(is_new([](CompileInput&) {})) << "the graph is part of the key";
  builder.graph.resources[0].note = "another";
  builder.graph.resources[0].where.line = 99;
  EXPECT_FALSE(is_new([](CompileInput&) {})) << "notes and places in the file are not";
  EXPECT_FALSE(is_new([](CompileInput& input) { input.reasons = false; }));
  EXPECT_FALSE(is_new([](CompileInput& input) { input.order_seed = 4; }))
      << "no random number is used";
}

TEST(PlanKey, DiffersWithWhatThePassTypeSupports) {
  static constexpr Format narrow[] = {Format::rgba16f};
  const Port plain{"a", Usage::sampled_image, false, "texture2D", ""};
  std::vector<Port> variants(6, plain);
  variants[1].filtered = true;
  variants[2].glsl_type = "utexture2D";
  variants[3].formats = narrow;
  variants[4].formats_while = {"mode", 1, narrow};
  variants[5].own_texels = true;
  std::set<std::string> keys;
  for (const Port& port : variants)
    for (const bool alternative : {false, true}) {
      GraphBuilder builder{"import light", "export result"};
      const Port ports[] = {port, {"out", Usage::storage_image_write, false, "image2D", ""}};
      static constexpr std::string_view one_of[] = {"a"};
      PassType type;
      type.name = "test.variant";
      type.ports = ports;
      if (alternative) type.one_of = one_of;
      builder.pass_types.add(type);
      builder.pass("only", "test.variant", {{"a", "light"}}, {{"out", "result"}});
      EXPECT_TRUE(keys.insert(key_bytes(plan_key(builder.input()))).second);
    }
}

TEST(PlanKey, FillsInDefaults) {
  GraphBuilder builder = random_graph(8);
  builder.boolean("flag", true);
  const std::string key = key_bytes(plan_key(builder.input()));
  CompileInput input = builder.input();
  for (const SettingDeclaration& setting : builder.graph.settings)
    input.settings.push_back(setting.default_value);
  input.bound.assign(builder.graph.resources.size(), true);
  input.host_formats.assign(builder.graph.resources.size(), Format::undefined);
  EXPECT_EQ(key_bytes(plan_key(input)), key);
  input.settings.back().integer = 0;
  EXPECT_NE(key_bytes(plan_key(input)), key);
}

} // namespace
} // namespace dermis::testing
