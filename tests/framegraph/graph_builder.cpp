#include "tests/framegraph/graph_builder.hpp"

#include "framegraph/explain/reasons.hpp"
#include "framegraph/model/image_range.hpp"

#include "framegraph/verify/verify.hpp"

#include <array>

namespace dermis::testing {
namespace {

constexpr Format one_half4[] = {Format::rgba16f};

constexpr Port shade_ports[] = {{"a", Usage::sampled_image, true, "texture2D", ""},
                                {"b", Usage::sampled_image, true, "texture2D", ""},
                                {"c", Usage::sampled_image, true, "texture2D", ""},
                                {"out", Usage::storage_image_write, false, "image2D", ""},
                                {"out2", Usage::storage_image_write, true, "image2D", ""}};
constexpr Port need_ports[] = {{"a", Usage::sampled_image, false, "texture2D", ""},
                               {"out", Usage::storage_image_write, false, "image2D", ""}};
constexpr Port blend_ports[] = {{"a", Usage::sampled_image, true, "texture2D", ""},
                                {"own", Usage::sampled_image, true, "texture2D", "", {}, true},
                                {"out", Usage::storage_image_write, false, "image2D", ""}};
constexpr Port update_ports[] = {{"a", Usage::sampled_image, true, "texture2D", ""},
                                 {"image", Usage::storage_image_update, false, "image2D", ""},
                                 {"own", Usage::sampled_image, true, "texture2D", "", {}, true}};
constexpr Port fill_ports[] = {{"target", Usage::clear, false, "", ""}};
constexpr Port lister_ports[] = {{"a", Usage::sampled_image, true, "texture2D", ""},
                                 {"tiles", Usage::storage_buffer_write, false, "uint", ""}};
constexpr Port count_ports[] = {{"tiles", Usage::storage_buffer_update, false, "uint", ""}};
constexpr Port tiles_ports[] = {{"tiles", Usage::storage_buffer_read, true, "uint", ""},
                                {"arguments", Usage::indirect_arguments, true, "uint", ""},
                                {"a", Usage::sampled_image, true, "texture2D", ""},
                                {"out", Usage::storage_image_write, false, "image2D", ""}};
constexpr Port probe_ports[] = {{"a", Usage::sampled_image, true, "texture2D", ""}};
constexpr Port narrow_ports[] = {
    {"a", Usage::sampled_image, true, "texture2D", "", one_half4},
    {"out", Usage::storage_image_write, false, "image2D", "", one_half4}};
constexpr Port filter_ports[] = {{.name = "a",
                                  .usage = Usage::sampled_image,
                                  .glsl_type = "texture2D",
                                  .doc = "",
                                  .filtered = true},
                                 {"out", Usage::storage_image_write, false, "image2D", ""}};
constexpr Port levels_ports[] = {{"a", Usage::sampled_image, true, "texture2D", ""},
                                 {.name = "out",
                                  .usage = Usage::storage_image_write,
                                  .glsl_type = "image2D",
                                  .doc = "",
                                  .internally_ordered = true}};
constexpr Port ids_ports[] = {{"ids", Usage::sampled_image, false, "utexture2D", ""},
                              {"out", Usage::storage_image_write, false, "image2D", ""}};

PassType type(std::string_view name, std::span<const Port> ports) {
  PassType result;
  result.name = name;
  result.ports = ports;
  return result;
}

} // namespace

PassTypeRegistry test_pass_types() {
  PassTypeRegistry pass_types;
  pass_types.add(type("test.shade", shade_ports));
  pass_types.add(type("test.need", need_ports));
  pass_types.add(type("test.update", update_ports));
  pass_types.add(type("test.fill", fill_ports));
  pass_types.add(type("test.list", lister_ports));
  pass_types.add(type("test.count", count_ports));
  pass_types.add(type("test.tiles", tiles_ports));
  pass_types.add(type("test.narrow", narrow_ports));
  pass_types.add(type("test.filter", filter_ports));
  pass_types.add(type("test.blend", blend_ports));
  pass_types.add(type("test.ids", ids_ports));
  pass_types.add(type("test.levels", levels_ports));
  PassType probe = type("test.probe", probe_ports);
  probe.side_effects = true;
  pass_types.add(probe);
  return pass_types;
}

GraphBuilder::GraphBuilder(std::initializer_list<const char*> resources) : GraphBuilder() {
  for (const std::string declared : resources) {
    const size_t blank = declared.find(' ');
    const std::string kind = declared.substr(0, blank), name = declared.substr(blank + 1);
    if (kind == "buffer") {
      buffer(name);
      continue;
    }
    ResourceDeclaration& made = image(name);
    if (kind == "import" || kind == "in_out") made.origin = Origin::imported;
    made.exported = kind == "export" || kind == "in_out";
    if (kind == "history") made.history.frames = 1;
  }
}

SourceLocation GraphBuilder::next_line() {
  return {FileId{0}, ++line, 1, ""};
}

ResourceDeclaration& GraphBuilder::image(const std::string& name) {
  ResourceDeclaration declared;
  declared.name = name;
  declared.formats = {Format::rgba16f};
  declared.where = next_line();
  graph.resources.push_back(declared);
  return graph.resources.back();
}

ResourceDeclaration& GraphBuilder::import(const std::string& name) {
  auto& declared = image(name);
  declared.origin = Origin::imported;
  return declared;
}

ResourceDeclaration& GraphBuilder::exported(const std::string& name) {
  auto& declared = image(name);
  declared.exported = true;
  return declared;
}

ResourceDeclaration& GraphBuilder::history(const std::string& name, uint32_t frames) {
  auto& declared = image(name);
  declared.history.frames = frames;
  return declared;
}

ResourceDeclaration& GraphBuilder::buffer(const std::string& name) {
  auto& declared = image(name);
  declared.type = ResourceType::buffer;
  declared.formats.clear();
  declared.size.x = declared.size.y = {1, 8};
  declared.stride = 4;
  declared.extra_elements = 4;
  return declared;
}

SettingDeclaration& GraphBuilder::boolean(const std::string& name, bool value) {
  SettingDeclaration setting;
  setting.name = name;
  setting.type = SettingType::boolean;
  setting.default_value = {SettingType::boolean, value, 0.0};
  setting.where = next_line();
  graph.settings.push_back(setting);
  return graph.settings.back();
}

ExpressionId GraphBuilder::when(const std::string& name, bool when_set) {
  uint32_t setting = 0;
  while (graph.settings[setting].name != name)
    ++setting;
  Expression leaf;
  leaf.op = Expression::Op::setting;
  leaf.setting = SettingId{setting};
  graph.expressions.push_back(leaf);
  if (!when_set) {
    Expression negated;
    negated.op = Expression::Op::logical_not;
    negated.left = ExpressionId{static_cast<uint32_t>(graph.expressions.size() - 1)};
    graph.expressions.push_back(negated);
  }
  return ExpressionId{static_cast<uint32_t>(graph.expressions.size() - 1)};
}

ResourceId GraphBuilder::resource(const std::string& name) const {
  for (uint32_t i = 0; i < graph.resources.size(); ++i)
    if (graph.resources[i].name == name) return ResourceId{i};
  ADD_FAILURE() << "no resource " << name;
  return {};
}

PassId GraphBuilder::pass_id(const std::string& name) const {
  for (uint32_t i = 0; i < graph.passes.size(); ++i)
    if (graph.passes[i].name == name) return PassId{i};
  ADD_FAILURE() << "no pass " << name;
  return {};
}

PortBinding GraphBuilder::reference(uint32_t port, const std::string& text) const {
  const size_t at = std::min(text.find("@-"), text.size());
  const size_t end = std::min(text.find_first_of("#["), at);
  PortBinding binding;
  binding.port = port;
  binding.resource = resource(text.substr(0, end));
  const auto image_range = parse_image_range(text.substr(end, at - end));
  EXPECT_TRUE(image_range) << text;
  if (image_range) binding.range = *image_range;
  if (at != text.size())
    binding.frames_back = static_cast<uint32_t>(std::stoul(text.substr(at + 2)));
  return binding;
}

PassDeclaration& GraphBuilder::pass(const std::string& name, const std::string& kind_name,
                                    const Bindings& reads, const Bindings& writes) {
  PassDeclaration declared;
  declared.name = name;
  declared.type = pass_types.find(kind_name);
  EXPECT_TRUE(declared.type.valid()) << kind_name;
  declared.where = next_line();
  const auto add = [&](PortSide side, uint32_t port, const std::string& text, ReadWhen when) {
    PortBinding binding = reference(port, text);
    binding.when = when;
    graph.bind(declared, side, binding, next_line());
  };
  const auto bind = [&](PortSide side, const Bindings& from) {
    for (const auto& [port, text] : from) {
      const int found = find_port(pass_types[declared.type], port);
      EXPECT_GE(found, 0) << port;
      const auto index = static_cast<uint32_t>(found);
      const size_t condition = text.find('?');
      add(side, index, text.substr(0, condition),
          condition == std::string::npos ? ReadWhen::always : ReadWhen::history_valid);
      if (condition != std::string::npos && condition + 1 < text.size())
        add(side, index, text.substr(condition + 1), ReadWhen::history_invalid);
    }
  };
  bind(PortSide::read, reads);
  bind(PortSide::write, writes);
  graph.passes.push_back(declared);
  return graph.passes.back();
}

PortBinding& GraphBuilder::read(uint32_t pass, uint32_t index) {
  return graph.bindings[graph.passes[pass].first_binding + index];
}

PortBinding& GraphBuilder::written(uint32_t pass, uint32_t index) {
  return read(pass, graph.passes[pass].read_count + index);
}

void GraphBuilder::otherwise(PassDeclaration& pass, const std::string& output,
                             const std::string& instead) {
  pass.otherwise.push_back({resource(output), resource(instead), next_line()});
}

CompileInput GraphBuilder::input(uint32_t width, uint32_t height) const {
  CompileInput input;
  input.graph = &graph;
  input.pass_types = &pass_types;
  input.device = &device;
  input.view_width = width;
  input.view_height = height;
  return input;
}

CompiledPlan compiled(const GraphBuilder& builder) {
  return compiled(builder, builder.input());
}

CompiledPlan compiled(const GraphBuilder& builder, const CompileInput& input) {
  Diagnostics diagnostics;
  auto plan = compile(input, diagnostics);
  for (const Diagnostic& diagnostic : diagnostics.list)
    ADD_FAILURE() << diagnostic_info(diagnostic.id).name << ": " << diagnostic.text;
  if (!plan) return {};
  const Verdict verdict = verify(plan->plan);
  for (const std::string& violation : verdict.violations)
    ADD_FAILURE() << "verifier: " << violation;
  EXPECT_EQ(verdict.not_verified, "");
  EXPECT_EQ(&builder.graph, input.graph);
  return *std::move(plan);
}

std::vector<Diagnostic> rejected(const GraphBuilder& builder) {
  return rejected(builder, builder.input());
}

std::vector<Diagnostic> rejected(const GraphBuilder& builder, const CompileInput& input) {
  Diagnostics diagnostics;
  EXPECT_EQ(&builder.graph, input.graph);
  EXPECT_FALSE(compile(input, diagnostics).has_value());
  EXPECT_TRUE(diagnostics.has_errors());
  return diagnostics.list;
}

std::string pass_names(const GraphBuilder& builder, const Plan& plan) {
  std::string names;
  for (const PlanPass& pass : plan.passes)
    names += (names.empty() ? "" : " ") + builder.graph.passes[pass.declared.value].name;
  return names;
}

std::string reasons(const GraphBuilder& builder, const CompiledPlan& compiled, Reason::About about,
                    uint32_t index) {
  return ReasonIndex(builder.graph, builder.pass_types, compiled).about(about, index);
}

} // namespace dermis::testing
