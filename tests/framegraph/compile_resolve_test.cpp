// Tests how the compiler resolves sizes, formats, device limits and memory.

#include "framegraph/compile/hardware.hpp"
#include "framegraph/compile/packer.hpp"
#include "framegraph/model/splitmix.hpp"
#include "tests/framegraph/graph_builder.hpp"

#include <tuple>

namespace dermis::testing {
namespace {

// Builds light (import) -> middle -> result (export). The tests vary `middle`.
struct Chain : GraphBuilder {
  Chain() {
    import("light");
    image("middle");
    exported("result");
    pass("first", "test.shade", {{"a", "light"}}, {{"out", "middle"}});
    pass("second", "test.shade", {{"a", "middle"}}, {{"out", "result"}});
  }
  ResourceDeclaration& middle() { return graph.resources[1]; }
};

PlanResource resource_of(const GraphBuilder& b, const Plan& plan, const std::string& name) {
  for (const PlanResource& resource : plan.resources)
    if (resource.declared == b.resource(name)) return resource;
  ADD_FAILURE() << name << " is not in the plan";
  return {};
}

TEST(Sizes, FollowTheViewWithTheStatedRounding) {
  Chain b;
  b.middle().size.x = b.middle().size.y = {3, 4};
  auto middle = resource_of(b, compiled(b, b.input(101, 7)).plan, "middle");
  EXPECT_EQ(middle.width, 76u); // 75.75 is rounded up.
  EXPECT_EQ(middle.height, 6u); // 5.25 is rounded up.
  b.middle().size.rounding = Rounding::floor;
  middle = resource_of(b, compiled(b, b.input(101, 7)).plan, "middle");
  EXPECT_EQ(middle.width, 75u);
  EXPECT_EQ(middle.height, 5u);
  b.middle().size.align = 8;
  middle = resource_of(b, compiled(b, b.input(101, 7)).plan, "middle");
  EXPECT_EQ(middle.width, 80u);
  EXPECT_EQ(middle.height, 8u);
  b.middle().size.border = 1; // The border is added on both sides, after aligning.
  middle = resource_of(b, compiled(b, b.input(101, 7)).plan, "middle");
  EXPECT_EQ(middle.width, 82u);
  EXPECT_EQ(middle.height, 10u);
}

TEST(Sizes, SquareViewDoublesTheLongerSideOfPixels) {
  Chain b;
  b.middle().size.base = SizeExpression::Base::square_view;
  b.middle().size.x = b.middle().size.y = {1, 2};
  const struct {
    double aspect; // width / height
    uint32_t width, height;
  } cases[] = {{1, 32, 16},       {1.05, 32, 16}, {4.0 / 3, 32, 16}, {1.6, 64, 16},
               {1 / 1.6, 32, 32}, {4, 128, 16},   {0.25, 32, 64},    {1000, 128, 16}};
  for (const auto& [aspect, width, height] : cases) {
    CompileInput input = b.input(64, 32);
    input.pixel_grid = pixel_grid(aspect);
    const auto plan = compiled(b, input).plan;
    EXPECT_EQ(resource_of(b, plan, "middle").width, width) << aspect;
    EXPECT_EQ(resource_of(b, plan, "middle").height, height) << aspect;
    EXPECT_EQ(plan.pixel_grid, input.pixel_grid);
  }
}

TEST(Sizes, AreNeverBelowOneAndChangeWithTheView) {
  Chain b;
  b.middle().size.x = b.middle().size.y = {1, 8};
  b.middle().size.rounding = Rounding::floor;
  for (const uint32_t side : {1u, 7u, 16u, 1001u, 16384u}) {
    const auto plan = compiled(b, b.input(side, 1)).plan;
    EXPECT_EQ(resource_of(b, plan, "middle").width, std::max(side / 8, 1u));
    EXPECT_EQ(resource_of(b, plan, "middle").height, 1u);
    EXPECT_EQ(plan.view_width, side);
  }
}

TEST(Sizes, MayFollowAnotherResourceWhereverItIsDeclared) {
  Chain b;
  b.middle().size.base = SizeExpression::Base::resource;
  b.middle().size.resource = b.resource("result");
  b.middle().size.x = b.middle().size.y = {1, 2};
  b.graph.resources[2].size.x = b.graph.resources[2].size.y = {1, 2};
  EXPECT_EQ(resource_of(b, compiled(b).plan, "middle").width, 16u);
}

TEST(Sizes, CircularReference_IsRejectedWithTheCycle) {
  Chain b;
  for (const auto& [from, to] : {std::pair{1u, 2u}, {2u, 1u}}) {
    b.graph.resources[from].size.base = SizeExpression::Base::resource;
    b.graph.resources[from].size.resource = ResourceId{to};
  }
  const Diagnostic error =
      rejected_once(b, DiagnosticId::size_cycle, "'middle' -> 'result' -> 'middle'");
  EXPECT_EQ(error.where.line, b.graph.resources[1].where.line);
  EXPECT_EQ(error.related[0].first.line, b.graph.resources[2].where.line);
}

TEST(Sizes, BeyondTheDevice_IsRejectedOnce) {
  Chain b;
  b.middle().size.x = {1000, 1};
  b.graph.resources[2].size.base = SizeExpression::Base::resource;
  b.graph.resources[2].size.resource = ResourceId{1};
  rejected_once(b, DiagnosticId::size_out_of_range, "'middle' is 64000x64 texels");
  b.middle().size.x = {INT64_MAX, 1};
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::size_out_of_range);
}

// `spare` is 64000 texels wide, beyond the device.
TEST(Sizes, WithoutLiveUsers_CannotFail) {
  const auto chain = [] {
    Chain b;
    ResourceDeclaration& spare = b.image("spare");
    spare.size.x = {1000, 1};
    spare.mips = 0;
    b.image("follower").size.base = SizeExpression::Base::resource;
    b.graph.resources.back().size.resource = b.resource("spare");
    return b;
  };
  compiled(chain());
  Chain culled = chain();
  culled.graph.names_ranges = true;
  culled.pass("spare_low", "test.shade", {{"a", "light"}}, {{"out", "spare#0"}});
  culled.pass("spare_high", "test.shade", {{"a", "spare#0"}}, {{"out", "spare#3"}});
  culled.pass("more", "test.shade", {{"a", "light"}}, {{"out", "follower"}});
  compiled(culled);
  Chain off = chain();
  off.boolean("wide", false);
  off.pass("fill", "test.shade", {{"a", "light"}}, {{"out", "follower"}}).when = off.when("wide");
  off.read(1, 0) = off.reference(0, "follower");
  off.otherwise(off.graph.passes[2], "follower", "light");
  compiled(off);
  Chain cycle = chain();
  cycle.graph.resources[3].size = cycle.graph.resources[4].size;
  cycle.graph.resources[3].size.resource = cycle.resource("follower");
  compiled(cycle);
}

TEST(Sizes, OfResourcesThatLivePassesNeed_AreRejected) {
  Chain written;
  written.image("spare").size.x = {1000, 1};
  written.image("follower").size.base = SizeExpression::Base::resource;
  written.graph.resources.back().size.resource = written.resource("spare");
  Chain followed = written;
  written.pass("fill", "test.probe", {{"a", "spare"}}, {});
  written.pass("source", "test.shade", {{"a", "light"}}, {{"out", "spare"}});
  followed.pass("fill", "test.probe", {{"a", "follower"}}, {});
  followed.pass("source", "test.shade", {{"a", "light"}}, {{"out", "follower"}});
  for (const Chain* b : {&written, &followed})
    rejected_once(*b, DiagnosticId::size_out_of_range, "'spare' is 64000x64 texels");
  followed.graph.resources[3].size = followed.graph.resources[4].size;
  followed.graph.resources[3].size.resource = followed.resource("follower");
  rejected_once(followed, DiagnosticId::size_cycle, "'spare' -> 'follower' -> 'spare'");
}

// Only the second option of the choice fails.
TEST(Settings, ErrorsNameTheSettingsThatSelectPasses) {
  Chain b;
  b.image("spare").size.x = {1000, 1};
  b.boolean("sharp", false);
  SettingDeclaration& choice = b.boolean("technique", false);
  choice.type = SettingType::choice;
  choice.default_value.type = SettingType::choice;
  choice.options = {"fast", "separable"};
  choice.by_budget = true;
  SettingDeclaration& samples = b.boolean("unrelated", false);
  samples.note = "no pass depends on it";
  b.pass("fill", "test.shade", {{"a", "light"}}, {{"out", "spare"}});
  b.pass("use", "test.probe", {{"a", "spare"}}, {}).when = b.when("technique");
  compiled(b);
  CompileInput input = b.input();
  for (const SettingDeclaration& one : b.graph.settings)
    input.settings.push_back(one.default_value);
  input.settings[1].integer = input.settings[2].integer = 1;
  Diagnostics diagnostics;
  EXPECT_FALSE(compile(input, diagnostics));
  ASSERT_EQ(diagnostics.list.size(), 1u);
  EXPECT_THAT(diagnostics.list[0].text, ::testing::EndsWith(", with 'technique' = 'separable'"));
  b.graph.passes.back().when = b.when("sharp");
  input.settings[0].integer = 1;
  diagnostics = {};
  EXPECT_FALSE(compile(input, diagnostics));
  EXPECT_THAT(diagnostics.list[0].text,
              ::testing::EndsWith(", with 'sharp' = true, 'technique' = 'separable'"));
  b.graph.passes.back().when = {}; // The error occurs with all settings.
  EXPECT_THAT(rejected(b, input)[0].text, Not(HasSubstr("with '")));
}

TEST(Sizes, BuffersCountTilesAndExtraElements) {
  GraphBuilder b{"buffer tiles", "export result"};
  b.pass("list", "test.list", {}, {{"tiles", "tiles"}});
  b.pass("scatter", "test.tiles", {{"tiles", "tiles"}}, {{"out", "result"}});
  // ceil(65 / 8) * ceil(9 / 8) tiles and 4 more elements, of 4 bytes each.
  EXPECT_EQ(resource_of(b, compiled(b, b.input(65, 9)).plan, "tiles").bytes, (9u * 2u + 4u) * 4u);
  b.graph.resources[0].extra_elements = UINT64_MAX;
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::size_out_of_range);
}

TEST(Sizes, MipChains) {
  Chain b;
  b.middle().mips = 0;
  EXPECT_EQ(resource_of(b, compiled(b, b.input(64, 9)).plan, "middle").mips, 7u);
  b.middle().mips = 8;
  EXPECT_THAT(rejected(b)[0].text, HasSubstr("asks for 8 mip levels; 64x64 has 7"));
  b.middle().mips = 1;
  b.middle().layers = 257;
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::size_out_of_range);
}

TEST(Formats, FirstFormatUsableByPortsAndDeviceIsTaken) {
  Chain b;
  b.middle().formats = {Format::rgba8_srgb, Format::b10g11r11f, Format::rgba16f};
  auto whole = compiled(b); // Kernels cannot store to sRGB formats.
  EXPECT_EQ(resource_of(b, whole.plan, "middle").format, Format::b10g11r11f);
  EXPECT_THAT(reasons(b, whole, Reason::About::resource, 1),
              HasSubstr("not rgba8_srgb: the device 'generic' does not support it"));
  b.graph.passes[1].type =
      // Reads through the port with the same number, which allows only rgba16f.
      b.pass_types.find("test.narrow");
  b.read(1, 0).port = 0;
  b.written(1, 0).port = 1;
  whole = compiled(b);
  EXPECT_EQ(resource_of(b, whole.plan, "middle").format, Format::rgba16f);
  EXPECT_THAT(reasons(b, whole, Reason::About::resource, 1),
              HasSubstr("port 'a' of pass 'second' does not support it"));
  b.middle().formats = {Format::r8_unorm};
  rejected_once(b, DiagnosticId::no_usable_format);
}

TEST(Formats, FilteredPortsNeedADeviceThatFilters) {
  Chain b;
  b.middle().formats = {Format::rgba32f, Format::rgba16f};
  b.graph.passes[1].type = b.pass_types.find("test.filter");
  b.read(1, 0).port = 0;
  b.written(1, 0).port = 1;
  EXPECT_EQ(resource_of(b, compiled(b).plan, "middle").format, Format::rgba32f);
  b.device.filters = [](Format format) { return format != Format::rgba32f; };
  const auto whole = compiled(b);
  EXPECT_EQ(resource_of(b, whole.plan, "middle").format, Format::rgba16f);
  EXPECT_THAT(reasons(b, whole, Reason::About::resource, 1),
              HasSubstr("not rgba32f: the device 'generic' does not filter it, as port 'a' of pass "
                        "'second' needs"));
  b.middle().formats = {Format::rgba32f};
  rejected_once(b, DiagnosticId::no_usable_format, "does not filter it linearly, as port 'a'");
}

TEST(Formats, ComponentTypeIsRespected) {
  GraphBuilder b;
  b.image("ids").formats = {Format::r8_unorm, Format::r8_uint};
  b.exported("result");
  b.pass("fill", "test.fill", {}, {{"target", "ids"}});
  b.pass("use", "test.ids", {{"ids", "ids"}}, {{"out", "result"}});
  const auto whole = compiled(b);
  EXPECT_EQ(resource_of(b, whole.plan, "ids").format, Format::r8_uint);
  EXPECT_THAT(reasons(b, whole, Reason::About::resource, 0),
              HasSubstr("port 'ids' of pass 'use' does not support it"));
}

TEST(Formats, HostFormatMustFitTheComponentType) {
  GraphBuilder b;
  b.import("ids").formats = {Format::r8_uint, Format::r8_unorm};
  b.exported("result");
  b.pass("use", "test.ids", {{"ids", "ids"}}, {{"out", "result"}});
  auto input = b.input();
  const std::vector<Format> formats{Format::r8_unorm, Format::undefined};
  input.host_formats = formats;
  EXPECT_EQ(rejected(b, input)[0].id, DiagnosticId::no_usable_format);
}

// Resources with equal declarations are reported separately, too.
TEST(Formats, EveryResourceWithoutUsableFormatIsReported) {
  Chain b;
  for (const char* name : {"other", "third"}) {
    b.image(name).formats = {Format::r8_unorm};
    b.pass(name, "test.shade", {{"a", "light"}}, {{"out", name}});
    b.pass(std::string("keep ") + name, "test.probe", {{"a", name}}, {});
  }
  b.device.supports = [](Format format, uint32_t) { return format != Format::r8_unorm; };
  CompileInput input = b.input();
  for (const bool reasons : {false, true}) {
    input.reasons = reasons;
    EXPECT_THAT(rejected(b, input), SizeIs(2));
  }
}

TEST(Sizes, ManyShapesInAnyOrderStayDistinct) {
  GraphBuilder b;
  b.import("light");
  struct Expected {
    uint32_t width, height, mips;
    Format format;
  };
  const auto expected = [](uint32_t i) {
    const uint32_t shape = i * 37 % 96; // Each shape is declared again after other shapes.
    return Expected{64 * (1 + shape % 6), 64 * (1 + shape / 6 % 4), 1 + shape / 24 % 2,
                    shape / 48 == 0 ? Format::rgba16f : Format::r32f};
  };
  constexpr uint32_t count = 400;
  for (uint32_t i = 0; i < count; ++i) {
    const std::string name = "image" + std::to_string(i);
    ResourceDeclaration& image = b.image(name);
    image.size.x = {expected(i).width / 64, 1};
    image.size.y = {expected(i).height / 64, 1};
    image.mips = expected(i).mips;
    image.formats = {expected(i).format};
    b.pass("pass" + std::to_string(i), "test.shade", {{"a", "light"}}, {{"out", name}});
    b.pass("keep" + std::to_string(i), "test.probe", {{"a", name}}, {});
  }
  const Plan plan = compiled(b).plan;
  for (uint32_t i = 0; i < count; ++i) {
    const PlanResource image = resource_of(b, plan, "image" + std::to_string(i));
    const Expected resolved = expected(i);
    EXPECT_EQ(std::tie(image.width, image.height, image.mips, image.format),
              std::tie(resolved.width, resolved.height, resolved.mips, resolved.format))
        << i;
  }
}

TEST(Formats, HostFormatMustBeDeclared) {
  Chain b;
  b.graph.resources[0].formats = {Format::rgba16f, Format::b10g11r11f};
  auto input = b.input();
  input.host_formats.assign(3, Format::undefined);
  EXPECT_EQ(resource_of(b, compiled(b, input).plan, "light").format, Format::rgba16f);
  input.host_formats[0] = Format::b10g11r11f;
  EXPECT_EQ(resource_of(b, compiled(b, input).plan, "light").format, Format::b10g11r11f);
  input.host_formats[0] = Format::r8_unorm;
  const auto errors = rejected(b, input);
  EXPECT_EQ(errors[0].id, DiagnosticId::host_format);
  EXPECT_THAT(errors[0].text,
              HasSubstr("binds 'light' as r8_unorm; the graph declares rgba16f, b10g11r11f"));
}

TEST(Limits, DeviceLimitsAreEnforced) {
  Chain b;
  b.device.max_workgroup_count = 7;
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::device_limit); // 64 / 8 = 8 groups in x.
  b.device.max_workgroup_count = 8;
  compiled(b);
  b.device.max_push_constants_bytes = 3;
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::device_limit);
}

TEST(Limits, CompileInputMustFitTheGraph) {
  Chain b;
  EXPECT_EQ(rejected(b, b.input(0, 64))[0].id, DiagnosticId::compile_input);
  EXPECT_EQ(rejected(b, b.input(64, 16385))[0].id, DiagnosticId::compile_input);
  auto input = b.input();
  input.bound = {true};
  input.host_formats = {Format::rgba16f};
  EXPECT_THAT(rejected(b, input), SizeIs(2));
}

TEST(Packing, ItemsAliveTogetherNeverOverlap) {
  const std::vector<PackItem> items = {
      {100, 64, 0, 3}, {50, 64, 1, 2}, {200, 256, 2, 5}, {10, 1, 4, 4}, {0, 1, 0, 5}};
  const Packing packing = pack_items(items);
  for (size_t i = 0; i < items.size(); ++i) {
    EXPECT_EQ(packing.offsets[i] % items[i].alignment, 0u);
    EXPECT_LE(packing.offsets[i] + items[i].size, packing.size);
    for (size_t k = 0; k < i; ++k) {
      const bool together = items[i].first <= items[k].last && items[k].first <= items[i].last;
      const bool apart = packing.offsets[i] + items[i].size <= packing.offsets[k] ||
                         packing.offsets[k] + items[k].size <= packing.offsets[i];
      EXPECT_TRUE(!together || apart || items[i].size == 0 || items[k].size == 0)
          << i << " and " << k;
    }
  }
  EXPECT_EQ(packing.lower_bound, 350u); // 100 + 50 + 200 are alive in pass 2.
}

TEST(Packing, ItemsThatFollowEachOtherShareTheirMemory) {
  const Packing packing = pack_items({{64, 64, 0, 1}, {64, 64, 2, 3}, {64, 64, 4, 5}});
  EXPECT_EQ(packing.size, 64u);
  EXPECT_EQ(packing.size, packing.lower_bound);
  EXPECT_EQ(pack_items({}).size, 0u);
}

// A graph may keep 36,000 instances of histories, which all live for the whole frame.
TEST(Packing, ThousandsOfHistoriesAreStacked) {
  constexpr uint32_t count = 20000, passes = 4096;
  std::vector<PackItem> items;
  for (uint32_t i = 0; i < count; ++i)
    items.push_back({100 + i % 7, i % 3 == 0 ? 256u : 64u, 0, passes - 1});
  const Packing packing = pack_items(items);
  std::vector<std::pair<uint64_t, uint64_t>> ranges;
  for (uint32_t i = 0; i < count; ++i) {
    EXPECT_EQ(packing.offsets[i] % items[i].alignment, 0u);
    ranges.emplace_back(packing.offsets[i], packing.offsets[i] + items[i].size);
  }
  std::sort(ranges.begin(), ranges.end());
  for (uint32_t i = 1; i < count; ++i)
    ASSERT_LE(ranges[i - 1].second, ranges[i].first);
  EXPECT_EQ(packing.size, ranges.back().second);
}

TEST(Packing, CommonBitsAreFoundOnEveryProcessor) {
  SplitMix64 random{1};
  for (uint32_t round = 0; round < 1000; ++round) {
    std::array<uint32_t, numbers_at_once> numbers{};
    for (uint32_t& number : numbers)
      number = static_cast<uint32_t>(random.next()) & static_cast<uint32_t>(random.next());
    const uint32_t mask = uint32_t{1} << random.below(32) | (round % 2 == 0 ? 0x80000000u : 0);
    uint32_t expected = 0;
    for (uint32_t i = 0; i < numbers_at_once; ++i)
      expected |= static_cast<uint32_t>((numbers[i] & mask) != 0) << i;
    ASSERT_EQ(any_common_bits(numbers.data(), mask), expected);
    ASSERT_EQ(any_common_bits_portable(numbers.data(), mask), expected);
  }
}

TEST(Packing, IncompatibleMemoryTypesGetSeparateHeaps) {
  GraphBuilder b{"buffer tiles", "image middle", "export result"};
  b.pass("list", "test.list", {}, {{"tiles", "tiles"}});
  b.pass("scatter", "test.tiles", {{"tiles", "tiles"}}, {{"out", "middle"}});
  b.pass("finish", "test.need", {{"a", "middle"}}, {{"out", "result"}});
  b.device.buffer_needs = [](const BufferDescription&) { return MemoryNeeds{100, 4, 0b0110}; };
  b.device.image_needs = [](const ImageDescription&) { return MemoryNeeds{1000, 16, 0b0011}; };
  auto plan = compiled(b).plan;
  ASSERT_THAT(plan.heaps, SizeIs(1));
  EXPECT_EQ(plan.heaps[0].memory_type_bits, 0b0010u);
  // A common heap would leave no local memory type for both.
  b.device.device_local_type_bits = 0b0101;
  plan = compiled(b).plan;
  ASSERT_THAT(plan.heaps, SizeIs(2));
  EXPECT_EQ(plan.heaps[0].memory_type_bits, 0b0110u);
  EXPECT_EQ(plan.heaps[1].memory_type_bits, 0b0011u);
}

TEST(Packing, BuffersAndImagesInOneHeapKeepTheGranularity) {
  GraphBuilder b{"buffer tiles", "image middle", "export result"};
  b.pass("list", "test.list", {}, {{"tiles", "tiles"}});
  b.pass("scatter", "test.tiles", {{"tiles", "tiles"}}, {{"out", "middle"}});
  b.pass("finish", "test.need", {{"a", "middle"}}, {{"out", "result"}});
  b.device.buffer_needs = [](const BufferDescription&) { return MemoryNeeds{100, 4, 1}; };
  b.device.image_needs = [](const ImageDescription&) { return MemoryNeeds{1000, 16, 1}; };
  b.device.buffer_image_granularity = 1024;
  const auto plan = compiled(b).plan;
  ASSERT_THAT(plan.placements, SizeIs(2));
  EXPECT_EQ(plan.placements[0].offset / 1024 == plan.placements[1].offset / 1024, false);
  EXPECT_EQ(plan.placements[0].offset % 1024, 0u);
  EXPECT_EQ(plan.placements[1].offset % 1024, 0u);
}

} // namespace
} // namespace dermis::testing
