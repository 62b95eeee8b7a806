// Tests rules of the library's pass types for their ports, other than size: channels, and groups of
// ports of which at least one has to be bound.

#include "framegraph/compile/compile.hpp"
#include "framegraph/model/read_graph.hpp"
#include "passes/common/pass_types.hpp"
#include "tests/framegraph/text_support.hpp"
#include "tests/support/text_file.hpp"

#include <algorithm>
#include <iterator>
#include <set>

namespace {

using namespace dermis;
using namespace dermis::testing;
using Id = DiagnosticId;

struct PortRules : ::testing::Test {
  PassTypeRegistry pass_types = subsurface::make_pass_types();
  Diagnostics diagnostics;
  std::string text;
  std::optional<Graph> graph;

  void SetUp() override {
    text = test::read_text(DERMIS_SOURCE_DIR "/configs/graphs/burley.json");
    ASSERT_FALSE(text.empty());
  }

  // Replaces the only occurrence of `from`.
  void replace(std::string_view from, std::string_view to) {
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    ASSERT_EQ(text.find(from, at + 1), std::string::npos) << from << " is ambiguous";
    text.replace(at, from.size(), to);
  }

  void read() {
    const auto document = parse_document("graph.json", text, diagnostics);
    ASSERT_TRUE(document) << all_messages(diagnostics);
    graph = read_graph(*document, pass_types, diagnostics);
  }

  bool compiles(std::string_view unbound = "") {
    const DeviceProfile device = generic_profile();
    CompileInput input;
    input.graph = &*graph;
    input.pass_types = &pass_types;
    input.device = &device;
    input.view_width = 640;
    input.view_height = 360;
    for (const ResourceDeclaration& resource : graph->resources)
      input.bound.push_back(!resource.optional || resource.name != unbound);
    return compile(input, diagnostics).has_value();
  }

  // Expects exactly one diagnostic, at the only occurrence of `at`.
  void expect(Id id, std::string_view at, const std::vector<std::string>& words) const {
    const size_t found = text.find(at);
    ASSERT_NE(found, std::string::npos) << at;
    ASSERT_EQ(text.find(at, found + 1), std::string::npos) << at << " is ambiguous";
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(found), '\n');
    const size_t column = found - (text.rfind('\n', found) + 1) + 1;
    expect_only(diagnostics, id, static_cast<uint32_t>(line), static_cast<uint32_t>(column), words);
  }
};

TEST_F(PortRules, LightWithMissingChannelsIsRejected) {
  replace(R"("light": { "format": "rgba16f")", R"("light": { "format": "r16f")");
  read();
  EXPECT_FALSE(graph);
  expect(Id::format_mismatch, R"("light", "slope": "slope" },
      "set")",
         {"port 'light' of pass 'setup' supports 'rgba16f' or 'rgba32f'; 'light' declares 'r16f'",
          "port 'light' of pass 'scatter'"});
}

TEST_F(PortRules, SlopesHaveTwoChannels) {
  replace(R"("slope": { "format": "rg16f")", R"("slope": { "format": "r32f")");
  read();
  EXPECT_FALSE(graph);
  expect(Id::format_mismatch, R"("slope" },
      "set")",
         {"port 'slope' of pass 'setup' supports 'rg16f'"});
}

// The first format of the list that fits every port is taken.
TEST_F(PortRules, FormatWithTooFewChannelsIsSkipped) {
  replace(R"("scattered": { "format": "rgba16f")",
          R"("scattered": { "format": ["r16f", "rgba16f"])");
  read();
  ASSERT_TRUE(graph) << all_messages(diagnostics);
  EXPECT_TRUE(compiles()) << all_messages(diagnostics);
}

// The host may bind any of the listed formats.
TEST_F(PortRules, EachFormatOfAnImportFitsEveryPort) {
  for (const char* formats : {R"(["r8_unorm", "r8_uint"])", R"(["r8_uint", "r8_unorm"])"}) {
    SetUp();
    diagnostics = {};
    const size_t from = text.find(R"("format": ["r8_uint")");
    const size_t to = from == std::string::npos ? from : text.find(']', from);
    ASSERT_NE(to, std::string::npos);
    text.replace(from, to + 1 - from, std::string("\"format\": ") + formats);
    read();
    EXPECT_FALSE(graph);
    ASSERT_EQ(diagnostics.list.size(), 1u) << all_messages(diagnostics);
    EXPECT_EQ(diagnostics.list[0].id, Id::format_mismatch);
    EXPECT_NE(diagnostics.list[0].text.find("'r8_unorm'"), std::string::npos);
  }
}

// A port of one channel or of an integer takes any such format; every other port lists its formats.
TEST_F(PortRules, EveryPortOfSeveralChannelsNamesItsFormats) {
  const std::set<std::string_view> of_one_channel{"depth", "scatter_scale", "thickness"};
  for (uint32_t i = 0; i < pass_types.size(); ++i)
    for (const Port& port : pass_types[PassTypeId{i}].ports) {
      if (!usage_info(port.usage).image || port.usage == Usage::clear ||
          port.glsl_type.front() == 'u')
        continue;
      EXPECT_EQ(port.formats.empty(), of_one_channel.contains(port.name))
          << pass_types[PassTypeId{i}].name << "." << port.name;
    }
}

std::string shader_text(const std::string& name) {
  return test::read_text(DERMIS_SOURCE_DIR "/shaders/" + name);
}

std::string without_spaces(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\n'; });
  return text;
}
size_t count(const std::string& text, const std::string& word) {
  size_t found = 0;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
    ++found;
  return found;
}

// The call by which kernels read light at the invocation's own texel.
constexpr const char* own_light =
    "pixel_light(lighting_image,albedo_image,has_albedo(),settings.texturing,texel)";

TEST_F(PortRules, PixelLight_ReadsOnlyTheTexelOfItsCaller) {
  const std::string source = without_spaces(shader_text("common/pixel_light.glsl"));
  EXPECT_EQ(count(source, "texelFetch("), count(source, "texelFetch(lighting,texel,0)") +
                                              count(source, "texelFetch(albedo,texel,0)"));
}

TEST_F(PortRules, OwnTexelsAreReadAtTheTexelThatIsWritten) {
  size_t ports = 0;
  for (uint32_t i = 0; i < pass_types.size(); ++i) {
    const PassType& type = pass_types[PassTypeId{i}];
    const std::string shader = without_spaces(shader_text(std::string(type.shader) + ".comp"));
    for (const Port& port : type.ports) {
      if (!port.own_texels) continue;
      const std::string image = std::string(port.name) + "_image";
      size_t own = count(shader, "texelFetch(" + image + ",texel,0)");
      if (port.name == "lighting" || port.name == "albedo") own += count(shader, own_light);
      EXPECT_GT(own, 0u) << type.name << "." << port.name;
      EXPECT_EQ(own, count(shader, "(" + image) + count(shader, "," + image))
          << type.name << "." << port.name;
      EXPECT_NE(shader.find("ivec2texel=texel_of(pixel);"), std::string::npos) << type.name;
      for (const Port& written : type.ports) {
        if (written.usage != Usage::storage_image_write) continue;
        EXPECT_NE(shader.find("imageStore(" + std::string(written.name) + "_image,texel,"),
                  std::string::npos)
            << type.name << "." << written.name;
      }
      ++ports;
    }
  }
  EXPECT_EQ(ports, 10u);
}

TEST_F(PortRules, OnlyWritersOrderInternally) {
  size_t ports = 0;
  for (uint32_t i = 0; i < pass_types.size(); ++i)
    for (const Port& port : pass_types[PassTypeId{i}].ports) {
      if (!port.internally_ordered) continue;
      EXPECT_TRUE(may_order_internally(port.usage)) << pass_types[PassTypeId{i}].name;
      ++ports;
    }
  EXPECT_EQ(ports, 1u);
}

TEST_F(PortRules, CombineWithoutLight_IsRejected) {
  replace(R"("read": { "scattered": "scattered", "material": "material", "albedo": "albedo",
                "tiles")",
          R"("read": { "material": "material", "albedo": "albedo",
                "tiles")");
  read();
  EXPECT_FALSE(graph);
  expect(Id::missing_port, R"("combine", "type")",
         {"pass 'combine'", "one of its ports 'scattered' or 'unscattered' under \"read\""});
}

TEST_F(PortRules, CopiedLightIsAccepted) {
  replace(R"("read": { "scattered": "scattered", "material": "material", "albedo": "albedo",
                "tiles")",
          R"("read": { "unscattered": "lighting", "material": "material", "albedo": "albedo",
                "tiles")");
  read();
  ASSERT_TRUE(graph) << all_messages(diagnostics);
  EXPECT_TRUE(compiles()) << all_messages(diagnostics);
}

// The file binds both ports, but these settings disable both producers; expects one diagnostic.
TEST_F(PortRules, NoProducerOfAnySuchPort_IsRejected) {
  replace(R"("samples": { "int": 32)", R"("on": { "bool": false }, "samples": { "int": 32)");
  replace(R"("type": "subsurface.burley",)", R"("type": "subsurface.burley", "when": "on",)");
  replace(
      R"("scattered": "scattered", "material": "material", "albedo": "albedo",
                "tiles")",
      R"("scattered": "scattered", "unscattered": "behind", "material": "material", "albedo": "albedo",
                "tiles")");
  replace(R"("scatter_scale": { "format")",
          R"("behind": { "format": "rgba16f", "size": "view", "optional": true },
    "scatter_scale": { "format")");
  read();
  ASSERT_TRUE(graph) << all_messages(diagnostics);
  EXPECT_TRUE(compiles()) << all_messages(diagnostics);
  EXPECT_FALSE(compiles("behind"));
  expect(Id::read_before_write, R"("scattered", "unscattered")",
         {"pass 'combine', port 'scattered' reads 'scattered'", "'scatter' writes it and is off"});
}

} // namespace
